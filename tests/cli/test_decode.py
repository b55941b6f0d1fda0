"""gscl decode: sizes, crops and mappings; gscl draw."""
import re
import unittest

from gscl_file import contained, header
from images import Image, max_difference, psnr, read_png, scene
from tool import FAST, NO_OPENCL, OPENCL, ToolTest, main, odd_opencl

HIGH_RATE = ("--bpp", "3")


class Areas(ToolTest):
    def setUp(self):
        super().setUp()
        self.image = scene(61, 43)
        self.encode(self.image, *HIGH_RATE)
        self.whole = self.decode()

    def same(self, expected, decoded):
        """Equal up to a rounding difference: pixels may fall into tiles differently."""
        self.assertLessEqual(max_difference(expected, decoded), 1)

    def test_crop_is_a_part_of_the_whole(self):
        for area in ((0, 0, 61, 43), (0, 0, 1, 1), (60, 42, 1, 1), (17, 5, 30, 31), (16, 16, 16, 16), (3, 40, 58, 3)):
            with self.subTest(area=area):
                self.same(self.whole.crop(*area), self.decode("--crop", ",".join(map(str, area))))

    def test_scale_and_size_agree(self):
        for scale, size in (("2", (122, 86)), ("0.5", (31, 22)), ("1.5", (92, 65)), ("0.001", (1, 1))):
            with self.subTest(scale=scale):
                scaled = self.decode("--scale", scale)
                self.assertEqual((scaled.width, scaled.height), size)
                self.assertEqual(scaled, self.decode("--size", f"{size[0]}x{size[1]}"))

    def test_crop_is_in_pixels_of_the_scaled_image(self):
        twice = self.decode("--scale", "2")
        self.same(twice.crop(50, 20, 41, 33), self.decode("--scale", "2", "--crop", "50,20,41,33"))

    def test_enlarged_image_matches_the_image(self):
        large = self.decode("--scale", "3")
        middles = [large.row(3 * y + 1)[3 * (3 * x + 1) + c] for y in range(43) for x in range(61) for c in range(3)]
        self.assertGreater(psnr(self.whole, Image(61, 43, 3, 8, middles)), 30)

    def test_one_side_keeps_the_aspect(self):
        for size, expected in (("122", (122, 86)), ("x86", (122, 86)), ("31", (31, 22)), ("x1", (1, 1))):
            with self.subTest(size=size):
                self.assertEqual(self.decode("--size", size).kind()[:2], expected)
        for size in ("0", "x0", "x", "61x", "x16385"):
            self.refused("decode", f"--size cannot be '{size}'; it takes WIDTHxHEIGHT, WIDTH or xHEIGHT", "decode",
                         "in.gscl", "-o", "out.ppm", "--size", size, code=2)

    def test_the_last_operand_is_the_output(self):
        self.gscl("decode", "in.gscl", "out.ppm")
        self.gscl("decode", "in.gscl", "-o", "named.ppm")
        self.assertEqual(self.path("out.ppm").read_bytes(), self.path("named.ppm").read_bytes())
        self.refused("decode", "out.ppm exists; name it with -o to replace it", "decode", "in.gscl", "out.ppm", code=2)
        self.refused("decode", "out.webp: no image format has the suffix '.webp'; choose one of .png", "decode", "in.gscl",
                     "out.webp", code=2)

    def test_other_aspect(self):
        self.assertEqual(self.decode("--size", "10x200").kind(), (10, 200, 3, 8))


class Limits(ToolTest):
    """gscl info reports the figures that the limits of gscl decode are compared with."""

    def test_limits_are_those_of_info(self):
        self.encode(scene(61, 43), *HIGH_RATE)
        info = self.gscl_json("info", "in.gscl")
        self.assertEqual(info["pixels"], 61 * 43)
        self.assertIn(f"{info['work']} evaluations of a splat at a pixel", self.gscl("info", "in.gscl").decode())
        for option, figure in (("--max-pixels", info["pixels"]), ("--max-work", info["work"])):
            with self.subTest(option):
                self.decode(option, figure)
                for command in (("decode", "in.gscl", "-o", "out.png"), ("draw", "in.gscl", "-o", "out.png")):
                    self.refused("in.gscl", rf"{figure}\b.*{figure - 1}; {option} raises this limit", *command, option,
                                 figure - 1)
                self.refused("in.gscl", rf"{figure}\b.*more than {option} {figure - 1} allows", "info", "in.gscl",
                             "--reference", "in.image", option, figure - 1)

    def test_limits_are_those_of_the_crop(self):
        self.encode(scene(61, 43), *HIGH_RATE)
        self.decode("--crop", "3,4,10,10", "--max-pixels", "100")


    def test_default_limits(self):
        """A file of few bytes that asks for 800 MB of pixels."""
        self.write("in.gscl", contained(header(16384, 16384, 0).finish()))
        message = "268435456 pixels .* 100000000; --max-pixels raises"
        self.refused("in.gscl", message, "decode", "in.gscl", "-o", "out.ppm")
        self.refused("in.gscl", message, "draw", "in.gscl", "-o", "out.ppm")
        self.encode(scene(61, 43))
        self.refused("in.gscl", "--max-pixels raises", "decode", "in.gscl", "-o", "out.ppm", "--size", "10001x10000")
        self.decode("--size", "10001x10000", "--crop", "10000,9999,1,1")


