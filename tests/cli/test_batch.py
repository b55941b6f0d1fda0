"""Runs over many images: lists, trees, reports, shards, and going on after a kill."""
import os
import pathlib
import shutil
import signal
import subprocess
import time
import unittest

from images import scene
from tool import FAST, GSCL, TIMEOUT, ToolTest, main, read_json_lines, restore_signals

SOME_FAILED = 3
RUN = ("--out-dir", "out", "--quiet", *FAST)


class BatchTest(ToolTest):
    """The folders x and y hold three images each, with the same names, and x a file that is no image."""

    def setUp(self):
        super().setUp()
        self.names = [f"{folder}/{i}.png" for folder in ("x", "y") for i in range(3)]
        for folder in ("x", "y"):
            self.path(folder).mkdir()
        for i, name in enumerate(self.names):
            self.write_png(name, scene(24 + i, 16))
        self.write("x/bad.png", b"no image")

    def write_list(self, *names, end="\n"):
        return self.write("list", "".join(name + end for name in names).encode())

    def outputs(self):
        return [name[4:] for name in self.files() if name.startswith("out/") and name.endswith(".gscl")]

    def report(self, name="report"):
        return read_json_lines(self.path(name).read_bytes())

    def states(self, name="report"):
        """The status of each input; each has one line."""
        states = {line["input"]: line["status"] for line in self.report(name)}
        self.assertEqual(len(states), len(self.report(name)))
        return states

    def run_batch(self, *arguments, code=0, **options):
        done = self.start("encode", *arguments, *RUN, **options)
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return [line for line in done.stderr.decode().splitlines() if line.startswith("gscl: ")]


class Lists(BatchTest):
    def test_names_of_a_list_and_of_the_command_line(self):
        self.write_list("x/1.png", "", "x/2.png")
        self.run_batch("x/0.png", "--files-from", "list")
        self.assertEqual(self.outputs(), ["0.gscl", "1.gscl", "2.gscl"])

    def test_names_that_end_with_nul(self):
        self.write_png("x/new\nline.png", scene(8, 8))
        self.write_list("x/0.png", "x/new\nline.png", end="\0")
        self.run_batch("--files-from", "list", "-0")
        self.assertEqual(self.outputs(), ["0.gscl", "new\nline.gscl"])

    def test_list_from_standard_input(self):
        self.run_batch("--files-from", "-", input=b"x/0.png\nx/1.png")
        self.assertEqual(self.outputs(), ["0.gscl", "1.gscl"])

    def test_list_of_nothing(self):
        self.write_list()
        self.run_batch("--files-from", "list", "--jsonl", "report")
        self.assertEqual(self.report(), [])

    def test_tree(self):
        self.write_list(*self.names, str(self.path("x/0.png")), "x/../y/0.png")
        errors = self.run_batch("--files-from", "list", "--keep-tree", "--jsonl", "report", code=SOME_FAILED)
        self.assertEqual(len(errors), 1)
        self.assertIn("x/../y/0.png", errors[0])
        absolute = str(self.path("x/0.gscl"))[1:]
        self.assertEqual(sorted(self.outputs()), sorted([name[:-4] + ".gscl" for name in self.names] + [absolute]))
        self.assertEqual([line["code"] for line in self.report() if line["status"] == "failed"], [100])

    def test_output_of_another_input(self):
        self.write_list(*self.names)
        errors = self.run_batch("--files-from", "list", "--jsonl", "report", code=SOME_FAILED)
        self.assertEqual(self.outputs(), ["0.gscl", "1.gscl", "2.gscl"])
        self.assertEqual(len(errors), 3)
        self.assertEqual([line["code"] for line in self.report()].count(103), 3)

    def test_misuse(self):
        for message, arguments in (
                ("usage", ()), ("--files-from", ("x/0.png", "-0")), ("--out-dir", ("x/0.png", "--keep-tree")),
                ("use --out-dir", ("--files-from", "list", "-o", "a.gscl")), ("1/1 to", ("x/0.png", "--shard", "0/3")),
                ("1/1 to", ("x/0.png", "--shard", "4/3")), ("1/1 to", ("x/0.png", "--shard", "1")),
                ("from 1 to 64", ("x/0.png", "--jobs", "0")), ("--jsonl", ("x/0.png", "--json", "--skip-existing"))):
            with self.subTest(arguments=arguments):
                self.refused("encode", message, "encode", *arguments, code=2)
        for name, message, arguments in (("missing", "No such file", ("--files-from", "missing")),
                                         ("x", "Is a directory", ("x/0.png", "--jsonl", "x"))):
            with self.subTest(arguments=arguments):
                self.refused(name, message, "encode", *arguments, "--out-dir", "out")


