"""The media type and the magic bytes of gscl files, as file(1) and the desktop (shared-mime-info) recognise them."""
import os
import pathlib
import shutil
import subprocess
import unittest

from gscl_file import contained
from images import scene
from tool import ToolTest, main

DATA = pathlib.Path(__file__).resolve().parents[2] / "host/data"


def needs(*programs):
    missing = [program for program in programs if not shutil.which(program)]
    return unittest.skipIf(missing, f"not installed: {', '.join(missing)}")


class Identity(ToolTest):
    def setUp(self):
        super().setUp()
        self.file = self.encode(scene(20, 20))
        self.write("name_without_suffix", self.file)
        self.write("blocks", contained(self.file[5:-2], before=b"\x80\x02\x01\x0d", after=b"\xa0\x01x"))
        self.write("unknown.gscl", bytes(9))
        self.write("other", b"gsc\x02" + self.file[4:])

    def run_program(self, *words, **variables):
        done = subprocess.run(list(map(str, words)), cwd=self.folder, env={**os.environ, **variables}, capture_output=True,
                              text=True, check=True)
        return done.stdout.strip()

    def magic(self, name, *options):
        return self.run_program("file", "-b", "-m", DATA / "gscl.magic", *options, name)

    @needs("file")
    def test_magic_of_file(self):
        self.assertEqual(self.magic("name_without_suffix"), "gscl image, version 2")
        self.assertEqual(self.magic("blocks"), "gscl image, version 2, with a profile or other data before the picture, with "
                                               "metadata after the picture")
        self.assertEqual(self.magic("name_without_suffix", "--mime-type"), "image/x-gscl")
        self.assertEqual(self.magic("name_without_suffix", "--extension"), "gscl")
        self.assertNotIn("gscl", self.magic("other"))

    @needs("file")
    def test_file_takes_it_for_no_other_type(self):
        self.assertEqual(self.run_program("file", "-b", "--mime-type", "name_without_suffix"), "application/octet-stream")

    @needs("update-mime-database", "gio")
    def test_media_type(self):
        mime = self.path("share/mime")
        (mime / "packages").mkdir(parents=True)
        shutil.copy(DATA / "gscl.xml", mime / "packages")
        self.run_program("update-mime-database", mime)
        folders = f"{self.path('share')}:/usr/local/share:/usr/share"
        for name, expected in (("name_without_suffix", "image/x-gscl"), ("in.gscl", "image/x-gscl"), ("blocks", "image/x-gscl"),
                               ("unknown.gscl", "image/x-gscl"), ("other", "application/octet-stream"),
                               ("in.image", "image/png")):
            with self.subTest(name=name):
                text = self.run_program("gio", "info", "-a", "standard::content-type", name, XDG_DATA_DIRS=folders,
                                        XDG_DATA_HOME=str(self.path("none")))
                self.assertIn(f"standard::content-type: {expected}", text)


if __name__ == "__main__":
    main()
