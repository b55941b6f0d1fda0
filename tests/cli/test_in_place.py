"""Outputs that are no files to be replaced: descriptors, pipes and devices, which every command writes in place."""
import os
import pathlib
import pty
import re
import subprocess

from images import read_png, scene
from tool import FAST, GSCL, TIMEOUT, ToolTest, main, read_json_lines

CODED = pathlib.Path(__file__).parents[1] / "conformance/files/photograph.gscl"
SUFFIXES = ("png", "jpg", "tif", "exr", "ppm", "bmp", "tga")


def undated(data):
    """Without the time of writing, which OpenImageIO puts into OpenEXR."""
    return re.sub(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d", b"", data)


class InPlace(ToolTest):
    def setUp(self):
        super().setUp()
        self.file = CODED.read_bytes()
        self.write("in.gscl", self.file)
        self.write_png("in.png", scene(40, 30))
        self.data = self.gscl("export", "in.gscl", "--csv", "-o", "-")

    def shell(self, script, code=0):
        """The output of a script, in which the tool is $G, E encodes in.png, and W writes self.data, the quickest output."""
        functions = 'E() { "$G" encode in.png --quiet --effort 0 "$@"; }\nW() { "$G" export in.gscl --csv "$@"; }\n'
        done = subprocess.run(["bash", "-c", functions + script], cwd=self.folder, env={**os.environ, "G": GSCL},
                              capture_output=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, code, done.stderr.decode())
        self.error = done.stderr.decode()
        return done.stdout

    def written(self, name):
        """A file that a process substitution writes, which the shell does not wait for."""
        return self.shell(f"until [ -e {name}.done ]; do sleep 0.1; done; cat {name}")


class Places(InPlace):
    def test_names_of_standard_output(self):
        self.path("link").symlink_to("/dev/stdout")
        self.path("far").symlink_to("link")
        for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "/proc/thread-self/fd/1", "link", "far"):
            with self.subTest(name=name):
                self.assertEqual(self.shell(f"W -o {name} | cat"), self.data)
        self.assertEqual(self.shell('cd /dev/fd && "$G" export "$OLDPWD/in.gscl" --csv -o 1 | cat'), self.data)
        self.assertTrue(self.path("link").is_symlink())
        self.assertEqual(self.files(), ["far", "in.gscl", "in.png", "link"])

    def test_other_descriptors(self):
        self.assertEqual(self.shell("W -o /dev/fd/7 7>&1 | cat"), self.data)
        self.assertEqual(self.shell("W -o /dev/stderr 2>&1 | cat"), self.data)
        self.assertEqual(self.shell("W -o /proc/self/fd/12 12>&1 >/dev/full | cat"), self.data)

    def test_process_substitution(self):
        self.shell("W -o >(cat > got; : > got.done)")
        self.assertEqual(self.written("got"), self.data)

    def test_file_of_the_shell_goes_on(self):
        """What others have written before stays, and what they write afterwards follows."""
        self.write("log", b"old")
        for script, before in (("(printf hello; W -o %s; printf bye) > both", b"hello"), ("(W -o %s; printf bye) > both", b""),
                               ("cp log both; (W -o %s; printf bye) >> both", b"old")):
            for name in ("-", "/dev/stdout"):
                with self.subTest(script=script, name=name):
                    self.shell(script % name)
                    self.assertEqual(self.path("both").read_bytes(), before + self.data + b"bye")
        self.shell("exec 5> both; printf hello >&5; W -o /dev/fd/5; printf bye >&5")
        self.assertEqual(self.path("both").read_bytes(), b"hello" + self.data + b"bye")
        os.link(self.path("both"), self.path("other name"))
        self.shell("W -o /dev/fd/5 5<> both")
        self.assertTrue(self.path("both").samefile(self.path("other name")))

    def test_named_pipe(self):
        os.mkfifo(self.path("pipe"))
        self.assertEqual(self.shell("cat pipe & W -o pipe; wait"), self.data)
        self.assertTrue(self.path("pipe").is_fifo())

    def test_descriptor_of_another_process(self):
        self.assertEqual(self.shell("(W -o /proc/$$/fd/1) | cat > none; cat none"), self.data)
        self.assertEqual(self.path("none").read_bytes(), b"")

    def test_encode(self):
        file = self.encode(scene(40, 30))
        self.assertEqual(self.shell("E -o /dev/stdout | cat"), file)
        self.shell("E -o >(cat > got; : > got.done)")
        self.assertEqual(self.written("got"), file)
        text = self.shell("E --base64")
        self.assertEqual(self.shell("E --base64 -o /dev/fd/5 5>&1 | cat"), text)

    def test_devices(self):
        self.shell("W -o /dev/null")
        self.refused("/dev/full", "cannot be written: No space left on device", "export", "in.gscl", "--csv", "-o", "/dev/full")
        for name in ("/dev/stdout", "/dev/fd/1", "-"):
            with self.subTest(name=name):
                self.shell(f"W -o {name} > /dev/full", code=1)
                self.assertRegex(self.error, r"\Agscl: [^\n]*: cannot be written: No space left on device\n\Z")

    def test_reader_that_ends(self):
        script = "{ until [ -e closed ]; do sleep 0.1; done; W -o /dev/stdout; echo $? > code; } | { exec <&-; touch closed; }; cat code"
        self.assertEqual(self.shell(script), b"141\n")

    def test_descriptors_that_cannot_be_written(self):
        for words in ("-o - >&-", "-o /dev/stdout >&-", "-o /dev/fd/9 9>&-", "-o /dev/fd/9 9< in.png", "-o /dev/fd/99999999"):
            with self.subTest(words=words):
                self.assertEqual(self.shell(f"W {words}", code=1), b"")
                self.assertRegex(self.error, r"\Agscl: (/dev/\S+|standard output): cannot be written: Bad file descriptor\n\Z")

    def test_terminals(self):
        terminal, other_end = pty.openpty()
        self.addCleanup(os.close, terminal)
        self.addCleanup(os.close, other_end)
        for name in ("-", "/dev/stdout", os.ttyname(other_end)):
            with self.subTest(name=name):
                self.refused(name if "pts" in name else "standard output", "is a terminal; redirect it", "encode", "in.png",
                             "-o", name, *FAST, stdout=other_end, stderr=subprocess.PIPE)

    def test_reports_and_bytes_do_not_mix(self):
        self.refused("encode", "--json and -o - both write", "encode", "in.png", "--json", "-o", "/dev/stdout", *FAST, code=2)
        self.refused("encode", "need output files", "encode", "in.png", "--skip-existing", "-o", "/dev/fd/1", *FAST, code=2)


