"""gscl tradeoff writes every table and plot, and their figures are consistent; no test bounds a time."""
import csv
import math
import os
import pathlib
import unittest
import xml.etree.ElementTree

from images import flat, read_png, scene
from tool import GSCL, NO_OPENCL, ToolTest, main, read_json

WIDTH, HEIGHT = 96, 72
TABLES = {"quality_time.csv", "quality_rate.csv", "trace.csv", "accuracy.csv", "gradients.csv", "tradeoff.json"}
PLOTS = ("quality_time", "quality_rate", "accuracy", "gradients")
HAS_PLOTS = pathlib.Path(GSCL).with_name("gscl-plot.so").exists()
BLENDS = {"normalized", "alpha", "sum"}
SERIES_BLUE = (0, 94, 168)  # host/tool/plot/plot_cairo.c


class Tradeoff(ToolTest):
    @classmethod
    def setUpClass(cls):
        cls.kept = None

    def measured(self):
        """The files and the output of one run, shared by all tests."""
        if not Tradeoff.kept:
            self.write_png("in.png", scene(WIDTH, HEIGHT))
            printed = self.gscl("tradeoff", "in.png", "--quick", "--bytes", "400", "--out", "new").decode()
            self.assertEqual(sorted(set(self.files()) - {"new", "in.png"}),
                             sorted(f"new/{name}" for name in self.expected_files()))
            files = {path.name: path.read_bytes() for path in self.path("new").iterdir()}
            Tradeoff.kept = files, printed
        return Tradeoff.kept

    @staticmethod
    def expected_files():
        plots = {f"{name}{suffix}" for name in PLOTS for suffix in (".svg", ".png")}
        return TABLES | (plots if HAS_PLOTS else set())

    def table(self, name):
        return list(csv.DictReader(self.measured()[0][name].decode().splitlines()))

    def check_numbers(self, rows, text=(), optional=()):
        """All columns are finite numbers, except `text` ones and empty cells of `optional` ones."""
        for row in rows:
            for column, value in row.items():
                if column not in text and not (column in optional and value == ""):
                    self.assertTrue(math.isfinite(float(value)), (column, row))

    def test_quality_against_time(self):
        rows = self.table("quality_time.csv")
        self.check_numbers(rows, optional=("ms_ssim",))
        self.assertEqual([int(row["effort"]) for row in rows], [0, 1, 5])
        self.assertEqual([row["default"] for row in rows], ["0", "0", "1"])
        for row in rows:
            self.assertLessEqual(int(row["bytes"]), 400)
            self.assertAlmostEqual(float(row["bpp"]), 8 * int(row["bytes"]) / (WIDTH * HEIGHT), places=4)
            self.assertTrue(float(row["encode_s"]) > 0 and float(row["decode_s"]) > 0)

    def test_trace_ends_at_the_file(self):
        trace = self.table("trace.csv")
        self.check_numbers(trace, text=("stage",))
        for point in self.table("quality_time.csv"):
            curve = [row for row in trace if row["effort"] == point["effort"]]
            seconds = [float(row["seconds"]) for row in curve]
            self.assertGreater(len(curve), 10)
            self.assertEqual(seconds, sorted(seconds))
            self.assertLessEqual(seconds[-1], float(point["encode_s"]) + 1e-3)
            self.assertAlmostEqual(float(curve[-1]["psnr_db"]), float(point["psnr_db"]), delta=0.3)

    def test_quality_grows_with_rate(self):
        rows = self.table("quality_rate.csv")
        self.check_numbers(rows, optional=("ms_ssim",))
        rates, quality = [float(row["bpp"]) for row in rows], [float(row["psnr_db"]) for row in rows]
        self.assertEqual(len(rows), 3)
        self.assertEqual(rates, sorted(rates))
        self.assertEqual(quality, sorted(quality))

    def test_accuracy(self):
        rows = self.table("accuracy.csv")
        self.check_numbers(rows, ("choice", "variant", "blend"), ("ns_per_pixel", "bits_per_splat", "psnr_same_size_db"))
        for choice in ("support", "exponential", "precision"):
            self.assertEqual({row["blend"] for row in rows if row["choice"] == choice}, BLENDS)
            self.assertEqual(sum(row["choice"] == choice and row["default"] == "1" for row in rows), 3)
        self.assertEqual({row["blend"] for row in rows if row["choice"] == "early stop"}, {"alpha"})
        self.assertEqual({row["blend"] for row in rows if row["choice"] == "quantiser"}, BLENDS - {"alpha"})
        for row in rows:
            self.assertLessEqual(float(row["mean_error_255"]), float(row["largest_error_255"]))
            if row["choice"] == "precision":
                self.assertLess(float(row["largest_error_255"]), 1e-9 if row["variant"] == "float64" else 0.02)

    def test_quantiser_steps_are_encoded_with(self):
        for row in self.table("accuracy.csv"):
            self.assertEqual(row["choice"] == "quantiser" and row["variant"] != "none", row["psnr_same_size_db"] != "")
        by_effort = {row["effort"]: row["psnr_db"] for row in self.table("quality_time.csv")}
        default = [row["psnr_same_size_db"] for row in self.table("accuracy.csv")
                 if (row["choice"], row["blend"], row["default"]) == ("quantiser", "normalized", "1")]
        self.assertEqual([f"{float(value):.3f}" for value in default], [f"{float(by_effort['1']):.3f}"])

    def test_gradients(self):
        rows = self.table("gradients.csv")
        self.check_numbers(rows, ("parameter", "exponential", "blend"))
        self.assertEqual({row["parameter"] for row in rows}, {"position", "scale", "angle", "opacity", "colour"})
        self.assertEqual({row["blend"] for row in rows}, BLENDS)
        for row in rows:
            self.assertLess(float(row["rms_error"]), 1e-3)

    def test_json_matches_the_tables(self):
        report = read_json(self.measured()[0]["tradeoff.json"])
        self.assertEqual((report["width"], report["height"], report["bytes"], report["effort"]), (WIDTH, HEIGHT, 400, 5))
        for key, table in (("quality_time", "quality_time.csv"), ("quality_rate", "quality_rate.csv"),
                           ("accuracy", "accuracy.csv"), ("gradients", "gradients.csv")):
            self.assertEqual(len(report[key]), len(self.table(table)))
        for encode, row in zip(report["quality_time"], self.table("quality_time.csv")):
            self.assertAlmostEqual(encode["psnr"], float(row["psnr_db"]), places=5)
            self.assertTrue(encode["stages"] and encode["trace"])

    def test_text_lists_every_row(self):
        printed = self.measured()[1]
        for row in self.table("accuracy.csv"):
            mark = r"\*" if row["default"] == "1" else " "
            self.assertRegex(printed, rf"(?m)^{mark} {row['choice']} +{row['variant']} +{row['blend']} ")
        for title in ("encode time, at most 400 bytes", "rate, effort 5", "Arithmetic accuracy", "Gradient accuracy"):
            self.assertIn(title, printed)

    @unittest.skipUnless(HAS_PLOTS, "built without cairo")
    def test_plots(self):
        for name in PLOTS:
            image = read_png(self.measured()[0][name + ".png"])
            self.assertTrue(image.width > 1000 and image.height > 500)
            blue = [pixel for pixel in zip(*[iter(image.samples)] * image.channels) if pixel[:3] == SERIES_BLUE]
            self.assertGreater(len(blue), 1000, name)
            drawing = xml.etree.ElementTree.fromstring(self.measured()[0][name + ".svg"])
            self.assertTrue(drawing.tag.endswith("svg"))
            self.assertGreater(sum(1 for _ in drawing.iter()), 100)

    def test_same_files_again_and_json_on_standard_output(self):
        self.write_png("in.png", scene(40, 30))
        self.path("there").mkdir()
        self.write("there/tradeoff.json", b"old")
        report = self.gscl_json("tradeoff", "in.png", "--quick", "--out", "there", "--mapping", "cpu")
        self.assertEqual(report["quality_time"][0]["ms_ssim"], None)
        self.assertEqual(report, read_json(self.path("there/tradeoff.json").read_bytes()))

    def test_without_the_module(self):
        """A copy of the program without its module writes tables, no plots, and prints one line with the reason."""
        self.write_png("in.png", scene(40, 30))
        self.path("gscl").write_bytes(pathlib.Path(GSCL).read_bytes())
        self.path("gscl").chmod(0o755)
        os.symlink(pathlib.Path(GSCL).with_name("libgscl.so.1"), self.path("libgscl.so.1"))
        done = self.start("tradeoff", "in.png", "--quick", "--out", "out", program="./gscl",
                          env={"LD_LIBRARY_PATH": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        self.assertRegex(done.stderr.decode(), r"\Agscl: tradeoff: tables only; plots need .*libcairo2-dev[^\n]*\n\Z")
        self.assertEqual({path.name for path in self.path("out").iterdir()}, TABLES)


class Refusals(ToolTest):
    def setUp(self):
        super().setUp()
        self.write_png("in.png", scene(40, 30))

    def test_refuses_files_that_are_no_images(self):
        self.write("text.png", b"no image")
        self.refused("text.png", ".", "tradeoff", "text.png")
        self.refused("nothing.png", "No such file", "tradeoff", "nothing.png")

    def test_flat_image(self):
        self.write_png("flat.png", flat(40, 30, (9, 9, 9)))
        self.refused("flat.png", "no splats", "tradeoff", "flat.png", "--quick")

    def test_folders(self):
        self.write("file", b"")
        self.refused("file/tradeoff.json", "Not a directory", "tradeoff", "in.png", "--out", "file")
        self.refused("no/such", "cannot be made: No such file", "tradeoff", "in.png", "--out", "no/such")

    def test_full_disk(self):
        """If one file cannot be written, no file is put in place."""
        self.path("out").mkdir()
        self.write("out/quality_time.csv", b"old")
        self.path("out/accuracy.csv").symlink_to("/dev/full")
        self.refused("out/accuracy.csv", "cannot be written: No space left", "tradeoff", "in.png", "--quick", "--out", "out")
        self.assertEqual(self.path("out/quality_time.csv").read_bytes(), b"old")

    def test_options(self):
        for message, words in (("exclude each other", ("--bytes", "400", "--bpp", "0.1")),
                            ("whole number from 0 to 9", ("--effort", "10"))):
            self.refused("tradeoff", message, "tradeoff", "in.png", *words, code=2)
        self.refused("tradeoff", "an input is missing", "tradeoff", code=2)
        self.refused("in.png", "too small", "tradeoff", "in.png", "--bytes", "9")
        self.refused("nowhere", "nowhere", "tradeoff", "in.png", "--device", "nowhere")

    def test_needs_opencl(self):
        self.write_png("in.png", flat(64, 64, (9, 9, 9)))
        self.refused("tradeoff", "--device host does not apply: .* needs an OpenCL device", "tradeoff", "in.png", "--device",
                     "host", code=2)
        self.refused("OpenCL", "no OpenCL device was found; .*; install .* pocl-opencl-icd$", "tradeoff", "in.png",
                     env=NO_OPENCL)
        self.write("file", b"")
        self.refused("OpenCL", "PoCL cannot write to file/x, .* POCL_CACHE_DIR", "tradeoff", "in.png",
                     env={"POCL_CACHE_DIR": "file/x"})


if __name__ == "__main__":
    main()
