"""gscl info, compare, devices, help and --version: output as text and as JSON."""
import os
import re
import unittest

from images import flat, psnr, scene
from tool import NO_OPENCL, ToolTest, main

COMMANDS = ("encode", "decode", "info", "compare", "draw", "devices", "bench", "tradeoff")


class Info(ToolTest):
    def test_streams_add_up_to_the_file(self):
        for arguments in ((), ("--profile", "paper"), ("--blend", "alpha"), ("--blend", "sum")):
            with self.subTest(arguments=arguments):
                data = self.encode(scene(48, 40, 4), "--bytes", "500", *arguments)
                info = self.gscl_json("info", "in.gscl")
                self.assertEqual(info["bytes"], len(data))
                self.assertAlmostEqual(sum(stream["bits"] for stream in info["streams"]), 8 * len(data), delta=0.01)
                for stream in info["streams"]:
                    self.assertAlmostEqual(stream["bytes"], stream["bits"] / 8)
                    self.assertAlmostEqual(stream["bits_per_splat"], stream["bits"] / info["splats"], places=6)

    def test_facts(self):
        for channels, depth in ((1, 8), (2, 16), (3, 16), (4, 8)):
            with self.subTest(channels=channels, depth=depth):
                data = self.encode(scene(30, 20, channels, depth), "--bytes", "300")
                info = self.gscl_json("info", "in.gscl")
                self.assertEqual((info["width"], info["height"], info["channels"], info["depth"]),
                                 (30, 20, channels, depth))
                self.assertEqual((info["profile"], info["blend"], info["format_version"]), ("default", "normalized", 2))
                self.assertEqual("chroma" in info["effects"], channels >= 3)
                self.assertEqual("alpha-channel" in info["effects"], channels % 2 == 0)
                self.assertAlmostEqual(info["bpp"], 8 * len(data) / 600)

    def test_text_has_the_same_figures(self):
        self.encode(scene(30, 20), "--bytes", "300")
        info = self.gscl_json("info", "in.gscl")
        text = self.gscl("info", "in.gscl").decode()
        self.assertIn("in.gscl: 30 x 20 RGB, 8 bits, format version 2\n", text)
        self.assertIn(f"{info['splats']} splats, {info['bytes']} bytes", text)
        self.assertIn("effects: " + ", ".join(info["effects"]) + "\n", text)
        for stream in info["streams"]:
            self.assertRegex(text, rf"(?m)^{stream['name']} +{stream['bytes']:.1f} ")

    def test_flat_image(self):
        self.encode(flat(20, 20, (5,)))
        info = self.gscl_json("info", "in.gscl")
        self.assertEqual(info["splats"], 0)
        self.assertIn("effects: none", self.gscl("info", "in.gscl").decode())


class Compare(ToolTest):
    def test_psnr_matches_python(self):
        for channels in (1, 2, 3, 4):
            with self.subTest(channels=channels):
                a, b = scene(40, 30, channels), scene(40, 30, channels)
                b.samples = [min(sample + at % 7, 255) for at, sample in enumerate(b.samples)]
                self.write_png("a.png", a)
                self.write_png("b.png", b)
                report = self.gscl_json("compare", "a.png", "b.png")
                self.assertAlmostEqual(report["psnr"], psnr(a, b), places=4)
                self.assertAlmostEqual(report["mse"], 255 ** 2 / 10 ** (psnr(a, b) / 10), places=3)

    def test_same_image(self):
        self.write_png("a.png", scene(176, 180, 1))
        report = self.gscl_json("compare", "a.png", "a.png")
        self.assertEqual((report["psnr"], report["mse"], report["max_difference"]), (None, 0, 0))
        self.assertAlmostEqual(report["ssim"], 1)
        self.assertAlmostEqual(report["ms_ssim"], 1)
        self.assertEqual(report["ssimulacra2"], 100)
        self.assertIn("inf dB", self.gscl("compare", "a.png", "a.png").decode())

    def test_too_small_for_ssim(self):
        self.write_png("a.png", scene(10, 30))
        report = self.gscl_json("compare", "a.png", "a.png")
        self.assertEqual((report["ssim"], report["ms_ssim"]), (None, None))
        self.assertRegex(self.gscl("compare", "a.png", "a.png").decode(), r"(?m)^SSIM +too small$")

    def test_ssimulacra2(self):
        a, b, small = scene(40, 30), scene(40, 30), scene(7, 30)
        b.samples = [min(sample + at % 7, 255) for at, sample in enumerate(b.samples)]
        for name, image in (("a.png", a), ("b.png", b), ("small.png", small)):
            self.write_png(name, image)
        score = self.gscl_json("compare", "a.png", "b.png")["ssimulacra2"]
        self.assertTrue(0 < score < 95, score)
        self.assertRegex(self.gscl("compare", "a.png", "b.png").decode(), rf"(?m)^SSIMULACRA 2 +{score:.2f}$")
        self.assertIsNone(self.gscl_json("compare", "small.png", "small.png")["ssimulacra2"])
        self.assertRegex(self.gscl("compare", "small.png", "small.png").decode(), r"(?m)^SSIMULACRA 2 +too small$")

    def test_depths_may_differ(self):
        self.write_png("a.png", flat(12, 12, (10, 20, 30)))
        self.write_png("b.png", flat(12, 12, (2570, 5140, 7710), 16))
        self.assertLess(self.gscl_json("compare", "a.png", "b.png")["max_difference"], 0.001)

    def test_different_kinds(self):
        self.write_png("a.png", scene(12, 12))
        self.write_png("b.png", scene(12, 13))
        self.write_png("c.png", scene(12, 12, 4))
        self.refused("b.png", "is 12 x 13 pixels but a.png is 12 x 12; .*same size", "compare", "a.png", "b.png")
        self.refused("c.png", "is RGBA but a.png is RGB; .*same channels", "compare", "a.png", "c.png")


