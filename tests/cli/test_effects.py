"""Effects: automatic decisions, options, and the bits and gains of each effect."""
import unittest
from math import exp
from random import Random

from images import Image, flat, scene
from tool import FAST, ToolTest, main


def dots(width, height):
    """Discs of several colours, evenly spaced on a light background."""
    colours = ((200, 40, 30), (30, 60, 190), (20, 130, 60))
    samples = []
    for y in range(height):
        for x in range(width):
            inside = (x % 16 - 7.5) ** 2 + (y % 16 - 7.5) ** 2 < 14
            samples += colours[(x // 16 + y // 16) % 3] if inside else (240, 236, 220)
    return Image(width, height, 3, 8, samples)


def lights(width, height, count=160, seed=7):
    """Small round lights of many brightnesses at random places on black."""
    random = Random(seed)
    planes = [0.0] * (3 * width * height)
    for _ in range(count):
        x, y, sigma = random.uniform(0, width), random.uniform(0, height), random.uniform(0.8, 2.2)
        colour = [random.uniform(80, 255) for _ in range(3)]
        for row in range(max(int(y) - 7, 0), min(int(y) + 8, height)):
            for column in range(max(int(x) - 7, 0), min(int(x) + 8, width)):
                weight = exp(-((column + 0.5 - x) ** 2 + (row + 0.5 - y) ** 2) / (2 * sigma ** 2))
                for k in range(3):
                    planes[3 * (row * width + column) + k] += colour[k] * weight
    return Image(width, height, 3, 8, [min(round(value), 255) for value in planes])


def grey_of(image):
    """The same size and channels, R = G = B."""
    samples = list(image.samples)
    for at in range(0, len(samples), image.channels):
        samples[at + 1] = samples[at + 2] = samples[at]
    return Image(image.width, image.height, image.channels, image.depth, samples)


class Automatic(ToolTest):
    def effects(self, image, *arguments):
        self.encode(image, *arguments)
        return set(self.gscl_json("info", "in.gscl")["effects"])

    def test_content(self):
        opaque, opaque_grey = scene(64, 48, 4), scene(64, 48, 2)
        opaque.samples[3::4] = opaque_grey.samples[1::2] = [255] * (64 * 48)
        for name, image, chroma, alpha in (("colour", scene(64, 48), True, False), ("grey", scene(64, 48, 1), False, False),
                                             ("colour without colours", grey_of(scene(64, 48)), False, False),
                                             ("transparent", scene(64, 48, 4), True, True), ("opaque", opaque, True, False),
                                             ("opaque grey", opaque_grey, False, False)):
            with self.subTest(name):
                effects = self.effects(image, "--bytes", "300")
                self.assertEqual("chroma" in effects, chroma)
                self.assertEqual("alpha-channel" in effects, alpha)
                self.assertIn("rotation", effects)
                streams = {stream["name"] for stream in self.gscl_json("info", "in.gscl")["streams"]}
                self.assertEqual("chroma" in streams, chroma)
                self.assertEqual("alpha" in streams, alpha)
                self.assertNotIn("opacity", streams)

    def test_flat_image_has_none_but_its_colour(self):
        self.assertEqual(self.effects(flat(64, 48, (9, 9, 9))), set())
        self.assertEqual(self.effects(flat(64, 48, (9, 10, 9))), {"chroma"})

    def test_circles_for_lights(self):
        self.write_png("lights.png", lights(256, 192))
        report = self.gscl_json("encode", "lights.png", "-o", "lights.gscl", "--bytes", "1400", "--effort", "1")
        decisions = {decision["name"]: decision for decision in report["effects"]}
        for name in ("rotation", "anisotropy"):
            self.assertEqual((decisions[name]["on"], decisions[name]["reason"]), (False, "trial"))
            self.assertLess(decisions[name]["gain_db"], 0)
        self.assertEqual((decisions["opacity"]["on"], decisions["opacity"]["reason"]), (True, "content"))  # flat background
        streams = {stream["name"] for stream in self.gscl_json("info", "lights.gscl")["streams"]}
        self.assertNotIn("angle", streams)
        # The effect search is one stage; the stages after it are reported as without it.
        stages = {stage["name"]: stage for stage in report["stages"]}
        self.assertEqual(stages["effect search"]["count"], 1)
        self.assertEqual(stages["pyramid"]["count"], 1)
        self.assertIn("rate-distortion passes", stages)
        self.assertIn("write", stages)

    def test_no_opacity_beside_a_flat_area(self):
        samples = []
        for y in range(64):
            for x in range(96):
                samples += (240, 240, 240) if x < 48 else ((x * y) % 251, (x * 7 + y * y) % 256, 90)
        self.write_png("half.png", Image(96, 64, 3, 8, samples))
        report = self.gscl_json("encode", "half.png", "-o", "half.gscl", "--bytes", "400", "--effort", "1")
        opacity = next(decision for decision in report["effects"] if decision["name"] == "opacity")
        self.assertEqual((opacity["on"], opacity["reason"]), (False, "profile"))

    def test_a_decision_gives_the_same_file_as_the_option(self):
        self.write_png("dots.png", dots(256, 192))
        automatic = self.gscl_json("encode", "dots.png", "-o", "a.gscl", "--bytes", "900", "--effort", "1")
        options = ",".join(("+" if decision["on"] else "-") + decision["name"] for decision in automatic["effects"]
                         if decision["reason"] == "trial")
        self.assertTrue(options)
        self.gscl("encode", "dots.png", "-o", "b.gscl", "--bytes", "900", "--effort", "1", "--quiet", "--effects", options)
        self.assertEqual(self.path("a.gscl").read_bytes(), self.path("b.gscl").read_bytes())


class Options(ToolTest):
    def test_every_effect_on_and_off(self):
        image = scene(80, 60, 4)
        for effects, on, off in (("+opacity", {"opacity"}, set()), ("-chroma", set(), {"chroma"}),
                                 ("-alpha-channel", set(), {"alpha-channel"}),
                                 ("-rotation", set(), {"rotation", "anisotropy"}),
                                 ("-anisotropy,+opacity,-texture", {"opacity"}, {"rotation", "anisotropy", "texture"})):
            with self.subTest(effects):
                self.encode(image, "--bytes", "500", "--effects", effects)
                found = set(self.gscl_json("info", "in.gscl")["effects"])
                self.assertTrue(on <= found and not off & found, found)
                decoded = self.decode()
                if effects == "-chroma":
                    self.assertEqual(decoded.samples[0::4], decoded.samples[1::4])
                if effects == "-alpha-channel":
                    self.assertEqual(set(decoded.samples[3::4]), {255})

    def test_other_blends_and_the_paper_profile(self):
        for arguments, gone in ((("--blend", "alpha", "--effects", "-opacity"), "opacity"),
                                (("--blend", "sum", "--effects", "-rotation"), "anisotropy"),
                                (("--profile", "paper", "--effects", "-rotation,-opacity"), "rotation"),
                                (("--profile", "paper", "--effects", "-anisotropy"), "anisotropy")):
            with self.subTest(arguments):
                self.encode(scene(80, 60), "--bytes", "600", *arguments)
                self.assertNotIn(gone, self.gscl_json("info", "in.gscl")["effects"])
                self.decode()

    def test_refusals(self):
        self.write_png("in.png", scene(40, 30))
        self.write_png("grey.png", scene(40, 30, 1))
        for effects in ("opacity", "+", "+nothing", "+opacity,", "-chroma,+"):
            with self.subTest(effects):
                self.refused("encode", "is not \\+ or - with one of", "encode", "in.png", "-o", "x.gscl", "--effects", effects,
                             code=2)
        for effects, message, name, more in (("+chroma", "no chroma", "grey.png", ()),
                                          ("+alpha-channel", "no alpha channel", "in.png", ()),
                                          ("+rotation,-anisotropy", "circles have no rotation", "in.png", ()),
                                          ("+anisotropy,-rotation", "need rotation", "in.png", ()),
                                          ("+codebooks", "paper profile", "in.png", ()),
                                          ("+texture", "no texture", "in.png", ("--profile", "paper")),
                                          ("+texture", "another blend", "in.png", ("--blend", "alpha")),
                                          ("+opacity,-opacity", "both", "in.png", ())):
            with self.subTest(effects):
                self.refused(name, message, "encode", name, "-o", "x.gscl", "--effects", effects, *more, code=2)


class Costs(ToolTest):
    def test_bits_and_gains(self):
        self.write_png("in.png", scene(96, 64, 4))
        self.gscl("encode", "in.png", "-o", "in.gscl", "--bytes", "700", "--quiet", *FAST)
        without = self.gscl_json("info", "in.gscl")
        with_image = self.gscl_json("info", "in.gscl", "--reference", "in.png")
        self.assertEqual([use["name"] for use in without["effect_uses"]], without["effects"])
        for use, again in zip(without["effect_uses"], with_image["effect_uses"], strict=True):
            self.assertEqual(use["bits"], again["bits"])
            self.assertGreater(use["bits"], 0)
            self.assertIsNone(use["gain_db"])
            self.assertGreater(again["gain_db"], 0 if use["name"] != "texture" else -1)
        chroma = next(stream for stream in without["streams"] if stream["name"] == "chroma")
        use = next(use for use in without["effect_uses"] if use["name"] == "chroma")
        self.assertAlmostEqual(use["bits"], chroma["bits"], delta=64)

    def test_another_image_is_refused(self):
        self.encode(scene(40, 30))
        self.write_png("other.png", scene(41, 30))
        self.refused("other.png", "40 x 30", "info", "in.gscl", "--reference", "other.png")


if __name__ == "__main__":
    main()
