"""The scripts of tests/bench replace marked sections of a document, and nothing else; corpus.py collects pictures."""
import base64
import csv
import importlib.util
import math
import os
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import unittest

from images import Image, checkerboard, read_png, scene
from tool import GSCL, ToolTest, main

BENCH = pathlib.Path(__file__).parent.parent / "bench"
sys.path.insert(0, str(BENCH))
import codec  # noqa: E402
import other_codecs  # noqa: E402
import tiny  # noqa: E402

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


class OtherCodecs(unittest.TestCase):
    def test_files_on_either_side_of_a_size(self):
        encoded = []

        def encode(quality):
            encoded.append(quality)
            return bytes(100 + 10 * quality)

        self.assertEqual(list(map(len, other_codecs.around(encode, 355))), [350, 360])
        self.assertEqual(list(map(len, other_codecs.around(encode, 360))), [360, 370])
        self.assertEqual(list(map(len, other_codecs.around(encode, 100))), [100, 110])
        self.assertEqual(list(map(len, other_codecs.around(encode, 5000))), [1090])
        self.assertEqual(other_codecs.around(encode, 99), [])
        self.assertLessEqual(set(encoded), set(range(other_codecs.BEST_QUALITY + 1)))

    def test_payload_of_an_avif_file(self):
        boxes = struct.pack(">I4s4x", 12, b"ftyp") + struct.pack(">I4s", 8 + 40, b"mdat") + bytes(40) + struct.pack(">I4s", 8, b"free")
        self.assertEqual(tiny.payload_size(boxes), 40)
        self.assertEqual(tiny.payload_size(struct.pack(">I4s", 0, b"mdat") + bytes(25)), 25)  # up to the end
        with self.assertRaises(SystemExit):
            tiny.payload_size(struct.pack(">I4s", 8, b"ftyp"))

    def test_interpolates_in_the_logarithm_of_the_size(self):
        self.assertAlmostEqual(codec.at_rate([(100, 10.0), (400, 20.0)], 200), 15)
        self.assertAlmostEqual(codec.at_rate([(100, 10.0), (200, 20.0), (400, 50.0)], math.sqrt(80000)), 35)
        self.assertIsNone(codec.at_rate([(100, 10.0), (400, 20.0)], 90))
        self.assertIsNone(codec.at_rate([(100, 10.0), (400, 20.0)], 420))


class Perceptual(ToolTest):
    """Butteraugli and DSSIM are programs that may be missing here: scripts that print figures stand in for them."""

    def setUp(self):
        super().setUp()
        self.program("butteraugli_main", "echo 9.5; echo 3-norm: 2.5")
        self.program("dssim", "printf '0.0125\\t%s\\n' \"$2\"")
        self.write_png("a.png", scene(96, 64, 3))

    def program(self, name, text):
        self.path("bin").mkdir(exist_ok=True)
        self.write(f"bin/{name}", f"#!/bin/sh\n{text}\n".encode())
        self.path(f"bin/{name}").chmod(0o755)

    def perceptual(self, *arguments, path=None):
        environment = {**os.environ, "PATH": path or f"{self.path('bin')}:{os.environ['PATH']}"}
        return subprocess.run([sys.executable, BENCH / "perceptual.py", self.folder, "--gscl", GSCL, *arguments],
                              cwd=self.folder, capture_output=True, text=True, env=environment)

    def test_variants_without_other_codecs(self):
        done = self.perceptual("--codecs", "", "--bytes", "200,400", "--csv", "out.csv", "--variant", "--effort 0",
                               "--variant", "--effort 0 --tune ssim")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("out.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["codec"], row["image"], row["budget"]) for row in rows],
                         [(f"gscl --effort 0{tune}", "a", size) for size in ("200", "400") for tune in ("", " --tune ssim")])
        for row in rows:
            self.assertTrue(0 < int(row["bytes"]) <= int(row["budget"]))
            self.assertEqual((float(row["butteraugli"]), float(row["dssim"])), (2.5, 12.5))
        score = [float(row["ssimulacra2"]) for row in rows]
        self.assertLess(score[0], score[2])
        self.assertIn(f"\n| gscl --effort 0 | {score[0]:.1f} | {score[2]:.1f} |\n", done.stdout)
        self.assertIn("\n| gscl --effort 0 --tune ssim | 12.5 | 12.5 |\n", done.stdout)
        self.assertIn(f"\n| against gscl --effort 0 --tune ssim | {score[0] - score[1]:+.1f} ({int(score[0] > score[1])} of 1)",
                      done.stdout)

    def test_names_what_is_missing(self):
        done = self.perceptual(path="/nonexistent")
        self.assertEqual(done.returncode, 1)
        self.assertIn("butteraugli_main: not found; it comes with Debian's package libjxl-devtools", done.stderr)
        done = self.perceptual("--codecs", "AVIF,H")
        self.assertEqual((done.returncode, done.stderr.split(";")[0]), (1, "--codecs: no codec is called H"))

    def test_a_program_that_prints_no_figure(self):
        self.program("dssim", "echo broken >&2; exit 1")
        done = self.perceptual("--codecs", "", "--bytes", "200", "--variant", "--effort 0")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"bin/dssim \S+a\.png \S+: broken\n\Z")

    @unittest.skipUnless(all(map(importlib.util.find_spec, ("PIL", "matplotlib", "pillow_jxl"))),
                         "needs the packages of tests/bench/requirements.txt")
    def test_other_codecs(self):
        self.write("page.md", DOCUMENT.replace("rates", "perceptual").encode())
        done = self.perceptual("--variant", "--effort 0", "--bytes", "450,1500", "--csv", "out.csv", "--document", "page.md")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("</svg>", self.path("perceptual.svg").read_text())
        self.assertIn(done.stdout, self.path("page.md").read_text())
        with open(self.path("out.csv"), newline="", encoding="utf-8") as file:
            rows = {row["codec"]: row for row in csv.DictReader(file) if row["budget"] == "1500"}
        self.assertEqual(set(rows), {"gscl --effort 0", "best AVIF", *other_codecs.CODECS})
        best = max((rows[name] for name in other_codecs.AVIF_NAMES), key=lambda row: float(row["ssimulacra2"]))
        self.assertEqual({**best, "codec": "best AVIF"}, rows["best AVIF"])
        for row in rows.values():
            self.assertLessEqual(int(row["bytes"]), 1500)
            self.assertGreater(float(row["psnr"]), 10)


