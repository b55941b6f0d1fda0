"""All devices of a machine: a batch that is spread over them, and the check of each device.

PoCL offers as many devices as POCL_DEVICES names.  Its device "basic" fails when two threads use it.
"""
import os
import unittest

from images import scene, textured
from test_cache import POCL, platforms
from tool import FAST, ToolTest, main, odd_opencl

TWO = {"POCL_DEVICES": "pthread pthread"}


@unittest.skipUnless(platforms(**TWO).get(POCL) == "0.1", "needs two devices of PoCL and no other")
class AllDevices(ToolTest):
    names = [f"{i}.png" for i in range(6)]

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
        lines = self.gscl("encode", *self.names, "--base64", "--device", "all", *FAST, "-q", env=TWO).split()
        self.encode_all("0.0", "--base64", env=TWO)
        self.assertEqual(lines, [text.strip() for text in self.bytes_of("0.0")])

    def test_device_without_context_is_left_out(self):
        self.path("all").mkdir()
        done = self.start("encode", *self.names, "--out-dir", "all", "--device", "all", *FAST, "-q",
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
        done = self.start("encode", "bad.png", *self.names, "--out-dir", "all", "--device", "all", *FAST, "-q", env=TWO)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr.decode(), r"\Agscl: bad.png: [^\n]*\ngscl: all/3.gscl: cannot be written: [^\n]*\n\Z")
        self.assertEqual(len(self.files()), 6 + 1 + 1 + 6)

    def test_no_device_at_all(self):
        self.write("file", b"")
        self.refused("OpenCL", "POCL_CACHE_DIR", "encode", *self.names, "--device", "all", env={"POCL_CACHE_DIR": "file/x"})

    def test_other_commands_know_no_all(self):
        self.gscl("encode", "0.png", "-q", *FAST)
        self.refused("all", 'no OpenCL device matches "all"', "decode", "0.gscl", "-o", "out.png", "--device", "all")


if __name__ == "__main__":
    main()