class Devices(ToolTest):
    def test_exactly_one_default(self):
        devices = self.gscl_json("devices")
        defaults = [device for device in devices if device["is_default"]]
        self.assertEqual(len(defaults), 1)
        self.assertTrue(defaults[0]["why_default"])
        self.assertGreater(defaults[0]["memory_bytes"], 0)

    def test_host_is_last_and_the_default_beside_a_cpu(self):
        for env in None, NO_OPENCL:
            devices = self.gscl_json("devices", env=env)
            self.assertEqual([device["id"] for device in devices].count("host"), 1)
            host = devices[-1]
            self.assertEqual((host["id"], host["is_default"], host["is_gpu"]), ("host", True, False))
            self.assertEqual(host["why_default"], "kernels are compiled already; there is no GPU or accelerator")
            self.assertTrue(1 <= host["compute_units"] <= len(os.sched_getaffinity(0)))
            for device in devices[:-1]:
                self.assertRegex(device["id"], r"^\d+\.\d+$")
            lines = self.gscl("devices", env=env).decode().splitlines()
            self.assertEqual([line.split()[1] for line in lines if line.startswith("* ")], ["host"])
            self.assertEqual([line for line in lines if re.match(r"[* ] host ", line)], [f"* host  {host['device']}"])
            self.assertRegex(lines[-2], rf"\A +{host['compute_units']} threads?, [\d.]+ GiB memory\Z")

    def test_text_marks_the_default(self):
        default = next(device for device in self.gscl_json("devices") if device["is_default"])
        text = self.gscl("devices").decode()
        self.assertRegex(text, rf"(?m)^\* {re.escape(default['id'])} +{re.escape(default['device'])}$")
        self.assertIn(f"the default: {default['why_default']}", text)


class Help(ToolTest):
    def test_version(self):
        self.assertRegex(self.gscl("--version").decode(), r"\Agscl \d+\.\d+\.\d+\n\Z")

    def test_overview_names_every_command(self):
        for arguments in (("help",), ("--help",), ("-h",)):
            text = self.gscl(*arguments).decode()
            for command in COMMANDS:
                self.assertRegex(text, rf"(?m)^  {command} ")

    def test_every_command_has_help(self):
        for command in COMMANDS:
            with self.subTest(command=command):
                text = self.gscl(command, "-h").decode()
                self.assertTrue(text.startswith(f"usage: gscl {command} "))
                self.assertEqual(text, self.gscl("help", command).decode())
                usage = text.splitlines()[0]
                for option in re.findall(r"--[a-z][a-z0-9-]*", usage):
                    self.assertRegex(text, rf"(?m)^ .*{option} ")

    def test_help_on_an_unknown_command(self):
        self.refused("encoed", "is not a command; 'gscl help' lists all", "help", "encoed", code=2)

    def test_help_lists_ranges_and_defaults(self):
        text = self.gscl("encode", "-h").decode()
        for option, message in (("effort", r"default 5.*\[0 to 9\]"), ("bpp", r"default 0.125"), ("seed", "default 1"),
                             ("codebook", r"\[2 to 1024\]"), ("blend", r"\[auto, normalized, alpha, sum\]")):
            self.assertRegex(text, rf"(?m)^ +--{option} .*{message}")

    def test_no_command(self):
        done = self.start()
        self.assertEqual((done.returncode, done.stdout), (2, b""))
        self.assertIn(b"usage: gscl COMMAND", done.stderr)


if __name__ == "__main__":
    main()
