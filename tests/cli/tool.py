"""Runs gscl in tests, and reports the tests as TAP.

The environment variable GSCL names the program; POCL_CACHE_DIR should name a folder that no other process uses.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

from images import png_bytes, read_png

GSCL = os.path.abspath(os.environ.get("GSCL", "build/gscl"))
TIMEOUT = 1800  # seconds for one command: it ends a command that hangs, however loaded the machine
FAST = ("--effort", "0")
OPENCL = ("--device", "0.0")  # for tests of what is special of OpenCL; without it, gscl takes its device "host"
# The device of the helpers `encode` and `decode` where a test names none: tests/devices/run.sh runs suites on others.
DEVICE = os.environ.get("GSCL_TEST_DEVICE")
NO_OPENCL = {"OCL_ICD_VENDORS": "/nonexistent"}
BUILD_NOTICE = b"building kernels for the OpenCL device, which takes a while\n"
HANDLED_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGALRM, signal.SIGXCPU,
                   signal.SIGUSR1, signal.SIGUSR2)


def restore_signals():
    """Restores the default handlers, because the parent may ignore signals, as nohup does."""
    for number in HANDLED_SIGNALS:
        signal.signal(number, signal.SIG_DFL)


def on_device(arguments):
    return arguments if not DEVICE or "--device" in arguments else (*arguments, "--device", DEVICE)


def odd_opencl(way):
    """The environment of an OpenCL that is broken in one way (odd_opencl.c)."""
    return {"LD_PRELOAD": os.environ["ODD_OPENCL_MODULE"], "ODD_OPENCL": way}


def unique(pairs):
    """The members of an object, whose names must differ."""
    members = dict(pairs)
    assert len(members) == len(pairs), f"a name occurs twice: {[name for name, _ in pairs]}"
    return members


def refuse_constant(text):
    raise ValueError(f"{text} is no value of JSON")


def parse_strictly(text):
    return json.loads(text, parse_constant=refuse_constant, object_pairs_hook=unique)


def check_by_jq(data, values):
    """jq, where there is one, reads the same values."""
    if shutil.which("jq"):
        done = subprocess.run(["jq", "--compact-output", "."], input=data, capture_output=True, timeout=TIMEOUT)
        assert (done.returncode, done.stderr) == (0, b""), done.stderr
        assert [json.loads(line) for line in done.stdout.splitlines()] == values, done.stdout


def read_json(data):
    """Reads JSON as its standard has it: UTF-8, no NaN, no infinity, each name once; and by jq."""
    value = parse_strictly(data.decode())
    check_by_jq(data, [value])
    return value


def read_json_lines(data):
    """The same for a value on each line."""
    values = [parse_strictly(line) for line in data.decode().split("\n") if line]
    check_by_jq(data, values)
    return values


class ToolTest(unittest.TestCase):
    """Each test has an empty folder, self.folder, in which gscl runs."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gscl-test-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def path(self, name):
        return self.folder / name

    def write(self, name, data):
        self.path(name).write_bytes(data)
        return name

    def write_png(self, name, image):
        return self.write(name, png_bytes(image))

    def files(self):
        """All files in the folder, hidden ones included."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))

    def start(self, *arguments, env=None, prefix=(), program=GSCL, keep_notice=False, **options):
        """Runs gscl (or `program`), after the words of `prefix`, and does not check its exit code."""
        environment = {**os.environ, **(env or {})}
        done = subprocess.run([*prefix, program, *map(str, arguments)], cwd=self.folder, env=environment, timeout=TIMEOUT,
                              capture_output="stdout" not in options, **options)
        # A new cache, or a loaded machine, adds a line to the messages of any command.
        if isinstance(done.stderr, bytes) and not keep_notice:
            done.stderr = done.stderr.replace(BUILD_NOTICE, b"")
        return done

    def gscl(self, *arguments, **options):
        """Runs gscl, which must succeed, and returns its standard output."""
        done = self.start(*arguments, **options)
        self.assertEqual(done.returncode, 0, (done.stderr or b"").decode(errors="replace"))
        return done.stdout

    def gscl_json(self, *arguments, **options):
        return read_json(self.gscl(*arguments, "--json", **options))

    def encode(self, image, *arguments, name="in"):
        """Encodes an image, given as an Image or as the bytes of a file, and returns the bytes of the gscl file."""
        data = image if isinstance(image, bytes) else png_bytes(image)
        self.write(f"{name}.image", data)
        self.gscl("encode", f"{name}.image", "-o", f"{name}.gscl", "--quiet", *FAST, *on_device(arguments))
        return self.path(f"{name}.gscl").read_bytes()

    def decode(self, *arguments, name="in"):
        self.gscl("decode", f"{name}.gscl", "-o", f"{name}.png", *on_device(arguments))
        return read_png(self.path(f"{name}.png").read_bytes())

    def refused(self, subject, message, *arguments, code=1, **options):
        """Runs gscl, which must fail with the exit code `code`, one line on standard error about `subject` that matches
        `message`, nothing on standard output, and the same files as before."""
        before = self.files()
        done = self.start(*arguments, **options)
        error = done.stderr.decode(errors="replace")
        self.assertEqual(done.returncode, code, error)
        self.assertRegex(error, r"\A[^\n]*\n\Z", "not one line")
        self.assertTrue(error.startswith(f"gscl: {subject}: "), error)
        self.assertRegex(error, message)
        self.assertFalse(done.stdout)
        self.assertEqual(self.files(), before)
        return error


class TapResult(unittest.TestResult):
    """Prints the outcome of each test in the Test Anything Protocol.  Each subtest that fails has its own line."""

    lines = 0

    def line(self, passed, test, detail="", comment=""):
        name = re.sub(r"[#\n]", " ", str(test))
        self.lines += 1
        print(f"{'ok' if passed else 'not ok'} {self.lines} - {name}{comment}")
        for text in detail.splitlines():
            print(f"# {text}")
        sys.stdout.flush()

    def addSuccess(self, test):
        self.line(True, test)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.line(False, test, self.failures[-1][1])

    def addError(self, test, err):
        super().addError(test, err)
        self.line(False, test, self.errors[-1][1])

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.line(True, test, comment=f" # SKIP {reason}")

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            self.line(False, subtest, (self.failures + self.errors)[-1][1])


def main():
    """Runs the tests of the calling program, or those that the command line names."""
    loader = unittest.TestLoader()
    module = sys.modules["__main__"]
    suite = loader.loadTestsFromNames(sys.argv[1:], module) if sys.argv[1:] else loader.loadTestsFromModule(module)
    result = TapResult()
    suite.run(result)
    print(f"1..{result.lines}")
    sys.exit(0 if result.wasSuccessful() else 1)