class Reports(BatchTest):
    def test_each_image_has_a_line(self):
        self.write_list("x/0.png", "x/bad.png", "x/missing.png")
        errors = self.run_batch("--files-from", "list", "--jsonl", "report", code=SOME_FAILED)
        self.assertEqual(len(errors), 2)
        self.assertEqual(self.states(), {"x/0.png": "ok", "x/bad.png": "failed", "x/missing.png": "failed"})
        for line in self.report():
            if line["status"] == "ok":
                self.assertEqual((line["code"], line["message"], line["width"], line["height"]), (0, None, 24, 16))
                self.assertEqual(line["bytes"], self.path(line["output"]).stat().st_size)
                self.assertGreater(line["psnr"], 10)
                self.assertIsNone(line["ssimulacra2"])
            else:
                self.assertEqual((line["code"], line["bytes"], line["psnr"]), (101, None, None))
                self.assertTrue(line["message"])

    def test_lines_have_the_score_that_is_the_target(self):
        self.write_list("x/0.png")
        self.run_batch("--files-from", "list", "--jsonl", "report", "--ssimulacra2", "5")
        [line] = self.report()
        self.assertGreaterEqual(line["ssimulacra2"], 5)

    def test_summary(self):
        self.write_list("x/0.png", "x/bad.png")
        self.write_png("x/1.png", scene(16, 16))
        self.gscl("encode", "x/1.png", "--out-dir", "out", "--quiet", *FAST)
        done = self.start("encode", "--files-from", "list", "x/1.png", "--skip-existing", "--out-dir", "out", *FAST)
        last = (done.stdout + done.stderr).decode().splitlines()
        self.assertTrue(any("1 encoded" in line and "1 skipped" in line and "1 failed" in line for line in last), last)

    def test_second_run_repeats_nothing_but_failures(self):
        self.write_list("x/0.png", "x/1.png", "x/bad.png")
        arguments = ("--files-from", "list", "--jsonl", "report", "--skip-existing")
        self.run_batch(*arguments, code=SOME_FAILED)
        times = {name: os.stat(self.path("out") / name).st_mtime_ns for name in self.outputs()}
        self.write_png("x/bad.png", scene(8, 8))
        self.run_batch(*arguments)
        self.assertEqual(self.states(), {"x/0.png": "ok", "x/1.png": "ok", "x/bad.png": "ok"})
        for name, old in times.items():
            self.assertEqual(os.stat(self.path("out") / name).st_mtime_ns, old)

    def test_cut_line_is_removed(self):
        self.write_list("x/0.png", "x/1.png")
        arguments = ("--files-from", "list", "--jsonl", "report", "--skip-existing")
        self.run_batch(*arguments)
        whole = self.path("report").read_bytes()
        self.write("report", whole[:-20])
        self.run_batch(*arguments)
        self.assertEqual(set(self.states()), {"x/0.png", "x/1.png"})

    def test_zeros_of_a_loss_of_power_are_removed(self):
        self.write_list("x/0.png", "x/1.png")
        arguments = ("--files-from", "list", "--jsonl", "report", "--skip-existing")
        self.run_batch(*arguments)
        whole = self.path("report").read_bytes()
        self.write("report", whole + bytes(5000))
        self.run_batch(*arguments)
        self.assertEqual(self.path("report").read_bytes(), whole)
        self.write("report", bytes(5000))  # not what a report begins with
        self.refused("encode", "report is no report", "encode", "x/0.png", "--jsonl", "report", "--out-dir", "out", code=2)

    def test_output_that_is_not_whole_is_made_again(self):
        for form in ((), ("--bare",), ("--base64",)):
            with self.subTest(form=form):
                suffix = "b64" if form == ("--base64",) else "gscl"
                arguments = ("x/0.png", "x/1.png", "x/2.png", "--skip-existing", *form)
                self.run_batch(*arguments)
                wholes = [self.path(f"out/{i}.{suffix}").read_bytes() for i in range(3)]
                self.write(f"out/0.{suffix}", wholes[0][:-8])
                self.write(f"out/1.{suffix}", bytes(len(wholes[1])))
                time = os.stat(self.path(f"out/2.{suffix}")).st_mtime_ns
                self.run_batch(*arguments)
                self.assertEqual([self.path(f"out/{i}.{suffix}").read_bytes() for i in range(3)], wholes)
                self.assertEqual(os.stat(self.path(f"out/2.{suffix}")).st_mtime_ns, time)

    def test_file_that_is_no_report_is_kept(self):
        self.write("report", b"something else\n")
        self.refused("encode", "report is no report", "encode", "x/0.png", "--jsonl", "report", "--out-dir", "out", code=2)
        self.assertEqual(self.path("report").read_bytes(), b"something else\n")

    def test_shards_are_all_of_it_once(self):
        self.write_list(*self.names)
        seen = []
        for i in range(1, 4):
            self.run_batch("--files-from", "list", "--keep-tree", "--shard", f"{i}/3", "--jsonl", f"report{i}")
            seen += [line["input"] for line in self.report(f"report{i}")]
        self.assertEqual(sorted(seen), self.names)
        self.assertEqual(len(self.outputs()), len(self.names))

    def test_jobs_do_not_change_files(self):
        self.write_list(*self.names)
        bytes_of = {}
        for jobs in ("1", "3", None):
            self.run_batch("--files-from", "list", "--keep-tree", *(("--jobs", jobs) if jobs else ()))
            bytes_of[jobs] = [self.path("out").joinpath(name).read_bytes() for name in self.outputs()]
        self.assertEqual(bytes_of["1"], bytes_of["3"])
        self.assertEqual(bytes_of["1"], bytes_of[None])

    def test_jobs_by_default(self):
        """As many as host has threads; each has opened its output."""
        for i in range(4):
            self.write_png(f"{i}.png", scene(320, 240))
        process = subprocess.Popen([GSCL, "encode", *(f"{i}.png" for i in range(4)), "--effort", "9", "--bpp", "1", "--quiet",
                                    "--threads", "3"], cwd=self.folder, preexec_fn=restore_signals)
        self.addCleanup(process.kill)
        most, deadline = 0, time.monotonic() + TIMEOUT
        while most < 3:
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll(), "ended before three images were encoded at a time")
            most = max(most, sum(name.startswith(".gscl-") for name in os.listdir(self.folder)))
            time.sleep(0.01)
        time.sleep(0.2)
        self.assertEqual(sum(name.startswith(".gscl-") for name in os.listdir(self.folder)), 3)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=TIMEOUT), 130)


