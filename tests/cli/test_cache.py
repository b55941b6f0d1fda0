"""Caches of built kernels: that of PoCL when it cannot be written to, and that of gscl for other implementations."""
import os
import pathlib
import re
import subprocess
import unittest

from images import scene
from tool import BUILD_NOTICE, FAST, GSCL, OPENCL, ToolTest, main, odd_opencl, read_json

NOBODY = 65534
CONFORMANCE = pathlib.Path(__file__).resolve().parents[1] / "conformance/files/all-sizes.gscl"
POCL = "Portable Computing Language"


def platforms(**variables):
    """The ids of devices by platform."""
    done = subprocess.run([GSCL, "devices", "--json"], capture_output=True, check=True, env={**os.environ, **variables})
    return {device["platform"]: device["id"] for device in read_json(done.stdout)}


def runs_for_nobody():
    return os.geteuid() != 0 or subprocess.run(["setpriv", f"--reuid={NOBODY}", "--clear-groups", GSCL, "--version"],
                                               capture_output=True, check=False).returncode == 0


@unittest.skipUnless(set(platforms()) - {"gscl"} == {POCL}, "needs PoCL alone")
class PoclCache(ToolTest):
    def setUp(self):
        super().setUp()
        self.write_png("in.png", scene(20, 20))
        self.write("file", b"")

    def refused_for_folder(self, folder, reason, *arguments, subject, **options):
        message = (f"PoCL cannot write to {re.escape(str(folder))}, where it keeps built kernels \\({reason}\\), and does not "
                   "work without; set the variable POCL_CACHE_DIR to another folder\n")
        self.refused(subject, f": {message}", *arguments, **options)

    def test_folder_that_is_named_but_cannot_be_made(self):
        for arguments, subject in (OPENCL, "0.0"), (("--mapping", "gpu"), "OpenCL"):
            self.refused_for_folder("file/x/y", "Not a directory", "encode", "in.png", "-o", "out.gscl", *arguments,
                                    subject=subject, env={"POCL_CACHE_DIR": "file/x/y"})

    def without_folder(self, *arguments, **variables):
        """Encodes where PoCL cannot make the folder that follows from the variables; returns what is printed on standard error."""
        done = self.start("encode", "in.png", "-o", "out.gscl", *OPENCL, *FAST, *arguments,
                          env={"TMPDIR": str(self.folder), **variables}, prefix=("env", "-u", "POCL_CACHE_DIR"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.files(), ["file", "in.png", "out.gscl"])
        return done.stderr.decode()

    def test_temporary_folder(self):
        for variables, folder in (({"XDG_CACHE_HOME": "/dev/null"}, "/dev/null/pocl/kcache"),
                                  ({"HOME": "/dev/null", "XDG_CACHE_HOME": ""}, "/dev/null/.cache/pocl/kcache")):
            with self.subTest(**variables):
                self.assertRegex(self.without_folder(**variables), rf"\APoCL cannot write to {folder} \(Not a directory\); its "
                                 r"kernels are built in a temporary folder, anew each time\nout.gscl: [^\n]*\n\Z")
        self.assertEqual(self.without_folder("--quiet", XDG_CACHE_HOME="/dev/null"), "")

    def test_host_needs_no_folder(self):
        done = self.start("encode", "in.png", "-o", "out.gscl", "--quiet", *FAST, env={"POCL_CACHE_DIR": "file/x"})
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_devices_says_so(self):
        done = self.start("devices", env={"POCL_CACHE_DIR": "file/x"})
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr.decode(), r"\Agscl: devices: PoCL cannot write to file/x, .*POCL_CACHE_DIR[^\n]*\n\Z")

    @unittest.skipUnless(runs_for_nobody(), "the program runs for root only")
    def test_read_only_folder(self):
        user = ("setpriv", f"--reuid={NOBODY}", "--clear-groups") if os.geteuid() == 0 else ()
        self.path("kernels").mkdir()
        self.folder.chmod(0o755)
        self.path("kernels").chmod(0o555)
        out = self.path("out")
        out.mkdir()
        out.chmod(0o777)
        self.refused_for_folder(self.path("kernels"), "Permission denied", "encode", "in.png", "-o", "out/out.gscl",
                                *OPENCL, subject="in.png", env={"POCL_CACHE_DIR": str(self.path("kernels"))}, prefix=user)
        done = self.start("devices", "--check", env={"POCL_CACHE_DIR": str(self.path("kernels"))}, prefix=user)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout.decode().count(f"FAILED: PoCL cannot write to {self.path('kernels')}, "), 2)


def others():
    """Devices of implementations that keep no kernels themselves."""
    return [device for platform, device in platforms().items() if platform not in (POCL, "gscl", "NVIDIA CUDA")]


@unittest.skipUnless(others(), "needs an OpenCL implementation beside PoCL, such as Intel's")
class OtherImplementations(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("in.gscl", CONFORMANCE.read_bytes())

    def decode_on_other(self, *arguments, cache="cache"):
        """Decodes, and returns the picture and whether each program was "built" or "loaded"."""
        done = self.start("decode", "in.gscl", "-o", "out.png", "--device", others()[0], "-v", *arguments,
                          env={"XDG_CACHE_HOME": str(self.path(cache))})
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.path("out.png").read_bytes(), set(re.findall(r"^(\w+) a program in", done.stderr.decode(), flags=re.M))

    def entries(self):
        return sorted(self.path("cache/gscl").glob("*"))

    def test_built_once(self):
        picture, how = self.decode_on_other()
        self.assertEqual(how, {"built"})
        self.assertTrue(self.entries())
        self.assertEqual(self.decode_on_other(), (picture, {"loaded"}))
        self.assertEqual(self.decode_on_other("--no-cache"), (picture, {"built"}))
        for path in self.entries():
            path.write_bytes(path.read_bytes()[:-1])
        self.assertEqual(self.decode_on_other(), (picture, {"built"}))
        self.assertEqual(self.decode_on_other(), (picture, {"loaded"}))

    def test_unusable_folder(self):
        self.write("file", b"")
        picture, _ = self.decode_on_other("--no-cache")
        self.assertFalse(self.path("cache").exists())
        self.assertEqual(self.decode_on_other(cache="file"), (picture, {"built"}))


class BuildNotice(ToolTest):
    def errors(self, *arguments):
        self.write_png("in.png", scene(20, 20))
        done = self.start("encode", "in.png", "-o", "out.gscl", *FAST, *arguments, keep_notice=True,
                          env=odd_opencl("slow-build"))
        self.assertEqual(done.returncode, 0)
        return done.stderr

    def test_long_builds_are_told_once(self):
        self.assertRegex(self.errors(*OPENCL), rb"\A%sout.gscl: [^\n]*\n\Z" % BUILD_NOTICE)

    def test_not_when_quiet(self):
        self.assertEqual(self.errors("--quiet", *OPENCL), b"")

    def test_host_builds_nothing(self):
        self.assertRegex(self.errors(), rb"\Aout.gscl: [^\n]*\n\Z")


if __name__ == "__main__":
    main()
