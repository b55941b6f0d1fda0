"""gscl encode: targets, determinism, output names, batches, pipes and reports."""
import os
import pty
import re
import select
import subprocess
import time
import unittest

from images import (Image, checkerboard, document, dots_in_the_dark, faint_and_strong, flat, glow, hills, noise, png_bytes, psnr,
                      sawtooth, scene, textured, waves)
from tool import FAST, GSCL, OPENCL, TIMEOUT, ToolTest, main


class Kernels(ToolTest):
    def test_own_declarations_of_builtins_suffice(self):
        """No program falls back to the header of the compiler where cl/builtins.h replaces it."""
        self.write_png("rgb.png", textured(48, 40))
        self.write_png("rgba.png", scene(48, 40, 4))
        for name, arguments in (("rgb", ()), ("rgba", ("--blend", "alpha")), ("rgb", ("--tune", "ssim")),
                                ("rgb", ("--tune", "visual")),
                                ("rgb", ("--profile", "paper", "--loss", "l1+ssim")), ("rgb", ("--mapping", "gpu"))):
            with self.subTest(name, arguments=arguments):
                done = self.start("encode", f"{name}.png", "-o", "x.gscl", "-v", *FAST, "--bytes", "400", *OPENCL, *arguments)
                log = done.stderr.decode()
                self.assertEqual(done.returncode, 0, log)
                self.assertRegex(log, "(built|loaded) a program")  # loaded: from the cache of other tests
                self.assertNotIn("is not enough", log)