class Chains(BatchTest):
    """Runs whose inputs other programs make, and reports that they read, in scripts of a shell where $G is the tool."""

    def shell(self, script):
        done = subprocess.run(["bash", "-c", f"set -e -o pipefail\n{script}"], cwd=self.folder, env={**os.environ, "G": GSCL},
                              capture_output=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return done.stdout.decode()

    def test_list_of_find(self):
        os.remove(self.path("x/bad.png"))
        self.write_png("x/new\nline.png", scene(8, 8))
        self.write_png(os.fsdecode(b"y/bad\xff.png"), scene(8, 8))
        self.shell("find x y -name '*.png' -print0 | $G encode -0 --files-from - --keep-tree --jsonl report --out-dir out --quiet --effort 0")
        names = [name[:-4] + ".gscl" for name in self.names]
        self.assertEqual(sorted(self.outputs()), sorted([*names, "x/new\nline.gscl", os.fsdecode(b"y/bad\xff.gscl")]))
        self.assertEqual({line["status"] for line in self.report()}, {"ok"})

    @unittest.skipUnless(shutil.which("jq"), "needs jq")
    def test_report_read_by_jq(self):
        run = "--out-dir out --quiet --effort 0"
        self.write_list("x/0.png", "x/bad.png", "x/1.png")
        self.shell(f"$G encode --files-from list --jsonl report {run} || [ $? = 3 ]")
        self.assertEqual(self.shell("jq -r 'select(.status == \"failed\").input' report"), "x/bad.png\n")
        self.write_png("x/bad.png", scene(8, 8))
        self.shell(f"jq -r 'select(.status == \"failed\").input' report | $G encode --files-from - --jsonl report {run}")
        self.assertEqual(self.states(), {"x/0.png": "ok", "x/1.png": "ok", "x/bad.png": "ok"})
        sizes = self.shell("jq -r .output report | while read -r name; do $G info \"$name\" --json | jq .bytes; done")
        self.assertEqual(sizes, self.shell("jq .bytes report"))

    def test_joined_reports_of_shards(self):
        """are a report of the whole, with which nothing is encoded again."""
        self.write_list(*self.names)
        run = "$G encode --files-from list --keep-tree --out-dir out --quiet --effort 0 --skip-existing"
        self.shell(f"for i in 1 2 3; do {run} --shard $i/3 --jsonl report.$i; done; cat report.[123] > report")
        before = self.path("report").read_bytes()
        self.assertEqual(self.states(), {name: "ok" for name in self.names})
        times = {name: os.stat(self.path("out") / name).st_mtime_ns for name in self.outputs()}
        self.shell(f"{run} --jsonl report")
        self.assertEqual(self.path("report").read_bytes(), before)
        self.assertEqual({name: os.stat(self.path("out") / name).st_mtime_ns for name in self.outputs()}, times)

    def test_lines_of_text(self):
        sizes = self.shell("$G encode x/0.png x/1.png x/2.png --quiet --effort 0 --base64 --bare --splats 9 | while read -r line; do "
                           "printf %s \"$line\" | $G info - --bare --base64; done")
        self.assertEqual([line for line in sizes.splitlines() if line.startswith("standard input: ")],
                         [f"standard input: {24 + i} x 16 RGB, 8 bits, format version 2" for i in range(3)])


class Kills(BatchTest):
    def start_run(self, count):
        for i in range(count):
            self.write_png(f"{i}.png", scene(48, 32))
        self.write_list(*[f"{i}.png" for i in range(count)])
        return [GSCL, "encode", "--files-from", "list", "--jsonl", "report", "--skip-existing", *RUN]

    def interrupt(self, command, number):
        """Ends a run when it has written a few lines."""
        process = subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE, preexec_fn=restore_signals)
        deadline = time.monotonic() + TIMEOUT
        while not self.path("report").exists() or self.path("report").read_bytes().count(b"\n") < 3:
            self.assertLess(time.monotonic(), deadline)
            self.assertIsNone(process.poll(), "ended before it could be interrupted")
            time.sleep(0.005)
        process.send_signal(number)
        process.communicate(timeout=TIMEOUT)
        return process.returncode

    def test_killed_run_goes_on(self):
        command = self.start_run(40)
        self.assertEqual(self.interrupt(command, signal.SIGKILL), -signal.SIGKILL)
        before = {name: os.stat(self.path("out") / name).st_mtime_ns for name in self.outputs()}
        self.assertLess(len(before), 40)
        done = subprocess.run(command, cwd=self.folder, capture_output=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(set(self.states()), {f"{i}.png" for i in range(40)})
        self.assertEqual(len(self.outputs()), 40)
        for name, old in before.items():
            self.assertEqual(os.stat(self.path("out") / name).st_mtime_ns, old)
        self.assertEqual([path for path in self.files() if pathlib.Path(path).name.startswith(".gscl-")], [])

    def test_interrupted_run_leaves_no_partial_output(self):
        command = self.start_run(40)
        self.assertEqual(self.interrupt(command, signal.SIGTERM), 128 + signal.SIGTERM)
        self.assertEqual([path for path in self.files() if pathlib.Path(path).name.startswith(".gscl-")], [])
        for name in self.outputs():
            self.gscl("info", f"out/{name}")


class Crashes(BatchTest):
    """libpng crashes on one of the images."""

    def setUp(self):
        super().setUp()
        self.write_png("x/crash.png", scene(13, 16))
        self.write_list("x/0.png", "x/crash.png", "x/1.png", "x/bad.png", "x/2.png")
        self.environment = {"LD_PRELOAD": os.environ["CRASHING_PNG_MODULE"]}

    def run_to_crash(self, *arguments, code, **options):
        done = self.start("encode", *arguments, *RUN, env=self.environment, **options)
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return done.stderr.decode()

    def test_other_images_are_encoded(self):
        states = {"x/0.png": "ok", "x/crash.png": "crashed", "x/1.png": "ok", "x/bad.png": "failed", "x/2.png": "ok"}
        for more in ((), ("--skip-existing",)):
            with self.subTest(more=more):
                arguments = ("--files-from", "list", "--jsonl", "report", *more)
                error = self.run_to_crash(*arguments, code=SOME_FAILED)
                self.assertIn("x/crash.png: the library that reads it has crashed; the run goes on without it", error)
                self.assertEqual([line["code"] for line in self.report() if line["status"] == "crashed"], [104])
                self.assertEqual(self.states(), states)
                self.assertEqual(self.outputs(), ["0.gscl", "1.gscl", "2.gscl"])
                error = self.run_to_crash(*arguments, code=SOME_FAILED)
                self.assertIn("x/crash.png: has crashed the library that reads it", error)
                self.assertEqual(self.states(), states)
                os.remove(self.path("report"))
                shutil.rmtree(self.path("out"))

    def test_names_from_standard_input(self):
        names = b"x/crash.png\nx/0.png\n"
        arguments = ("--files-from", "-", "--jsonl", "report")
        error = self.run_to_crash(*arguments, code=-signal.SIGSEGV, input=names)
        self.assertIn("x/crash.png: the library that reads it has crashed\n", error)
        self.run_to_crash(*arguments, code=SOME_FAILED, input=names)
        self.assertEqual(self.states(), {"x/crash.png": "crashed", "x/0.png": "ok"})

    def test_names_from_a_pipe(self):
        reader, writer = os.pipe()
        self.addCleanup(os.close, reader)
        os.write(writer, b"x/crash.png\nx/0.png\n")
        os.close(writer)
        error = self.run_to_crash("--files-from", f"/dev/fd/{reader}", "--jsonl", "report", code=-signal.SIGSEGV, pass_fds=(reader,))
        self.assertIn("x/crash.png: the library that reads it has crashed\n", error)

    def test_run_without_report(self):
        error = self.run_to_crash("--files-from", "list", code=-signal.SIGSEGV)
        self.assertIn("x/crash.png: the library that reads it has crashed", error)


if __name__ == "__main__":
    main()
