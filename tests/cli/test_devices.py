"""All devices of a machine: a batch that is spread over them, and the check of each device.

PoCL offers as many devices as POCL_DEVICES names.  Its device "basic" fails when two threads use it.
"""
import os
import unittest

from images import scene, textured
from test_cache import POCL, platforms
from tool import FAST, NO_OPENCL, ToolTest, main, odd_opencl, read_json

TWO = {"POCL_DEVICES": "pthread pthread"}


@unittest.skipUnless(platforms(**TWO).get(POCL) == "0.1", "needs two devices of PoCL and no other")
class AllDevices(ToolTest):
    names = [f"{i}.png" for i in range(4)]

    def setUp(self):
        super().setUp()
        for i, name in enumerate(self.names):
            self.write_png(name, textured(20 + 12 * i, 24))

    def encode_all(self, device, *arguments, names=None, **options):
        """Encodes all images on a device into a folder of its name, and returns the report."""
        self.path(device).mkdir()
        names = names or self.names
        return self.gscl_json("encode", *names, "--out-dir", device, "--device", device, *FAST, *arguments, **options)

    def bytes_of(self, device):
        return [path.read_bytes() for path in sorted(self.path(device).iterdir())]

    def test_files_are_those_of_each_device_alone(self):
        reports = self.encode_all("all", env=TWO)
        self.assertEqual([report["input"] for report in reports], self.names)
        self.assertEqual({report["device"] for report in reports}, {"0.0", "0.1"})
        for device in ("0.0", "0.1"):
            self.encode_all(device, env=TWO)
            for report in reports:
                if report["device"] == device:
                    name = os.path.basename(report["output"])
                    self.assertEqual(self.path(f"all/{name}").read_bytes(), self.path(f"{device}/{name}").read_bytes())

    def test_text_is_in_the_order_of_inputs(self):
        lines = self.gscl("encode", *self.names, "--base64", "--device", "all", *FAST, "--quiet", env=TWO).split()
        self.encode_all("0.0", "--base64", env=TWO)
        self.assertEqual(lines, [text.strip() for text in self.bytes_of("0.0")])

    def test_device_without_context_is_left_out(self):
        self.path("all").mkdir()
        done = self.start("encode", *self.names, "--out-dir", "all", "--device", "all", *FAST, "--quiet",
                          env={**TWO, **odd_opencl("refuse")})
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr.decode(), r"\Agscl: 0.1: warning: this device is left out: clCreateContext on [^\n]*"
                                               r"ran out of resources[^\n]*\n\Z")
        self.encode_all("0.0", env=TWO)
        self.assertEqual(self.bytes_of("all"), self.bytes_of("0.0"))

    def test_bad_images_and_outputs_fail_alone(self):
        self.write("bad.png", b"no image")
        self.path("all").mkdir()
        self.path("all/3.gscl").mkdir()
        done = self.start("encode", "bad.png", *self.names, "--out-dir", "all", "--device", "all", *FAST, "--quiet", env=TWO)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr.decode(), r"\Agscl: bad.png: [^\n]*\ngscl: all/3.gscl: cannot be written: [^\n]*\n\Z")
        self.assertEqual(len(self.files()), 4 + 1 + 1 + 4)

    def test_host_beside_gpus_and_alone(self):
        """It takes part where no OpenCL device may be the same processor."""
        for env, expected in (({**TWO, **odd_opencl("gpu")}, {"0.0", "0.1", "host"}), (NO_OPENCL, {"host"})):
            with self.subTest(env=env):
                reports = self.encode_all("all", env=env)
                self.assertEqual([report["input"] for report in reports], self.names)
                self.assertEqual({report["device"] for report in reports}, expected)
                for path in self.path("all").iterdir():
                    path.unlink()
                self.path("all").rmdir()

    def test_other_commands_know_no_all(self):
        self.gscl("encode", "0.png", "--quiet", *FAST)
        self.refused("all", 'no device matches "all"', "decode", "0.gscl", "-o", "out.png", "--device", "all")