class Partial(ToolTest):
    def cut(self, share):
        whole = self.path("in.gscl").read_bytes()
        self.path("in.gscl").write_bytes(whole[:int(len(whole) * share)])

    def test_prefix_is_drawn_on_request_only(self):
        image = scene(61, 43)
        self.encode(image, *HIGH_RATE)
        whole = psnr(image, self.decode())
        self.cut(0.5)
        self.refused("in.gscl", "the file is incomplete", "decode", "in.gscl", "-o", "out.png")
        half = psnr(image, self.decode("--partial"))
        self.assertGreater(half, 10)
        self.assertLess(half, whole)

    def test_whole_file_is_the_same(self):
        self.encode(scene(61, 43), *HIGH_RATE)
        self.assertEqual(self.decode(), self.decode("--partial"))

    def half_of(self, image, *arguments):
        """PSNR of the first half of a file of 400 bytes."""
        self.encode(image, "--bytes", 400, *arguments)
        self.cut(0.5)
        return psnr(image, self.decode("--partial"))

    def test_layers_make_parts_of_a_file_better(self):
        """In the mean of several seeds, from which single files differ by 2 dB."""
        image, seeds = scene(160, 120), (1, 2, 3, 4, 5, 6)
        layered = sum(self.half_of(image, "--progressive", "--seed", seed) for seed in seeds) / len(seeds)
        plain = sum(self.half_of(image, "--seed", seed) for seed in seeds) / len(seeds)
        self.assertGreater(layered, plain + 3)
        self.encode(image, "--bytes", 200)
        self.assertGreater(layered, psnr(image, self.decode()) - 3)

    def test_layers_are_reported(self):
        self.encode(scene(61, 43), "--bytes", 700, "--progressive")
        self.assertEqual(self.gscl_json("info", "in.gscl")["layers"], 4)
        self.assertIn("progressive: 4 layers", self.gscl("info", "in.gscl").decode())
        self.encode(scene(61, 43), "--bytes", 700)
        self.assertEqual(self.gscl_json("info", "in.gscl")["layers"], 1)

    def test_layers_of_all_kinds(self):
        for arguments in (("--splats", 60), ("--psnr", 24), ("--bytes", 90), ("--bytes", 600, "--blend", "alpha"),
                          ("--bytes", 600, "--blend", "sum", "--effects", "+opacity"), ("--bytes", 600, "--bare")):
            with self.subTest(arguments):
                image = scene(61, 43)
                data = self.encode(image, "--progressive", *arguments)
                if "--bytes" in arguments:
                    self.assertLessEqual(len(data), arguments[1])
                bare = arguments[2:] if "--bare" in arguments else ()
                self.assertGreater(psnr(image, self.decode(*bare)), 15)

    def test_prefix_of_a_header_is_refused(self):
        self.encode(scene(61, 43), *HIGH_RATE)
        self.cut(0.01)
        self.refused("in.gscl", "the file is incomplete", "decode", "--partial", "in.gscl", "-o", "out.png")


class Mappings(ToolTest):
    def test_cpu_and_gpu_draw_the_same(self):
        for channels, profile, blend in ((3, "default", "normalized"), (4, "default", "alpha"), (1, "default", "sum"),
                                         (2, "default", "normalized"), (3, "paper", "alpha")):
            with self.subTest(channels=channels, profile=profile, blend=blend):
                self.encode(scene(50, 38, channels), *HIGH_RATE, "--profile", profile, "--blend", blend)
                self.assertLessEqual(max_difference(self.decode(*OPENCL, "--mapping", "cpu"), self.decode("--mapping", "gpu")), 1)

    def test_encoding_with_the_gpu_mapping(self):
        image = scene(50, 38)
        self.encode(image, *HIGH_RATE, "--mapping", "gpu")
        self.assertGreater(psnr(image, self.decode()), 24)

    def test_device_by_number_and_by_name(self):
        image = scene(20, 20)
        device = self.gscl_json("devices")[0]
        self.assertNotEqual(device["id"], "host")  # which has no other name
        self.encode(image, "--device", device["id"])
        whole = self.decode("--device", device["id"])
        self.assertEqual(whole, self.decode("--device", device["device"]))