class Reports(InPlace):
    def test_jsonl(self):
        for words in ("--jsonl - | cat", "--jsonl /dev/stdout | cat", "--jsonl /dev/fd/6 6>&1 | cat"):
            with self.subTest(words=words):
                line, = read_json_lines(self.shell(f"E --out-dir out {words}"))
                self.assertEqual((line["status"], line["output"]), ("ok", "out/in.gscl"))
        self.shell("E --out-dir out --jsonl >(cat > got; : > got.done)")
        self.assertEqual(read_json_lines(self.written("got"))[0]["status"], "ok")
        os.mkfifo(self.path("pipe"))
        self.assertEqual(read_json_lines(self.shell("cat pipe & E --out-dir out --jsonl pipe; wait"))[0]["status"], "ok")

    def test_file_of_the_shell_goes_on(self):
        self.shell("(echo '{}'; E --out-dir out --jsonl /dev/stdout; echo '[]') > both")
        first, line, last = read_json_lines(self.path("both").read_bytes())
        self.assertEqual((first, line["status"], last), ({}, "ok", []))

    def test_full_disk(self):
        done = self.start("encode", "in.png", "--quiet", "--out-dir", "out", "--jsonl", "/dev/full", *FAST)
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"gscl: /dev/full: cannot be written: No space left on device", done.stderr)


class Images(InPlace):
    def test_every_format(self):
        """Also those whose files are not written from the front to the end.  The size is above that of a pipe."""
        decode = '"$G" decode in.gscl --size 200x150 --device host -o'
        for suffix in SUFFIXES:
            with self.subTest(suffix=suffix):
                file, link, pipe = f"file.{suffix}", f"link.{suffix}", f"pipe.{suffix}"
                self.shell(f"{decode} {file}")
                expected = undated(self.path(file).read_bytes())
                os.mkfifo(self.path(pipe))
                self.path(link).symlink_to("/dev/stdout")
                self.assertEqual(undated(self.shell(f"cat {pipe} & {decode} {pipe}; wait")), expected)
                self.assertEqual(undated(self.shell(f"{decode} {link} | cat")), expected)
                self.shell(f"(printf hello; {decode} {link}; printf bye) > both")
                self.assertEqual(undated(self.path("both").read_bytes()), b"hello" + expected + b"bye")
                self.shell(f"({decode} {link}; printf bye) >> both")
                self.assertEqual(undated(self.path("both").read_bytes()), b"hello" + expected + b"bye" + expected + b"bye")

    def test_full_disk(self):
        for suffix in SUFFIXES:
            with self.subTest(suffix=suffix):
                self.path(f"full.{suffix}").symlink_to("/dev/full")
                self.refused(f"full.{suffix}", "cannot be written: No space left on device", "decode", "in.gscl", "-o",
                             f"full.{suffix}")

    def test_pipes_without_suffix_take_png(self):
        expected = self.decode()
        for words in ("-o - | cat", "-o /dev/stdout | cat", "-o /dev/fd/5 5>&1 | cat"):
            with self.subTest(words=words):
                self.assertEqual(read_png(self.shell(f"\"$G\" decode in.gscl {words}")), expected)
        self.shell("\"$G\" decode in.gscl -o >(cat > got; : > got.done)")
        self.assertEqual(read_png(self.written("got")), expected)

    def test_draw_and_export(self):
        self.gscl("draw", "in.gscl", "-o", "drawn.png")
        self.assertEqual(self.shell("\"$G\" draw in.gscl -o /dev/stdout | cat"), self.path("drawn.png").read_bytes())
        for suffix in ("svg", "ply", "csv"):
            with self.subTest(suffix=suffix):
                self.gscl("export", "in.gscl", "-o", f"out.{suffix}")
                self.assertEqual(self.shell(f"\"$G\" export in.gscl --{suffix} -o /dev/stdout | cat"),
                                 self.path(f"out.{suffix}").read_bytes())

    def test_input_may_be_written_over_in_place(self):
        """The shell has emptied or opened such a file before the tool starts."""
        self.shell("\"$G\" decode in.gscl -o /dev/stdout >> in.gscl")
        self.assertEqual(self.path("in.gscl").read_bytes()[:len(self.file)], self.file)


if __name__ == "__main__":
    main()