class WithoutLoader(ToolTest):
    """A machine whose OpenCL loader is missing, or too old to have a function that is needed."""

    def setUp(self):
        super().setUp()
        self.path("missing").mkdir()
        self.write("missing/libOpenCL.so.1", b"")
        self.path("old").mkdir()
        self.path("old/libOpenCL.so.1").symlink_to(os.environ["ODD_OPENCL_MODULE"])

    def test_kernels_for_gpus_cannot_be_had(self):
        self.write_png("0.png", textured(24, 16))
        for name, reason in ("missing", r"libOpenCL\.so\.1: "), ("old", r"libOpenCL\.so\.1 has no function clCreateBuffer"):
            with self.subTest(name):
                self.refused("OpenCL", rf"no OpenCL device was found \([^)]*{reason}[^)]*\); install .* "
                             r"ocl-icd-libopencl1 and pocl-opencl-icd$", "encode", "0.png", "--mapping", "gpu", *FAST,
                             env={"LD_LIBRARY_PATH": self.path(name)})

    def test_host_encodes_and_decodes(self):
        self.write_png("0.png", textured(24, 16))
        self.gscl("encode", "0.png", "--quiet", *FAST)
        self.gscl("decode", "0.gscl", "-o", "with.png", "--device", "host")
        for name in "missing", "old":
            loader = {"LD_LIBRARY_PATH": self.path(name)}
            self.assertEqual([device["id"] for device in self.gscl_json("devices", env=loader)], ["host"])
            self.gscl("encode", "0.png", "-o", f"{name}.gscl", *FAST, env=loader)
            self.assertEqual(self.path(f"{name}.gscl").read_bytes(), self.path("0.gscl").read_bytes())
            self.gscl("decode", "0.gscl", "-o", f"{name}.png", env=loader)
            self.assertEqual(self.path(f"{name}.png").read_bytes(), self.path("with.png").read_bytes())


class Check(ToolTest):
    def check(self, way=None, arguments=(), **variables):
        """The exit code and the rows of the report, with a device that is broken in one way."""
        done = self.start("devices", "--check", "--json", *arguments,
                          env={**(odd_opencl(way) if way else {}), **variables})
        return done.returncode, read_json(done.stdout)

    def test_sound_devices_pass(self):
        code, rows = self.check()
        self.assertEqual(code, 0)
        ids = [device["id"] for device in self.gscl_json("devices") if device["id"] != "host"]
        self.assertEqual([(row["id"], row["mapping"]) for row in rows],
                         [(i, m) for i in ids for m in ("cpu", "gpu")] + [("host", "cpu")])
        for row in rows:
            self.assertTrue(row["passed"])
            self.assertTrue(0 < row["largest_difference"] < 0.01 and row["psnr"] > 28, row)

    def test_broken_devices_fail(self):
        for way, arguments, failure in (
                ("crash", (), r"encoding ended with signal 6 \("),
                ("hang", ("--limit", "2"), r"encoding was not done after 2 s\Z"),
                ("no-memory", (), r"clEnqueueNDRangeKernel of kernel \w+ on .*CL_MEM_OBJECT_ALLOCATION_FAILURE"),
                ("wrong", (), r"decoded samples differ by [12]\d\d/255 from double precision, at most 1/255 would be right\Z")):
            with self.subTest(way=way):
                code, rows = self.check(way, arguments)
                self.assertEqual((code, len(rows)), (1, 3))
                self.assertTrue(rows[2]["passed"], rows[2])  # host
                for row in rows[:2]:
                    self.assertFalse(row["passed"])
                    self.assertRegex(row["failure"], failure)

    @unittest.skipUnless(platforms(**TWO).get(POCL) == "0.1", "needs two devices of PoCL and no other")
    def test_sound_device_beside_one_without_context(self):
        code, rows = self.check("refuse", **TWO)
        self.assertEqual((code, [row["passed"] for row in rows]), (1, [True, True, False, False, True]))
        self.assertIn("clCreateContext", rows[2]["failure"])

    def test_text(self):
        lines = self.start("devices", "--check", env=odd_opencl("no-memory")).stdout.decode().splitlines()
        self.assertRegex(lines[0], r"\A0.0 +.*, mapping cpu: FAILED: clEnqueueNDRangeKernel of kernel ")
        self.assertEqual(len(lines), 3)
        lines = self.gscl("devices", "--check").decode().splitlines()
        for line, (device, mapping) in zip(lines, (("0.0", "cpu"), ("0.0", "gpu"), ("host", "cpu")), strict=True):
            self.assertRegex(line, rf"\A{device} +.*, mapping {mapping}: pass: [\d.]+ dB, largest difference [\d.e-]+/255, "
                                   r"[\d.]+ s\Z")

    def test_no_opencl_device(self):
        self.write("file", b"")
        for env, message in ({"POCL_CACHE_DIR": "file/x"}, r"\Agscl: devices: PoCL cannot write to file/x, .*\n\Z"), (NO_OPENCL, r"\A\Z"):
            done = self.start("devices", "--check", env=env)
            self.assertEqual(done.returncode, 0)
            self.assertRegex(done.stdout.decode(), r"\Ahost +[^\n]*, mapping cpu: pass: [^\n]*\n\Z")
            self.assertRegex(done.stderr.decode(), message)

    def test_limit_needs_check(self):
        self.refused("devices", "--limit applies to --check only; add --check", "devices", "--limit", "9", code=2)


if __name__ == "__main__":
    main()