@unittest.skipUnless(all(map(importlib.util.find_spec, ("PIL", "numpy", "pillow_jxl"))),
                     "needs the packages of tests/bench/requirements.txt")
class Crops(ToolTest):
    SIZE, GAP = 32, 8

    def picture(self):
        """Noise in the left half, nothing in the next quarter, one strong edge in the last."""
        noise = random.Random(1)
        samples = [noise.randrange(60, 190) if x < 96 else 128 if x < 144 else 250 if x > 168 else 5
                   for y in range(40) for x in range(192) for c in range(3)]
        return Image(192, 40, 3, 8, samples)

    def crops(self, *arguments):
        done = subprocess.run([sys.executable, BENCH / "crops.py", self.folder, "--gscl", GSCL, "--out", "made/page", "--size",
                               str(self.SIZE), *arguments], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.path("made/page/index.html").read_text()

    def test_page(self):
        source = self.picture()
        self.write_png("a<b.png", source)
        page = self.crops("--bytes", "400,900", "--variant", "--effort 0")
        self.assertEqual(sorted(path.name for path in self.path("made/page").iterdir()), sorted(
            ["index.html", *(f"a<b-{size}-{kind}.png" for size in (400, 900) for kind in ("texture", "edges", "flat"))]))
        self.assertEqual(re.findall("<h2>(.*)</h2>", page), ["a&lt;b, 400 bytes", "a&lt;b, 900 bytes"])
        self.assertNotRegex(page, "src=.(?!data:)|https?:")
        rows = re.findall(r"<p>(\w+), from pixel (\d+), (\d+)</p>\n<table><tr>\n(.*?)</tr>", page, re.S)
        self.assertEqual([row[0] for row in rows], 2 * ["texture", "edges", "flat"])
        for budget, (kind, x, y, cells) in zip((400, 400, 400, 900, 900, 900), rows):
            x, y = int(x), int(y)
            crops = [read_png(base64.b64decode(data)) for data in re.findall("base64,([^\"]*)", cells)]
            self.assertEqual(crops[0], source.crop(x, y, self.SIZE, self.SIZE))
            self.assertEqual([(crop.width, crop.height) for crop in crops], 3 * [(self.SIZE, self.SIZE)])
            self.assertRegex(cells, r"<b>original</b>(?s:.*)<b>gscl --effort 0</b>(?s:.*)<b>AVIF( half| quarter)?</b>")
            self.assertTrue(all(0 < int(size) <= budget for size in re.findall(r"(\d+) bytes, SSIMULACRA 2 -?\d", cells)))
            self.assertEqual({"texture": x <= 64, "edges": 136 < x <= 168, "flat": 96 <= x <= 112}[kind], True, (kind, x))
            row = read_png(self.path(f"made/page/a<b-{budget}-{kind}.png").read_bytes())
            self.assertEqual((row.width, row.height), (3 * self.SIZE + 2 * self.GAP, self.SIZE))
            self.assertEqual(row.crop(self.SIZE + self.GAP, 0, self.SIZE, self.SIZE), crops[1])

    def test_small_pictures_and_small_files(self):
        self.write_png("a.png", scene(24, 40, 3))
        page = self.crops("--bytes", "60", "--variant", "--effort 0")
        self.assertNotIn("AVIF", page)
        self.assertEqual(page.count('width="24" height="32"'), 6)

    def test_artefacts_of_two_builds(self):
        self.write_png("kodim23.png", scene(400, 390, 3))
        self.write_png("other.png", scene(24, 40, 3))
        done = subprocess.run([sys.executable, BENCH / "artefacts.py", self.folder, "--gscl", GSCL, "--and", GSCL, "--out",
                               "made/page"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.path("made/page/index.html").read_text()
        self.assertEqual(re.findall("<h2>(.*)</h2>", page), ["shapes that are not there: kodim23, 150 bytes"])
        crops = [read_png(base64.b64decode(data)) for data in re.findall("base64,([^\"]*)", page)]
        self.assertEqual(crops[0], scene(400, 390, 3).crop(128, 128, 256, 256))
        self.assertEqual(crops[1], crops[2])


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