class Targets(ToolTest):
    def test_bytes_are_used_but_never_exceeded(self):
        """The paper profile leaves more at the fastest effort, which has few passes to come close."""
        image = png_bytes(textured(96, 64))
        for budget in (200, 701, 1500):
            for profile, share in (("default", 0.97), ("paper", 0.95)):
                with self.subTest(budget=budget, profile=profile):
                    size = len(self.encode(image, "--bytes", budget, "--profile", profile))
                    self.assertLessEqual(size, budget)
                    self.assertGreaterEqual(size, share * budget)

    def test_noise_never_exceeds_its_bytes(self):
        self.assertLessEqual(len(self.encode(noise(96, 64), "--bytes", "700")), 700)

    def test_presets_stand_for_options(self):
        self.write_png("in.png", textured(64, 48))
        options = {"tiny": ("--bytes", "250", "--effort", "3"), "preview": ("--bytes", "256", "--effort", "3"), "small": (), "good": ("-q", "50")}
        for name, same in options.items():
            for effort in ((), FAST):
                with self.subTest(name, effort=effort):
                    self.assertEqual(self.gscl("encode", "in.png", "-o", "-", "--quiet", "--preset", name, *effort),
                                     self.gscl("encode", "in.png", "-o", "-", "--quiet", *same, *effort))
        self.refused("encode", "--preset, --bytes, .* exclude each other; give one of them",
                     "encode", "in.png", "--preset", "small", "--bytes", "300", code=2)
        self.refused("encode", "--preset cannot be 'large'; it takes one of tiny, preview, small, good",
                     "encode", "in.png", "--preset", "large", code=2)

    def test_bpp_limits_the_bytes(self):
        data = self.encode(textured(80, 60), "--bpp", "1.0")
        self.assertLessEqual(len(data), 600)
        self.assertGreaterEqual(len(data), 582)

    def test_psnr_is_met_within_a_third_of_a_decibel(self):
        image = textured(128, 96)  # one splat changes its PSNR by less than the tolerance
        for target in (21.5, 22.5):
            with self.subTest(target=target):
                self.encode(image, "--psnr", target)
                reached = psnr(image, self.decode())
                self.assertGreaterEqual(reached, target - 0.005)
                self.assertLessEqual(reached, target + 0.3)

    def test_ssimulacra2_is_met(self):
        """By how much it is exceeded, tests of the search check: in pictures of this size one splat changes it by points."""
        for image, target in ((textured(128, 96), "30"), (scene(96, 64, 4), "91.5"), (scene(96, 64, 1), "-10.5")):
            with self.subTest(target=target):
                self.write_png("in.png", image)
                report = self.gscl_json("encode", "in.png", "--ssimulacra2", target, *FAST)
                self.assertGreaterEqual(report["ssimulacra2"], float(target))
                self.assertLessEqual(report["trials"], 10)
                self.gscl("decode", "in.gscl", "-o", "out.png")
                compared = self.gscl_json("compare", "in.png", "out.png")
                self.assertAlmostEqual(compared["ssimulacra2"], report["ssimulacra2"], delta=0.01)
                self.assertAlmostEqual(compared["psnr"], report["psnr"], delta=0.01)

    def messages(self, *arguments):
        """What an encode writes to standard error."""
        done = self.start("encode", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr.decode()

    def test_a_higher_ssimulacra2_takes_more_bytes(self):
        image = png_bytes(textured(128, 96))
        sizes = [len(self.encode(image, "--ssimulacra2", target, *FAST)) for target in ("10", "25", "45")]
        self.assertEqual(sizes, sorted(sizes))
        self.assertLess(1.5 * sizes[0], sizes[2])

    def test_quality_is_a_score(self):
        self.write_png("in.png", textured(96, 64))
        coded = []
        for quality, score in (("0", -50), ("21", 6), ("45", 45)):
            report = self.gscl_json("encode", "in.png", "-q", quality, *FAST)
            self.assertGreaterEqual(report["ssimulacra2"], score)
            self.assertLess(report["ssimulacra2"], score + (8 if score > 0 else 25))  # blurs of few splats differ by more
            coded.append(report["bytes"])
        self.assertEqual(coded, sorted(coded))
        self.assertEqual(self.encode(textured(96, 64), "--quality", "45", *FAST),
                         self.encode(textured(96, 64), "--ssimulacra2", "45", *FAST))

    def test_quality_out_of_reach_gives_the_best_file(self):
        self.write_png("in.png", textured(16, 16))
        best = self.gscl_json("encode", "in.png", "-q", "100", *FAST)["ssimulacra2"]
        self.assertIn(f"the best found is {best:.2f}",
                      self.start("encode", "in.png", "--ssimulacra2", "100", *FAST).stderr.decode())

    def test_quality_out_of_reach_is_told(self):
        self.write_png("in.png", textured(16, 16))
        self.assertIn("in.gscl: quality 100 is not reached: this is the best file that was found",
                      self.messages("in.png", "-q", "100", *FAST))
        self.assertNotIn("is not reached", self.messages("in.png", "-q", "10", *FAST))

    def test_probes_precede_complete_encodes(self):
        self.write_png("in.png", textured(96, 64))
        for effort, has_probes in (("2", False), ("3", True)):
            for target in (("--psnr", "22"), ("--ssimulacra2", "20")):
                with self.subTest(effort=effort, target=target):
                    log = self.messages("in.png", *target, "--effort", effort, "-v")
                    self.assertEqual("probe 1:" in log, has_probes)
                    self.assertIn("trial 1:", log)

    def test_score_is_printed(self):
        self.write_png("in.png", scene(48, 32))
        self.assertRegex(self.messages("in.png", "--ssimulacra2", "10", *FAST), r"dB, SSIMULACRA 2 \d+\.\d\d, ")
        self.assertNotIn("SSIMULACRA", self.messages("in.png", "--psnr", "20", *FAST))
        self.assertIsNone(self.gscl_json("encode", "in.png", "--psnr", "20", *FAST)["ssimulacra2"])

    def test_splats(self):
        self.encode(textured(64, 64), "--splats", "40")
        self.assertIn(self.gscl_json("info", "in.gscl")["splats"], range(36, 41))

    def test_more_bytes_than_the_image_can_use(self):
        self.assertLess(len(self.encode(scene(16, 16), "--bytes", "20000")), 20000)

    def test_default_target_suffices_for_an_icon(self):
        image = scene(32, 32)
        self.assertLessEqual(len(self.encode(image)), 256)
        self.assertGreater(psnr(image, self.decode()), 22)

    def test_effort_improves_quality(self):
        image = scene(96, 64)
        reached = []
        for effort in ("0", "5"):
            self.encode(image, "--bytes", "500", "--effort", effort)
            reached.append(psnr(image, self.decode()))
        self.assertGreater(reached[1], reached[0])


class SmallFiles(ToolTest):
    def test_budget_is_used(self):
        """But for eight bytes, which may be of no use to any splat: the picture is hardly more than its texture."""
        image = png_bytes(textured(96, 64))
        for budget in (60, 100, 150, 260, 400):
            with self.subTest(budget=budget):
                size = len(self.encode(image, "--bytes", budget, "--effort", "5"))
                self.assertLessEqual(size, budget)
                self.assertGreaterEqual(size, budget - 8)

    def test_more_effort_is_never_worse(self):
        """An effort with a search also makes all searches of lower ones.  Decoded samples are rounded: 0.02 dB."""
        for name, image in (("scene", scene(96, 64)), ("textured", textured(96, 64))):
            for budget in (60, 100, 200):
                reached = 0
                for effort, tolerance in ((1, 0), (3, 0.1), (4, 0.02), (5, 0.02), (7, 0.02)):
                    with self.subTest(image=name, budget=budget, effort=effort):
                        self.encode(image, "--bytes", budget, "--effort", effort)
                        quality = psnr(image, self.decode())
                        self.assertGreaterEqual(quality, reached - tolerance)
                        reached = max(reached, quality)

    def test_same_settings_same_bytes(self):
        image = png_bytes(scene(96, 64))
        arguments = ("--bytes", "150", "--effort", "4")
        self.assertEqual(self.encode(image, *arguments), self.encode(image, *arguments))

    def test_one_splat(self):
        """The smallest files that have splats at all."""
        for budget in range(18, 26):
            with self.subTest(budget=budget):
                self.assertLessEqual(len(self.encode(scene(64, 64), "--bytes", budget, "--effort", "3")), budget)


class Kinds(ToolTest):
    def test_quality_grows_with_the_file(self):
        """PSNR of images other than photographs, at three sizes; beyond 36 dB it depends on how few values are rounded."""
        two_pixels = Image(2, 1, 3, 8, [255, 0, 0, 0, 0, 255])
        for name, image, budgets in (
                ("noise", noise(96, 64), (150, 500, 1500)), ("checkerboard", checkerboard(96, 64, 4), (150, 500, 1500)),
                ("sawtooth", sawtooth(96, 64), (150, 500, 1500)), ("document", document(128, 64), (150, 500, 1500)),
                ("column", noise(1, 300), (60, 200, 600)), ("two pixels", two_pixels, (20, 24, 40))):
            reached = 0
            for budget in budgets:
                with self.subTest(image=name, budget=budget):
                    size = len(self.encode(png_bytes(image), "--bytes", budget, "--effort", "2", "--tune", "psnr"))
                    self.assertLessEqual(size, budget)
                    quality = psnr(image, self.decode())
                    self.assertGreaterEqual(quality, min(reached, 36) - 0.05)
                    reached = quality

    def test_one_colour_takes_a_few_bytes(self):
        self.assertLessEqual(len(self.encode(flat(640, 480, (12, 200, 99)))), 24)

    def test_icon_from_48_bytes(self):
        image = scene(64, 64)
        self.assertLessEqual(len(self.encode(image, "--bytes", "48", "--effort", "5")), 48)
        self.assertGreater(psnr(image, self.decode()), 15)


class Settings(ToolTest):
    def test_same_settings_same_bytes(self):
        image = png_bytes(scene(64, 48))
        for profile in ("default", "paper"):
            with self.subTest(profile=profile):
                arguments = ("--bytes", "400", "--profile", profile, "--seed", "7")
                self.assertEqual(self.encode(image, *arguments), self.encode(image, *arguments))

    def test_seed_matters(self):
        image = png_bytes(scene(64, 48))
        self.assertNotEqual(self.encode(image, "--seed", "1"), self.encode(image, "--seed", "18446744073709551615"))

    def test_info_reports_blend_and_profile(self):
        image = scene(48, 48)
        for profile, blend in (("default", "normalized"), ("default", "alpha"), ("default", "sum"), ("paper", "alpha")):
            with self.subTest(profile=profile, blend=blend):
                self.encode(image, "--bytes", "600", "--profile", profile, "--blend", blend)
                info = self.gscl_json("info", "in.gscl")
                self.assertEqual((info["profile"], info["blend"]), (profile, blend))
                self.assertGreater(psnr(image, self.decode()), 18)

    def test_codebook_size_is_kept(self):
        self.encode(scene(64, 64), "--bytes", "900", "--profile", "paper", "--codebook", "16")
        info = self.gscl_json("info", "in.gscl")
        self.assertLessEqual(max(info["shape_words"], info["colour_words"]), 16)
        self.assertGreater(info["colour_words"], 1)

    def test_losses(self):
        image = scene(48, 48)
        for loss in ("l1", "l1+ssim", "l2"):
            with self.subTest(loss=loss):
                self.encode(image, "--bytes", "500", "--loss", loss)
                self.assertGreater(psnr(image, self.decode()), 20)

    def test_between_splats_is_the_background(self):
        """A file of few bright splats stores its background where their mean would be seen."""
        image = dots_in_the_dark(128, 128)
        for seed in (1, 2, 3):
            with self.subTest(seed=seed):
                self.encode(image, "--bytes", "250", "--effort", "3", "--tune", "psnr", "--seed", seed)
                self.assertGreater(psnr(image, self.decode()), 28)

    def test_smooth_images_are_fitted_again_when_splats_were_dropped(self):
        """Where each splat is needed, those that are left close the gaps: 1 dB in the mean of these files."""
        image, reached = hills(256, 192), []
        for seed in (1, 2, 3, 4):
            self.assertLessEqual(len(self.encode(image, "--bytes", "400", "--effort", "2", "--tune", "psnr", "--seed", seed)), 400)
            reached.append(psnr(image, self.decode()))
        self.assertGreater(sum(reached) / 4, 26.6)

    def test_more_bytes_of_a_smooth_image_are_used(self):
        """A search does not end far below the budget, where one pass at a higher price drops half of the splats."""
        image, reached = glow(192, 128), []
        for budget in (120, 200):
            size = len(self.encode(image, "--bytes", budget, "--effort", "3"))
            self.assertGreater(size, 0.9 * budget)
            reached.append(psnr(image, self.decode()))
        self.assertGreater(reached[1], reached[0] - 0.5)

    def figures_of_tunes(self, image, tune, *arguments):
        """What `gscl compare` measures of the image with --tune psnr, and with this tune."""
        figures = []
        for name in ("psnr", tune):
            self.encode(image, "--tune", name, *arguments)
            self.decode()
            figures.append(self.gscl_json("compare", "in.image", "in.png"))
        return figures

    def test_tuning_for_ssim(self):
        """--tune ssim has a higher MS-SSIM and a lower PSNR at the same size."""
        plain, tuned = self.figures_of_tunes(faint_and_strong(192, 192), "ssim", "--bytes", "700", "--effort", "2")
        self.assertGreater(tuned["ms_ssim"], plain["ms_ssim"] + 0.02)
        self.assertLess(tuned["psnr"], plain["psnr"])

    def test_tuning_for_ssim_does_not_lower_it_in_small_files(self):
        plain, tuned = self.figures_of_tunes(textured(240, 240), "ssim", "--bytes", "50", "--effort", "3")
        self.assertGreaterEqual(tuned["ms_ssim"], plain["ms_ssim"])

    def test_visual_tuning(self):
        """--tune visual has a higher SSIMULACRA 2 and a lower PSNR at the same size, also in grey."""
        for image, blend in ((textured(256, 192), "normalized"), (textured(256, 192, 1), "sum")):
            with self.subTest(blend=blend):
                plain, tuned = self.figures_of_tunes(image, "visual", "--bytes", "900", "--effort", "3", "--blend", blend)
                self.assertGreater(tuned["ssimulacra2"], plain["ssimulacra2"] + 2)
                self.assertLess(tuned["psnr"], plain["psnr"])

    def test_visual_tuning_of_smooth_images(self):
        """Where next to nothing is seen of the error, --tune visual is squared error alone."""
        plain, tuned = self.figures_of_tunes(waves(192, 128), "visual", "--bytes", "900", "--effort", "3")
        self.assertGreater(tuned["psnr"], plain["psnr"] - 0.5)

    def tune_of(self, image, *arguments):
        """The tune that an encode reports."""
        self.write_png("in.png", image)
        return self.gscl_json("encode", "in.png", "-o", "x.gscl", *FAST, *arguments)["tune"]

    def test_default_tune(self):
        """What people see, of opaque images; PSNR in small files, where that is the target, and without the visual loss."""
        rgb, rgba = scene(48, 40), scene(48, 40, 4)
        opaque = Image(48, 40, 4, 8, [255 if i % 4 == 3 else sample for i, sample in enumerate(rgba.samples)])
        size = ("--bytes", "700")
        for image, arguments, tune in ((rgb, size, "visual"), (scene(48, 40, 1), size, "visual"), (opaque, size, "visual"),
                                       (rgb, ("--splats", "9"), "visual"), (rgb, ("--bytes", "500"), "psnr"),
                                       (rgba, size, "psnr"), (rgb, ("--psnr", "25"), "psnr"),
                                       (rgb, ("--ssimulacra2", "0"), "visual"), (rgba, ("--ssimulacra2", "0"), "psnr"),
                                       (rgb, (*size, "--loss", "l1"), "psnr"), (rgb, (*size, "--profile", "paper"), "psnr"),
                                       (rgb, (*size, "--tune", "psnr"), "psnr"), (rgb, (*size, "--tune", "ssim"), "ssim"),
                                       (rgba, (*size, "--tune", "visual"), "visual")):
            with self.subTest(arguments=arguments, channels=image.channels):
                self.assertEqual(self.tune_of(image, *arguments), tune)

    def test_default_tune_of_large_images(self):
        """Above 4096 x 4096 pixels the visual loss would take more than 1 GiB."""
        self.encode(flat(64, 64, (200, 40, 90)))
        for scale, tune in (("64", "visual"), ("64.1", "psnr")):
            with self.subTest(scale=scale):
                self.gscl("decode", "in.gscl", "-o", "large.png", "--scale", scale)
                self.assertEqual(self.gscl_json("encode", "large.png", "-o", "large.gscl")["tune"], tune)

    def test_visual_tuning_of_hard_images(self):
        """Images with alpha, and images that are too small for the visual loss, are encoded as well."""
        for image in (scene(64, 48, 4), scene(9, 7), flat(40, 30, (200, 40, 90)), textured(40, 30, 2)):
            with self.subTest(size=(image.width, image.height), channels=image.channels):
                self.encode(image, "--bytes", "300", "--effort", "2", "--tune", "visual")
                self.assertGreater(psnr(image, self.decode()), 18)

    def test_tuning_needs_the_default_profile_and_l2(self):
        self.write_png("in.png", scene(16, 16))
        for tune in ("ssim", "visual"):
            for setting in (("--profile", "paper"), ("--loss", "l1")):
                with self.subTest(tune=tune, setting=setting):
                    self.refused("in.png", "needs the default profile and the loss L2", "encode", "in.png", "--tune",
                                 tune, *setting, code=2)


class Names(ToolTest):
    def test_default_output_replaces_the_suffix(self):
        os.mkdir(self.path("some.dir"))
        for name, expected in (("a.png", "a.gscl"), ("some.dir/b", "some.dir/b.gscl"), ("c.tar.png", "c.tar.gscl"),
                             (".hidden", ".hidden.gscl")):
            with self.subTest(name=name):
                self.write_png(name, scene(16, 16))
                self.gscl("encode", name, "--quiet", *FAST)
                self.assertTrue(self.path(expected).is_file())

    def test_the_second_operand_is_the_output(self):
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", "out.gscl", *FAST)
        self.gscl("encode", "in.png", "-o", "named.gscl", *FAST)
        self.assertEqual(self.path("out.gscl").read_bytes(), self.path("named.gscl").read_bytes())
        self.refused("encode", "out.gscl exists; name it with -o to replace it", "encode", "in.png", "out.gscl", *FAST,
                     code=2)

    def test_a_mistyped_output_is_no_input(self):
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", *FAST)
        for name in ("out.gslc", "out.avif", "out"):
            self.refused("encode", f"{name} does not exist; an output ends with .gscl, or is named with -o", "encode", "in.png",
                         name, *FAST, code=2)
        done = self.start("encode", "in.png", "missing.png", *FAST)
        self.assertEqual(done.returncode, 3)
        self.assertIn(b"missing.png: cannot be opened", done.stderr)

    def test_existing_output_is_replaced_with_its_permissions(self):
        self.write("out.gscl", b"old")
        self.path("out.gscl").chmod(0o640)
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", "-o", "out.gscl", *FAST)
        self.assertEqual(self.path("out.gscl").read_bytes()[:4], b"\xc7gsc")
        self.assertEqual(self.path("out.gscl").stat().st_mode & 0o777, 0o640)

    def test_new_output_has_ordinary_permissions(self):
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", *FAST, umask=0o027)
        self.assertEqual(self.path("in.gscl").stat().st_mode & 0o777, 0o640)

    def test_link_stays_a_link(self):
        os.mkdir(self.path("elsewhere"))
        self.write("elsewhere/out.gscl", b"old")
        self.path("out.gscl").symlink_to("elsewhere/out.gscl")
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", "-o", "out.gscl", *FAST)
        self.assertTrue(self.path("out.gscl").is_symlink())
        self.assertEqual(self.path("elsewhere/out.gscl").read_bytes()[:4], b"\xc7gsc")

    def test_link_to_no_file_makes_the_file(self):
        """Links are followed from where they stand, one after the other."""
        os.mkdir(self.path("a"))
        os.mkdir(self.path("b"))
        self.path("out.gscl").symlink_to("a/second.gscl")
        self.path("a/second.gscl").symlink_to("../b/made.gscl")
        self.path("lost.gscl").symlink_to("missing/made.gscl")
        self.path("circle.gscl").symlink_to("circle.gscl")
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", "-o", "out.gscl", *FAST)
        self.assertTrue(self.path("out.gscl").is_symlink() and self.path("a/second.gscl").is_symlink())
        self.assertFalse(self.path("b/made.gscl").is_symlink())
        self.assertEqual(self.path("b/made.gscl").read_bytes()[:4], b"\xc7gsc")
        self.refused("lost.gscl", "cannot be written: No such file", "encode", "in.png", "-o", "lost.gscl", *FAST)
        self.refused("circle.gscl", "cannot be written: Too many", "encode", "in.png", "-o", "circle.gscl", *FAST)

    def test_leaves_no_other_files(self):
        self.write_png("in.png", scene(16, 16))
        self.gscl("encode", "in.png", *FAST)
        self.assertEqual(self.files(), ["in.gscl", "in.png"])


class Batch(ToolTest):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("out"))
        for name in ("a", "b", "c"):
            self.write_png(f"{name}.png", scene(24, 16, 3 if name == "a" else 1))

    def test_all_into_one_folder(self):
        self.gscl("encode", "a.png", "b.png", "c.png", "--out-dir", "out", *FAST)
        self.assertEqual([name for name in self.files() if name.startswith("out/")],
                         ["out/a.gscl", "out/b.gscl", "out/c.gscl"])

    def test_batch_and_single_encode_give_the_same_file(self):
        self.gscl("encode", "a.png", "b.png", "c.png", "--out-dir", "out", *FAST)
        self.gscl("encode", "c.png", *FAST)
        self.assertEqual(self.path("out/c.gscl").read_bytes(), self.path("c.gscl").read_bytes())

    def test_continues_after_a_bad_input(self):
        self.write("b.png", b"no image")
        done = self.start("encode", "a.png", "b.png", "missing.png", "c.png", "--out-dir", "out", "--quiet", *FAST)
        self.assertEqual(done.returncode, 3)
        errors = done.stderr.decode().splitlines()
        self.assertEqual(len(errors), 2)
        self.assertRegex(errors[0], "^gscl: b.png: is not an image")
        self.assertRegex(errors[1], "^gscl: missing.png: cannot be opened: No such file")
        self.assertEqual([name for name in self.files() if name.startswith("out/")], ["out/a.gscl", "out/c.gscl"])

    def test_the_last_line_counts_the_files(self):
        self.write("b.png", b"no image")
        lines = self.start("encode", "a.png", "b.png", "c.png", "--out-dir", "out", *FAST).stderr.decode().splitlines()
        self.assertEqual(lines[-1], "2 encoded, 1 failed")

    def test_two_inputs_with_the_same_output(self):
        os.mkdir(self.path("more"))
        self.write_png("more/a.jpg", scene(8, 8))
        self.refused("encode", "a.png and more/a.jpg would both be written to out/a.gscl", "encode", "a.png",
                     "more/a.jpg", "--out-dir", "out", code=2)

    def test_json_is_an_array(self):
        reports = self.gscl_json("encode", "a.png", "b.png", "--out-dir", "out", *FAST)
        self.assertEqual([report["input"] for report in reports], ["a.png", "b.png"])
        self.assertEqual([report["channels"] for report in reports], [3, 1])


