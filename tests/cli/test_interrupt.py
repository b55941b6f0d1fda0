"""Signals: gscl ends and leaves no partial file."""
import os
import pty
import signal
import subprocess
import tempfile
import time
import unittest

from images import scene
from tool import GSCL, HANDLED_SIGNALS, OPENCL, TIMEOUT, ToolTest, main, restore_signals


class Interrupt(ToolTest):
    def setUp(self):
        super().setUp()
        self.write_png("in.png", scene(320, 240))

    def start_encoding(self, *arguments, env=None):
        """Starts a long encode and waits until it has opened its output."""
        process = subprocess.Popen([GSCL, "encode", "in.png", "--effort", "9", "--bpp", "1", *arguments],
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env={**os.environ, **(env or {})}, preexec_fn=restore_signals)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + TIMEOUT
        while not any(name.startswith(".gscl-") for name in os.listdir(self.folder)):
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll(), "ended before it could be interrupted")
            time.sleep(0.01)
        time.sleep(0.2)
        return process

    def assert_ends(self, process, code):
        output, error = (text.decode() for text in process.communicate(timeout=TIMEOUT))
        self.assertEqual((process.returncode, output), (code, ""), error)
        return error

    def test_signals_leave_nothing(self):
        for number in HANDLED_SIGNALS:
            with self.subTest(number=number):
                process = self.start_encoding()
                process.send_signal(number)
                error = self.assert_ends(process, 128 + number)
                # A running kernel compiler may have printed other lines before.
                self.assertEqual(error.splitlines()[-1], "gscl: in.png: interrupted; its output was not written")
                self.assertEqual(self.files(), ["in.png"])

    def test_old_output_survives(self):
        self.write("out.gscl", b"old")
        process = self.start_encoding("-o", "out.gscl")
        process.send_signal(signal.SIGINT)
        self.assert_ends(process, 130)
        self.assertEqual(self.path("out.gscl").read_bytes(), b"old")
        self.assertEqual(self.files(), ["in.png", "out.gscl"])

    def test_batch_stops(self):
        self.write_png("other.png", scene(16, 16))
        process = self.start_encoding("other.png", "--jobs", "1")
        process.send_signal(signal.SIGINT)
        self.assert_ends(process, 130)
        self.assertEqual(self.files(), ["in.png", "other.png"])

    def test_second_signal_does_not_wait(self):
        process = self.start_encoding()
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        self.assert_ends(process, 130)
        self.assertEqual(self.files(), ["in.png"])

    def test_signals_while_kernels_are_built(self):
        """A compiler inside the process installs signal handlers while it runs."""
        for delay in (0, 0.1, 0.3):
            with self.subTest(delay=delay), tempfile.TemporaryDirectory(prefix="gscl-test-cache-") as cache:
                process = self.start_encoding(*OPENCL, env={"POCL_CACHE_DIR": cache})
                time.sleep(delay)
                process.send_signal(signal.SIGINT)
                process.send_signal(signal.SIGINT)
                self.assert_ends(process, 130)
                self.assertEqual(self.files(), ["in.png"])

    def start_decoding(self, *arguments):
        """Starts a decode with a terminal for its standard error, and returns the process and that terminal."""
        terminal, other_end = pty.openpty()
        self.addCleanup(os.close, terminal)
        process = subprocess.Popen([GSCL, "decode", "in.gscl", "-o", "out.ppm", *arguments], cwd=self.folder,
                                   stderr=other_end, preexec_fn=restore_signals)
        self.addCleanup(process.kill)
        os.close(other_end)
        return process, terminal

    def test_long_decode_shows_progress_and_can_be_stopped(self):
        """The line of progress comes after a second of a decode that takes many."""
        self.gscl("encode", "in.png", "-o", "in.gscl", "--quiet", "--effort", "0")
        for device in ("host", "0.0"):
            with self.subTest(device=device):
                process, terminal = self.start_decoding("--size", "16384x16384", "--max-pixels", "999999999", "--device",
                                                        device)
                text = b""
                while b"s left" not in text:  # the first line may come before there is an estimate
                    text += os.read(terminal, 4096)
                process.send_signal(signal.SIGINT)
                while b"interrupted" not in text:
                    text += os.read(terminal, 4096)
                self.assertEqual(process.wait(timeout=TIMEOUT), 130)
                self.assertRegex(text.decode(), r"in.gscl +\d+ % +\d+ splats +\d+\.\d s left")
                self.assertIn("gscl: in.gscl: interrupted; its output was not written", text.decode())
                self.assertEqual(self.files(), ["in.gscl", "in.png"])

    def test_closed_pipe_leaves_nothing(self):
        """When the reader of its output ends, the encode continues or fails, but leaves no partial file."""
        process = self.start_encoding("--json", "-o", "out.gscl", "--effort", "0")
        process.stdout.close()
        process.stderr.close()
        process.wait(timeout=TIMEOUT)
        self.assertIn(self.files(), (["in.png"], ["in.png", "out.gscl"]))

    def test_ignored_signal_stays_ignored(self):
        """nohup and background jobs of shells rely on it."""
        self.write_png("in.png", scene(64, 48))
        process = subprocess.Popen([GSCL, "encode", "in.png", "--quiet", "--effort", "9"], cwd=self.folder,
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        time.sleep(0.3)
        process.send_signal(signal.SIGHUP)
        self.assertEqual(process.wait(timeout=TIMEOUT), 0)


if __name__ == "__main__":
    main()
