"""gscl export: splats as SVG, PLY and CSV."""
import csv
import io
import re
import shutil
import unittest
import xml.etree.ElementTree as ElementTree

from images import Image, psnr, read_png, scene
from tool import ToolTest, main

SVG = "{http://www.w3.org/2000/svg}"
# dB, means of SEEDS files: what was measured less 2.  One file differs from the next by up to 3, with the places where
# splats happen to lie.
MIN_PSNR = {"normalized": 25.5, "alpha": 24.5, "sum": 24, "grey": 28.5}
SEEDS = (1, 2, 3, 4, 5, 6)
COLUMNS = ["x", "y", "sigma1", "sigma2", "theta", "opacity", "red", "green", "blue", "alpha", "wave_x", "wave_y", "wave_phase",
           "wave_amplitude", "layer"]


class Tables(ToolTest):
    def rows(self, *arguments):
        text = self.gscl("export", "in.gscl", "-o", "-", "--csv", *arguments).decode()
        return list(csv.reader(io.StringIO(text)))

    def test_csv(self):
        self.encode(scene(60, 40), "--splats", 12)
        head, *rows = self.rows()
        self.assertEqual(head, COLUMNS)
        self.assertEqual(len(rows), self.gscl_json("info", "in.gscl")["splats"])
        for row in rows:
            x, y, sigma1, sigma2, theta, opacity, *colours = map(float, row[:10])
            self.assertTrue(-60 < x < 120 and -40 < y < 80 and 0 < sigma1 and 0 < sigma2, row)
            self.assertTrue(0 <= theta <= 3.15 and 0 <= opacity <= 1 and colours[3] == 1, row)

    def test_values_draw_the_picture(self):
        """The columns suffice to draw the picture, but for its background: FORMAT.md, blend normalized."""
        from math import cos, exp, sin
        image = scene(30, 20)
        self.encode(image, "--effects=-texture", "--bytes", 300)
        splats = [list(map(float, row[:10])) for row in self.rows()[1:]]
        drawn = []
        for y in range(20):
            for x in range(30):
                total, sums = 1e-9, [0, 0, 0]
                for cx, cy, s1, s2, theta, opacity, *colour in splats:
                    dx, dy = x + 0.5 - cx, y + 0.5 - cy
                    u, v = dx * cos(theta) + dy * sin(theta), dy * cos(theta) - dx * sin(theta)
                    weight = opacity * max(0, exp(-((u / s1) ** 2 + (v / s2) ** 2) / 2) - exp(-7))
                    total += weight
                    sums = [a + weight * c for a, c in zip(sums, colour)]
                drawn += [255 * min(max(a / total, 0), 1) for a in sums]
        errors = sorted(abs(a - b) for a, b in zip(drawn, self.decode().samples))
        self.assertLess(errors[len(errors) * 9 // 10], 2)

    def test_ply(self):
        self.encode(scene(60, 40), "--splats", 12)
        self.gscl("export", "in.gscl", "-o", "out.ply")
        head, body = self.path("out.ply").read_text().split("end_header\n")
        self.assertTrue(head.startswith("ply\nformat ascii 1.0\ncomment gscl width=60 height=40 channels=3 bits=8 blend=normalized "))
        self.assertEqual(re.findall("property [a-z]+ (.*)", head), ["x", "y", "z"] + COLUMNS[2:])
        expected = [row[:2] + ["0"] + row[2:] for row in self.rows()[1:]]
        self.assertEqual([line.split() for line in body.splitlines()], expected)
        self.assertIn(f"element vertex {len(expected)}\n", head)

    def test_errors(self):
        self.encode(scene(30, 20))
        self.refused("export", "-o is missing", "export", "in.gscl", code=2)
        self.refused("export", "out.obj: the format is not known by its name; add --svg, --ply or --csv", "export", "in.gscl",
                     "-o", "out.obj", code=2)
        self.refused("export", "exclude each other", "export", "in.gscl", "-o", "x.svg", "--svg", "--csv", code=2)
        self.write("cut.gscl", self.path("in.gscl").read_bytes()[:50])
        for suffix in ("svg", "csv"):
            self.refused("cut.gscl", "the file is incomplete", "export", "cut.gscl", "-o", f"x.{suffix}")


class Svg(ToolTest):
    def export(self, image, *arguments):
        self.encode(image, *arguments)
        self.gscl("export", "in.gscl", "-o", "out.svg")
        return ElementTree.parse(self.path("out.svg")).getroot()

    def test_structure(self):
        root = self.export(scene(96, 64))
        self.assertEqual((root.get("width"), root.get("height"), root.get("viewBox")), ("96", "64", "0 0 96 64"))
        self.assertIn("An approximation, by gscl", root.find(f"{SVG}desc").text)
        gradients = {gradient.get("id") for gradient in root.iter(f"{SVG}radialGradient")}
        ellipses = list(root.iter(f"{SVG}ellipse"))
        self.assertEqual({f"url(#{name})" for name in gradients}, {ellipse.get("fill") for ellipse in ellipses})
        self.assertLessEqual(len(ellipses), self.gscl_json("info", "in.gscl")["splats"])
        self.assertGreater(len(ellipses), 10)

    def closeness(self, image, *arguments):
        """PSNR of librsvg's drawing of the SVG file beside the decoded picture, dB."""
        self.export(image, *arguments)
        self.gscl("decode", "in.gscl", "-o", "in.png", "--device", "host")
        done = self.start("out.svg", "-o", "svg.png", program="rsvg-convert")
        self.assertEqual(done.returncode, 0, done.stderr)
        shown, exact = (read_png(self.path(file).read_bytes()) for file in ("svg.png", "in.png"))
        colours = [s for at, s in enumerate(shown.samples) if shown.channels == 3 or at % 4 < 3]
        samples = [s for s in exact.samples for _ in range(3 if image.channels == 1 else 1)]
        return psnr(Image(96, 64, 3, 8, colours), Image(96, 64, 3, 8, samples))

    @unittest.skipUnless(shutil.which("rsvg-convert"), "needs rsvg-convert")
    def test_comes_close(self):
        """Each blend and grey, drawn by librsvg."""
        cases = {"normalized": (3, ()), "alpha": (3, ("--blend", "alpha")), "sum": (3, ("--blend", "sum")), "grey": (1, ())}
        for name, (channels, arguments) in cases.items():
            with self.subTest(name=name):
                image = scene(96, 64, channels)
                reached = [self.closeness(image, "--seed", seed, *arguments) for seed in SEEDS]
                self.assertGreater(sum(reached) / len(reached), MIN_PSNR[name], reached)

    def test_limits(self):
        self.encode(scene(60, 40), "--splats", 12)
        export = ("export", "in.gscl", "-o", "x.svg")
        self.refused("in.gscl", "max_work.*; --max-work raises this limit", *export, "--max-work", 1)
        self.refused("in.gscl", "max_pixels.*; --max-pixels raises this limit", *export, "--max-pixels", 1)

    def test_background_alone(self):
        root = self.export(scene(8, 8), "--effects=-chroma", "--splats", 1)
        self.assertEqual(len(list(root.iter(f"{SVG}rect"))), 1)


if __name__ == "__main__":
    main()
