"""Limits of the launches of kernels and of the waits of encodes in the GPU mapping, where each launch takes its time and depends
on the one before it.

The steps are as many as those of the larger picture in tests/bench/GPU.md at 0.042 bits a pixel.  The number of splats is given,
so that no passes search a price for a budget of bytes.  The limits of launches leave 5 % (tune psnr) and 1 % of room, of which another
seed takes 0.3 %.
"""
import os
import pathlib
import sys
import unittest

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "cli"), str(TESTS / "devices")]

import launches
from images import textured
from test_cache import POCL, platforms
from tool import GSCL, ToolTest, main

SIZE, SPLATS = (384, 256), "150"  # far apart, for which a fit of the CPU mapping takes more steps
STEPS = 1500


@unittest.skipUnless(platforms().get(POCL) == "0.0", "needs PoCL as the only platform")
class Launches(ToolTest):
    def record(self, tune):
        self.write_png("picture.png", textured(*SIZE))
        return launches.record_encode(os.path.dirname(GSCL), str(self.path("picture.png")), "--splats", SPLATS, "--tune", tune)

    def check(self, log, most, most_waits):
        """At most so many launches and waits; the steps are those expected, with two launches each; the tables can be written."""
        self.assertLessEqual(len(log.groups["fit_tiles"]), STEPS)
        self.assertEqual(len(log.groups["step_splats"]), len(log.groups["fit_tiles"]))
        self.assertLessEqual(log.launches, most)
        self.assertLessEqual(sum(log.waits.values()), most_waits)
        self.assertEqual(len(list(launches.kernel_rows(log))), 2 + len(log.groups))
        self.assertEqual(len(list(launches.case_rows({("", ""): log}))), 3)

    def test_tune_psnr(self):
        log = self.record("psnr")
        self.check(log, 4300, 30)
        # Lists are renewed every eighth step, and where splats were added.
        self.assertLess(len(log.groups["bin"]), STEPS / 8 + 40)
        self.assertEqual(len(log.groups["begin_lists"]), len(log.groups["bin"]))
        self.assertNotIn("bin_count", log.groups)

    def test_tune_visual(self):
        log = self.record("visual")
        self.check(log, 6300, 35)
        # A model is followed by lists for both halves of the rows.
        self.assertLess(len(log.groups["bin"]), 2 * len(log.groups["visual_model"]) + STEPS / 8 + 40)
        # Eight launches of a model, and a few of the picture itself.
        models = len(log.groups["visual_model"])
        self.assertLess(models, STEPS / 8)
        self.assertLess(sum(len(groups) for name, groups in log.groups.items() if name.startswith("visual_")),
                        8 * models + 30)


if __name__ == "__main__":
    main()