class Host(ToolTest):
    """The device that needs no OpenCL."""

    def decodes_on(self, *arguments, env=None):
        """The device that a decode names with --verbose."""
        done = self.start("decode", "in.gscl", "-o", "out.ppm", "--verbose", *arguments, env=env)
        self.assertEqual(done.returncode, 0, done.stderr)
        return re.search(r"device (\S+):", done.stderr.decode()).group(1)

    def test_host_draws_the_same(self):
        for channels, profile, blend in ((3, "default", "normalized"), (4, "default", "alpha"), (1, "default", "sum"),
                                         (2, "default", "normalized"), (3, "paper", "alpha")):
            with self.subTest(channels=channels, profile=profile, blend=blend):
                self.encode(scene(50, 38, channels), *HIGH_RATE, "--profile", profile, "--blend", blend)
                # From 65537 pixels on it draws by its kernels.
                for area in ((), ("--scale", "2.5"), ("--size", "20x30"), ("--crop", "7,9,30,21"), ("--depth", "16"),
                             ("--size", "400x200")):
                    host, gpu = self.decode(*area, "--device", "host"), self.decode(*area, "--mapping", "gpu")
                    self.assertLessEqual(max_difference(host, gpu), host.peak // 255)

    def test_threads_change_nothing(self):
        image = scene(200, 150)
        files = {threads: self.encode(image, *HIGH_RATE, "--threads", threads) for threads in ("1", "2", "7")}
        files["default"] = self.encode(image, *HIGH_RATE)
        self.assertEqual(len(set(files.values())), 1)
        pictures = [self.decode("--size", "500x400", "--threads", threads) for threads in ("1", "2", "7")]
        for picture in pictures:
            self.assertEqual(picture, pictures[0])

    def test_empty_environment(self):
        """Neither OpenCL nor a home, whose folder would keep kernels."""
        self.write_png("in.png", scene(40, 30))
        self.gscl("encode", "in.png", "-o", "with.gscl", *FAST)
        for variables in ((), ("HOME=/nonexistent", "OCL_ICD_VENDORS=/nonexistent"), ("HOME=relative",)):
            with self.subTest(variables):
                done = self.start("encode", "in.png", "-o", "in.gscl", "--quiet", *FAST, prefix=("env", "-i", *variables))
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, b"", b""))
                self.assertEqual(self.path("in.gscl").read_bytes(), self.path("with.gscl").read_bytes())
                self.gscl("decode", "in.gscl", "-o", "out.png", prefix=("env", "-i", *variables))

    def test_limits_and_partial_files(self):
        data = self.encode(scene(61, 43), *HIGH_RATE)
        work = self.gscl_json("info", "in.gscl")["work"]
        host = ("decode", "in.gscl", "-o", "out.png", "--device", "host")
        self.refused("in.gscl", "max_work", *host, "--max-work", work - 1)
        self.refused("in.gscl", "max_pixels", *host, "--max-pixels", 61 * 43 - 1)
        self.path("in.gscl").write_bytes(data[:len(data) // 2])
        self.refused("in.gscl", "the file is incomplete", *host)
        self.assertEqual(self.decode("--partial", "--device", "host").kind(), (61, 43, 3, 8))

    def test_rule(self):
        """Without a GPU all pictures, with one small ones."""
        self.encode(scene(61, 43))
        gpu = odd_opencl("gpu")
        for arguments, env, expected in (((), None, "host"), (("--mapping", "cpu"), None, "host"),
                                         (("--mapping", "gpu"), None, "0.0"), (("--size", "1000x3001"), None, "host"),
                                         (("--size", "4000x4001"), NO_OPENCL, "host"),
                                         ((), gpu, "host"), (("--mapping", "cpu"), gpu, "0.0"),
                                         (("--size", "1000x3000"), gpu, "host"), (("--size", "1000x3001"), gpu, "0.0"),
                                         (("--size", "1000x3001", "--device", "host"), gpu, "host"),
                                         (("--size", "4000x4000", "--crop", "0,0,9,9"), gpu, "host")):
            with self.subTest(arguments=arguments, env=env):
                self.assertEqual(self.decodes_on(*arguments, env=env), expected)


class Draw(ToolTest):
    def draw(self, *arguments):
        self.gscl("draw", "in.gscl", "-o", "drawn.png", *arguments)
        return read_png(self.path("drawn.png").read_bytes())

    def test_outlines_over_the_image(self):
        self.encode(scene(64, 48), "--splats", "12")
        decoded, drawn = self.decode(), self.draw()
        self.assertEqual(drawn.kind(), decoded.kind())
        changed = sum(decoded.samples[at:at + 3] != drawn.samples[at:at + 3] for at in range(0, len(drawn.samples), 3))
        self.assertGreater(changed, 60)
        self.assertLess(changed, 64 * 48 / 2)

    def test_flat_image_has_no_outlines(self):
        self.encode(Image(20, 20, 3, 8, [9, 99, 199] * 400))
        self.assertEqual(self.draw(), self.decode())

    def test_scale(self):
        self.encode(scene(20, 10))
        self.assertEqual(self.draw("--scale", "4").kind(), (80, 40, 3, 8))

    def test_grey_becomes_colour_and_alpha_stays(self):
        self.encode(scene(20, 10, 1))
        self.assertEqual(self.draw().channels, 3)
        self.encode(scene(20, 10, 2))
        self.assertEqual(self.draw().channels, 4)


if __name__ == "__main__":
    main()
