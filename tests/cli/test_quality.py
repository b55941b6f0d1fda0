"""Quality does not fall with more bytes or more effort, on smooth images, where it once did.

tests/bench/monotone.py measures the same of many kinds of images, by finer steps.
"""
import math

from images import Image, scene
from tool import ToolTest, main

WIDTH, HEIGHT = 96, 64
TOLERANCE = 0.6  # dB: another seed changes the PSNR of smooth images by as much
NEARLY_EXACT = 53  # dB: the root mean square of the error is 0.57 of a level
BUDGETS = (100, 240, 480, 650, 1100)


def glow(u, v):
    return [math.exp(-((u - 0.45) ** 2 + (v - 0.3) ** 2) / 0.05)] * 3


def ramp(u, v):
    return [0.2 + 0.3 * u + 0.2 * v, 0.25 + 0.1 * u + 0.3 * v, 0.2 + 0.35 * u]


def ripple(u, v):
    return [0.5 + share * math.cos(7 * (u + 0.5 * v)) for share in (0.2, 0.1, 0.15)]


def vignette(u, v):
    return [share * (1 - 1.2 * ((u - 0.5) ** 2 + (v - 0.33) ** 2)) for share in (0.9, 0.6, 0.7)]


def drawn(function):
    samples = []
    for y in range(HEIGHT):
        for x in range(WIDTH):
            colour = function((x + 0.5) / WIDTH, (y + 0.5) / WIDTH)
            samples += [min(max(round(255 * value), 0), 255) for value in colour]
    return Image(WIDTH, HEIGHT, 3, 8, samples)


class Quality(ToolTest):
    def measure(self, budget, effort):
        """Bytes and PSNR of in.png as a file."""
        report = self.gscl_json("encode", "in.png", "-o", "in.gscl", "--bytes", str(budget), "--effort", str(effort),
                                "--device", "host", "--quiet")
        return report["bytes"], 99 if report["psnr"] is None else report["psnr"]

    def check_grows(self, what, points):
        """`points`: of (name, budget, bytes, PSNR), in the order in which quality should grow."""
        best = -math.inf
        for name, budget, size, quality in points:
            with self.subTest(**{what: name}):
                self.assertGreaterEqual(quality, best - TOLERANCE)
                self.assertTrue(size >= 0.9 * budget or quality >= NEARLY_EXACT, (size, quality))
            best = max(best, quality)

    def test_bytes(self):
        for function in (glow, ripple, vignette):
            self.write_png("in.png", drawn(function))
            self.check_grows(function.__name__, [(budget, budget, *self.measure(budget, 5)) for budget in BUDGETS])

    def test_effort(self):
        for name, image in (("ramp", drawn(ramp)), ("scene", scene(WIDTH, HEIGHT))):
            self.write_png("in.png", image)
            self.check_grows(name, [(effort, 300, *self.measure(300, effort)) for effort in (0, 2, 5)])


if __name__ == "__main__":
    main()