class Reports(ToolTest):
    def test_json(self):
        image = scene(40, 30)
        self.write_png("in.png", image)
        report = self.gscl_json("encode", "in.png", "--bytes", "300", *FAST)
        size = self.path("in.gscl").stat().st_size
        self.assertEqual(report["output"], "in.gscl")
        self.assertEqual((report["width"], report["height"], report["channels"]), (40, 30, 3))
        self.assertEqual(report["bytes"], size)
        self.assertAlmostEqual(report["bpp"], 8 * size / 1200)
        self.assertEqual(report["splats"], self.gscl_json("info", "in.gscl")["splats"])
        self.assertAlmostEqual(report["psnr"], psnr(image, self.decode()), delta=0.01)
        self.assertGreater(report["seconds"], 0)
        self.assertIn("entropy coding", [stage["name"] for stage in report["stages"]])
        self.assertLessEqual(sum(stage["seconds"] for stage in report["stages"]), report["seconds"])
        self.assertNotIn("trace", report)

    def test_trace(self):
        self.write_png("in.png", scene(64, 48))
        report = self.gscl_json("encode", "in.png", "--bytes", "300", "--trace", *FAST)
        seconds = [point["seconds"] for point in report["trace"]]
        self.assertGreater(len(seconds), 10)
        self.assertEqual(seconds, sorted(seconds))
        self.assertLessEqual(seconds[-1], report["seconds"])
        self.assertAlmostEqual(report["trace"][-1]["psnr"], report["psnr"], delta=0.3)

    def test_names_that_json_must_escape(self):
        name = "é quote\" back\\slash\nline.png"
        self.write_png(name, scene(8, 8))
        self.assertEqual(self.gscl_json("encode", name, *FAST)["input"], name)
        broken = os.fsdecode(b"bad\xff\xc3.png")
        self.write_png(broken, scene(8, 8))
        self.assertEqual(self.gscl_json("encode", broken, *FAST)["input"], "bad\ufffd\ufffd.png")

    def test_notes_go_to_standard_error_only(self):
        self.write_png("in.png", scene(16, 16))
        done = self.start("encode", "in.png", *FAST)
        self.assertEqual(done.stdout, b"")
        self.assertRegex(done.stderr.decode(), r"\Ain.gscl: \d+ bytes, [\d.]+ bpp, \d+ splats, [\d.]+ dB, [\d.]+ s\n\Z")
        done = self.start("encode", "in.png", "--quiet", *FAST)
        self.assertEqual((done.stdout, done.stderr), (b"", b""))

    def test_compiling_kernels_prints_nothing(self):
        self.write_png("in.png", scene(16, 16))
        self.path("cache").mkdir()
        for profile in "default", "paper":
            done = self.start("encode", "in.png", "--quiet", "--profile", profile, *FAST, *OPENCL,
                              env={"POCL_CACHE_DIR": str(self.path("cache"))})
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, b"", b""))

    def test_verbose_prints_more(self):
        self.write_png("in.png", scene(16, 16))
        self.assertGreater(len(self.start("encode", "in.png", "-v", *FAST).stderr.splitlines()), 1)

    def run_on_terminal(self, *arguments, code=0):
        """Runs gscl on a terminal and returns its output."""
        terminal, program_end = pty.openpty()
        process = subprocess.Popen([GSCL, *arguments], cwd=self.folder, stdout=program_end, stderr=program_end)
        os.close(program_end)
        text, deadline = b"", time.monotonic() + TIMEOUT
        while time.monotonic() < deadline and select.select([terminal], [], [], TIMEOUT)[0]:
            try:
                text += os.read(terminal, 4096)
            except OSError:  # the other end is closed
                break
        os.close(terminal)
        self.assertEqual(process.wait(timeout=TIMEOUT), code)
        return text.decode()

    def test_no_bytes_for_a_terminal(self):
        self.write_png("in.png", scene(16, 16))
        text = self.run_on_terminal("encode", "in.png", "-o", "-", code=1)
        self.assertEqual(text, "\r\x1b[Kgscl: standard output: is a terminal; redirect it to a file or a pipe, or name a file with -o\r\n")

    def test_progress_line_on_a_terminal(self):
        self.write_png("in.png", scene(160, 120))
        text = self.run_on_terminal("encode", "in.png", "--effort", "3")
        self.assertRegex(text, r"\rin|\r\x1b\[Kin.png +\d+ %  .*\d+ splats  [\d.]+ s left")
        self.assertRegex(text, r"[\d.]+ dB")
        last = re.split(r"\r\x1b\[K", text)[-1]
        self.assertTrue(last.startswith("in.gscl: "), last)
        self.assertEqual(self.run_on_terminal("encode", "in.png", "--quiet", *FAST), "")


