"""The scripts of tests/bench replace marked sections of a document, and nothing else; corpus.py collects pictures."""
import importlib.util
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from images import checkerboard, read_png, scene
from tool import GSCL, ToolTest, main

BENCH = pathlib.Path(__file__).parent.parent / "bench"
DOCUMENT = "# Figures\n\n<!-- rates -->\nold\n<!-- /rates -->\n\n<!-- efforts -->\nkept\n<!-- /efforts -->\n"


class BenchScripts(ToolTest):
    def run_script(self, name, *arguments):
        return subprocess.run([sys.executable, BENCH / f"{name}.py", self.folder, "--gscl", GSCL, *arguments],
                              cwd=self.folder, capture_output=True, text=True)

    def test_replaces_its_section_alone(self):
        self.write_png("a.png", scene(32, 32))
        self.write("page.md", DOCUMENT.encode())
        done = self.run_script("rate_distortion", "--rates", "4", "--document", "page.md", "--", "--effort", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        before, rest = DOCUMENT.split("old\n")
        text = self.path("page.md").read_text()
        self.assertTrue(text.startswith(before) and text.endswith(rest), text)
        section = text[len(before):-len(rest)]
        self.assertEqual(section, done.stdout)
        self.assertIn("rate_distortion.py FOLDER -- --effort 0`, 1 image.", section)
        self.assertEqual(sum(line.endswith("| 0 of 1 |") for line in section.splitlines()), 1, section)

    def test_prints_without_a_document(self):
        self.write_png("a.png", scene(32, 32))
        done = self.run_script("rate_distortion", "--rates", "4", "--", "--effort", "0")
        self.assertEqual((done.returncode, self.files()), (0, ["a.png"]), done.stderr)

    def test_parts_of_files(self):
        self.write_png("a.png", scene(64, 48))
        done = self.run_script("progressive", "--bytes", "400")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split(" | ") for line in done.stdout.splitlines() if line.startswith("| 400 ")]
        self.assertEqual([row[1] for row in rows], ["5 %", "10 %", "25 %", "50 %", "75 %", "100 %"])
        self.assertEqual(rows[-1][4], "+0.00")

    def test_refuses_a_document_without_the_section(self):
        self.write_png("a.png", scene(32, 32))
        self.write("page.md", DOCUMENT.encode())
        done = self.run_script("ablation", "--document", "page.md")
        self.assertEqual(done.returncode, 1)
        self.assertIn("page.md: needs one section between <!-- ablation --> and <!-- /ablation -->", done.stderr)


class CorpusList(unittest.TestCase):
    def test_each_line_names_a_kind_a_package_and_a_pattern_once(self):
        lines = (BENCH / "corpus.txt").read_text(encoding="ascii").splitlines()
        lines = [line for line in lines if line and not line.startswith("#")]
        for line in lines:
            self.assertRegex(line, r"^(photo|drawing|skip) [a-z0-9.+-]+/(bookworm|bullseye|trixie|noble|pypi) [^/ ].*$")
        self.assertEqual(len(set(line.split(" ", 1)[1] for line in lines)), len(lines))

    def test_leaves_out_test_pictures_in_common_use(self):
        text = (BENCH / "corpus.txt").read_text(encoding="ascii")
        self.assertEqual(re.findall(r"(?im)^[^#].*(?:kodim|lenn?a\b|baboon|mandrill|camera_?man|astronaut|coffee|chelsea).*$", text), [])


@unittest.skipUnless(shutil.which("dpkg-deb") and all(map(importlib.util.find_spec, ("numpy", "PIL"))),
                     "needs dpkg-deb, numpy and Pillow")
class Corpus(ToolTest):
    """Runs corpus.py on a package that is there already, so that nothing is downloaded."""
    PACKAGE, FOLDER = "pokerth-data", "usr/share/games/pokerth/gfx"

    def setUp(self):
        super().setUp()
        tree = self.path("tree")
        (tree / "DEBIAN").mkdir(parents=True)
        (tree / "DEBIAN" / "control").write_text(f"Package: {self.PACKAGE}\nVersion: 0\nArchitecture: all\n"
                                                 "Maintainer: none\nDescription: none\n")
        (tree / self.FOLDER).mkdir(parents=True)
        self.pictures = tree / self.FOLDER

    def corpus(self, *arguments):
        store = self.path("store") / "bookworm"
        store.mkdir(parents=True, exist_ok=True)
        subprocess.run(["dpkg-deb", "-Znone", "-b", self.path("tree"), store / f"{self.PACKAGE}_0_all.deb"], check=True,
                       capture_output=True)
        return subprocess.run([sys.executable, BENCH / "corpus.py", "out", "--packages", "store", "--only", self.PACKAGE, *arguments],
                              cwd=self.folder, capture_output=True, text=True)

    def collected(self):
        return {path.name: path.read_bytes() for path in sorted(self.path("out").rglob("*.png"))}

    def test_keeps_one_of_two_sizes_and_shrinks_it(self):
        self.write_png(self.pictures / "startwindowbg6.png", scene(780, 520))
        self.write_png(self.pictures / "startwindowbg7.png", scene(480, 320))
        done = self.corpus()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("total: 0 photo, 1 drawing, 1 skip", done.stdout)
        (name, data), = self.collected().items()
        self.assertEqual(name, f"{self.PACKAGE}.gfx_startwindowbg6.png")
        picture = read_png(data)
        self.assertEqual((picture.width, picture.height, picture.channels, picture.depth), (387, 258, 3, 8))  # 0.1 megapixels by its name
        shutil.rmtree(self.path("out"))
        self.assertEqual(self.corpus().returncode, 0)
        self.assertEqual(self.collected(), {name: data})

    def test_refuses_a_folder_with_pictures(self):
        self.path("out").mkdir()
        self.write_png("out/a.png", scene(32, 32))
        done = self.corpus()
        self.assertEqual((done.returncode, self.collected().keys()), (1, {"a.png"}))
        self.assertIn("out: holds pictures already; name an empty folder", done.stderr)

    def test_refuses_two_pictures_of_one_name(self):
        self.write_png(self.pictures / "startwindowbg.png", scene(400, 300))
        self.write_png(self.pictures / "startwindowbg.PNG", checkerboard(400, 300, 100))
        done = self.corpus()
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("corpus.txt: two pictures have the name pokerth-data.gfx_startwindowbg, the second is usr/share", done.stderr)

    def test_refuses_a_package_that_the_list_lacks(self):
        done = self.corpus("--only", "none")
        self.assertEqual((done.returncode, self.path("out").exists()), (1, False))
        self.assertIn("--only none: names no package of corpus.txt", done.stderr)


if __name__ == "__main__":
    main()
