"""Alpha in formats that hold none: it is left out where all pixels are opaque, and otherwise needs a background."""
from images import Image, pnm_bytes, png_bytes, png_icc, read_png, read_pnm, scene
from profiles import DISPLAY_P3, icc_grey, icc_rgb, srgb_of
from tool import FAST, ToolTest, main

WITHOUT_ALPHA = ("jpg", "jpeg", "ppm", "pnm", "bmp")
WITH_ALPHA = ("png", "tif", "tga")
ORANGE = (255, 165, 0)


def opaque(image):
    """The image with alpha 1 everywhere."""
    samples = []
    for at in range(0, len(image.samples), image.channels):
        samples += [*image.samples[at:at + image.channels], image.peak]
    return Image(image.width, image.height, image.channels + 1, image.depth, samples)


def without_alpha(image):
    colours = image.channels - 1
    samples = [sample for at, sample in enumerate(image.samples) if at % image.channels != colours]
    return Image(image.width, image.height, colours, image.depth, samples)


def over(image, colour):
    """The image over a colour of three samples of 8 bits, rounded to the nearest sample."""
    grey = image.channels == 2 and len(set(colour)) == 1
    samples = []
    for at in range(0, len(image.samples), image.channels):
        *front, alpha = image.samples[at:at + image.channels]
        back = [c * image.peak // 255 for c in colour]
        pairs = zip(front, back) if grey or len(front) == 3 else zip(front * 3, back)
        samples += [(2 * (f * alpha + b * (image.peak - alpha)) + image.peak) // (2 * image.peak) for f, b in pairs]
    return Image(image.width, image.height, 1 if grey else 3, image.depth, samples)


class AlphaTest(ToolTest):
    def closeness(self, name, other):
        """PSNR of two image files, which must have the same channels, dB; 999 where they are equal."""
        return self.gscl_json("compare", name, other)["psnr"] or 999


class Opaque(AlphaTest):
    def test_alpha_is_left_out(self):
        for image in (scene(24, 18), scene(24, 18, 1), scene(24, 18, 3, 16), scene(24, 18, 1, 16)):
            self.encode(opaque(image))
            depth = ("--depth", "8") if image.depth == 16 else ()
            expected = without_alpha(self.decode())
            for suffix in WITHOUT_ALPHA if image.channels == 3 else ("jpg", "pgm", "pnm", "bmp"):
                with self.subTest(kind=image.kind(), suffix=suffix):
                    self.gscl("decode", "in.gscl", "-o", f"out.{suffix}", *(() if suffix[0] == "p" else depth))
                    if suffix[0] == "p":
                        self.assertEqual(read_pnm(self.path(f"out.{suffix}").read_bytes()), expected)
                    elif not depth:
                        self.write_png("expected.png", expected)
                        self.assertGreater(self.closeness("expected.png", f"out.{suffix}"), 25 if suffix[0] == "j" else 200)

    def test_formats_with_alpha_keep_it(self):
        self.encode(opaque(scene(24, 18)))
        self.assertEqual(self.decode().channels, 4)

    def test_crop_without_transparency(self):
        """The pixels that are written count, not those around them."""
        samples = []
        for at in range(24 * 18):
            samples += [200, 100, 50, 255 if at % 24 < 12 else 0]
        self.encode(Image(24, 18, 4, 8, samples), "--bpp", "8")
        self.assertEqual(self.decode("--crop", "0,0,2,18").samples[3::4], [255] * 36)
        self.gscl("decode", "in.gscl", "-o", "out.ppm", "--crop", "0,0,2,18")
        self.refused("out.ppm", "--background", "decode", "in.gscl", "-o", "out.ppm")

    def test_draw(self):
        self.encode(opaque(scene(24, 18)))
        self.gscl("draw", "in.gscl", "-o", "out.png")
        self.gscl("draw", "in.gscl", "-o", "out.ppm")
        self.assertEqual(read_pnm(self.path("out.ppm").read_bytes()), without_alpha(read_png(self.path("out.png").read_bytes())))


class Background(AlphaTest):
    def test_is_named_where_it_is_needed(self):
        self.encode(scene(24, 18, 4))
        for command in ("decode", "draw"):
            for suffix in WITHOUT_ALPHA:
                with self.subTest(command=command, suffix=suffix):
                    self.refused(f"out.{suffix}", rf": \.{suffix} cannot hold an alpha channel; add --background COLOUR, or choose \.png",
                                 command, "in.gscl", "-o", f"out.{suffix}")

    def test_every_kind_of_samples(self):
        for channels in (2, 4):
            for depth in (8, 16):
                self.encode(scene(24, 18, channels, depth))
                decoded = self.decode()
                for colour in ((255, 255, 255), (0, 0, 0), (119, 119, 119), ORANGE):
                    with self.subTest(channels=channels, depth=depth, colour=colour):
                        shown = self.decode("--background", "#%02x%02x%02x" % colour)
                        self.assertEqual(shown, over(decoded, colour))

    def test_every_format(self):
        self.encode(scene(24, 18, 4))
        self.assertEqual(self.decode("--background", "orange").channels, 3)
        for suffix in (*WITHOUT_ALPHA, *WITH_ALPHA, "exr"):
            with self.subTest(suffix=suffix):
                self.gscl("decode", "in.gscl", "-o", f"out.{suffix}", "--background", "orange")
                self.assertGreater(self.closeness("in.png", f"out.{suffix}"), {"jpg": 25, "jpeg": 25, "exr": 50}.get(suffix, 200))

    def test_grey_over_a_colour_becomes_rgb(self):
        self.encode(scene(24, 18, 2))
        self.gscl("decode", "in.gscl", "-o", "out.pgm", "--background", "#777")
        self.assertEqual(read_pnm(self.path("out.pgm").read_bytes()), over(self.decode(), (119, 119, 119)))
        self.gscl("decode", "in.gscl", "-o", "out.ppm", "--background", "orange")
        self.assertEqual(read_pnm(self.path("out.ppm").read_bytes()), over(self.decode(), ORANGE))
        self.refused("out.pgm", ".pgm cannot hold a colour image", "decode", "in.gscl", "-o", "out.pgm", "--background", "orange")
        self.refused("out.ppm", ".ppm cannot hold a grey image", "decode", "in.gscl", "-o", "out.ppm", "--background", "white")

    def test_picture_without_alpha_stays(self):
        for channels in (1, 3):
            self.encode(scene(24, 18, channels))
            self.assertEqual(self.decode("--background", "orange"), self.decode())

    def test_crop_and_scale(self):
        self.encode(scene(24, 18, 4))
        area = ("--size", "60x50", "--crop", "40,30,20,15")
        self.assertEqual(self.decode(*area, "--background", "orange"), over(self.decode(*area), ORANGE))

    def test_draw(self):
        """Lines lie over the background."""
        self.encode(Image(24, 18, 4, 8, [0, 0, 0, 0] * (24 * 18)))
        self.gscl("draw", "in.gscl", "-o", "out.png", "--background", "orange")
        self.assertEqual(read_png(self.path("out.png").read_bytes()), Image(24, 18, 3, 8, list(ORANGE) * (24 * 18)))
        self.encode(scene(64, 48, 4), "--splats", 12)
        self.gscl("draw", "in.gscl", "-o", "out.ppm", "--background", "orange")
        drawn, plain = read_pnm(self.path("out.ppm").read_bytes()), self.decode("--background", "orange")
        self.assertEqual(drawn.kind(), plain.kind())
        same = sum(drawn.samples[at:at + 3] == plain.samples[at:at + 3] for at in range(0, len(plain.samples), 3))
        self.assertIn(same, range(64 * 48 // 4, 64 * 48))


class Colours(ToolTest):
    def setUp(self):
        super().setUp()
        self.encode(Image(2, 2, 4, 8, [0] * 16))

    def test_forms(self):
        for text, colour in (("#fa0", (255, 170, 0)), ("#FfA501", (255, 165, 1)), ("fa0", (255, 170, 0)), ("0a0B0c", (10, 11, 12)),
                             ("white", (255,) * 3), ("Black", (0,) * 3), ("GREY", (128,) * 3), ("rebeccapurple", (102, 51, 153)),
                             ("lightgoldenrodyellow", (250, 250, 210)), ("aliceblue", (240, 248, 255)),
                             ("yellowgreen", (154, 205, 50)), ("red", (255, 0, 0)), ("tan", (210, 180, 140))):
            with self.subTest(text=text):
                self.assertEqual(tuple(self.decode("--background", text).samples[:3]), colour)

    def test_others_are_refused(self):
        for text in ("", "#", "#12", "#1234", "#12345", "#1234567", "#ff000080", "#ggg", "0xffffff", "transparent", "none", "whit",
                     "whitee", "rgb(1,2,3)", " white", "white "):
            with self.subTest(text=text):
                self.refused("decode", f"--background cannot be '{text}'; it takes #rgb, #rrggbb, or a colour name of CSS".replace("(", ".").replace(")", "."),
                             "decode", "in.gscl", "-o", "out.png", "--background", text, code=2)


class Profiles(ToolTest):
    """The colour of a background is one of sRGB, whatever the colours of the file are."""

    def shown(self, data, source, colour):
        """The picture over a colour, and the same made of its straight colours by the formulas of sRGB."""
        self.encode(data, "--keep-profile", "--bpp", "8")
        self.gscl("decode", "in.gscl", "-o", "own.png")
        done = self.start("decode", "in.gscl", "-o", "out.png", "--background", "#%02x%02x%02x" % colour)
        self.assertEqual((done.returncode, done.stderr.decode()),
                         (0, f"out.png: colours converted from {source} to sRGB, because --background is a colour of sRGB\n"))
        self.assertNotIn(b"iCCP", self.path("out.png").read_bytes())
        return read_png(self.path("own.png").read_bytes()), read_png(self.path("out.png").read_bytes())

    def test_colours_become_srgb(self):
        image = scene(24, 18, 4)
        own, shown = self.shown(png_bytes(image, [png_icc(icc_rgb(DISPLAY_P3, name="Test P3"))]), "Display P3", ORANGE)
        samples = []
        for at in range(0, len(own.samples), 4):
            *colours, alpha = own.samples[at:at + 4]
            samples += [round(255 * v) for v in srgb_of([c / 255 for c in colours], DISPLAY_P3)] + [alpha]
        expected = over(Image(24, 18, 4, 8, samples), ORANGE)
        self.assertLessEqual(max(abs(a - b) for a, b in zip(shown.samples, expected.samples)), 1)
        clear = [at for at in range(24 * 18) if own.samples[4 * at + 3] == 0]
        self.assertTrue(clear and all(tuple(shown.samples[3 * at:3 * at + 3]) == ORANGE for at in clear))

    def test_grey_profile(self):
        """A profile of grey does not stay with RGB."""
        own, shown = self.shown(png_bytes(scene(24, 18, 2), [png_icc(icc_grey(1.8))]), "Test Grey", ORANGE)
        self.assertEqual((own.channels, shown.channels), (2, 3))

    def test_profiles_stay_where_alpha_is_left_out(self):
        image = opaque(scene(24, 18))
        self.encode(png_bytes(image, [png_icc(icc_rgb(DISPLAY_P3, name="Test P3"))]), "--keep-profile")
        done = self.start("decode", "in.gscl", "-o", "out.jpg")
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertIn(b"ICC_PROFILE", self.path("out.jpg").read_bytes())

    def test_hdr_is_refused(self):
        self.encode(png_bytes(scene(24, 18, 4), [(b"cICP", bytes((9, 16, 0, 1)))]), "--keep-profile")
        self.refused("out.png", r"HDR colours \(BT.2020 PQ\), which cannot be drawn over a --background of sRGB; leave it out",
                     "decode", "in.gscl", "-o", "out.png", "--background", "white")


if __name__ == "__main__":
    main()