class Pipes(ToolTest):
    def test_through_pipes(self):
        image = scene(40, 30)
        data = self.gscl("encode", "-", "-o", "-", *FAST, input=png_bytes(image))
        self.assertEqual(data, self.encode(image))
        decoded = self.gscl("decode", "-", "-o", "-", input=data)
        self.decode()
        self.assertEqual(decoded, self.path("in.png").read_bytes())
        self.assertEqual(self.gscl_json("info", "-", input=data)["file"], "standard input")

    def test_other_formats_through_pipes(self):
        self.encode(scene(40, 30))
        self.decode()
        for suffix in ("jpg", "tif", "exr"):
            with self.subTest(suffix=suffix):
                self.gscl("decode", "in.gscl", "-o", f"out.{suffix}")
                stored = self.path(f"out.{suffix}").read_bytes()
                difference = self.gscl_json("compare", "-", f"out.{suffix}", input=stored)["mse"]
                self.assertEqual(difference, 0)

    def test_named_pipe(self):
        os.mkfifo(self.path("pipe"))
        self.write_png("in.png", scene(16, 16))
        with subprocess.Popen(["cp", "in.png", "pipe"], cwd=self.folder):
            self.gscl("encode", "pipe", "-o", "out.gscl", *FAST)
        self.assertTrue(self.path("out.gscl").is_file())


if __name__ == "__main__":
    main()
