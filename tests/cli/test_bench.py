"""gscl bench reports every figure, and the figures are consistent; no test bounds a time."""
import unittest

from promises import keys, listed
from tool import OPENCL, ToolTest, main

BLENDS = ("normalized", "alpha", "sum")
KERNELS = ("raster_forward", "bin", "fit_tiles", "step_splats", "fit step")


class Host(ToolTest):
    """On the device "host"."""

    arguments = ("--device", "host")
    report = None

    def measured(self):
        """The report of one run, shared by all tests."""
        if not type(self).report:
            type(self).report = self.gscl_json("bench", "--repetitions", "1", "--encodes", "1", *self.arguments)
        return self.report

    def rows(self):
        (kernels,) = self.measured()["kernels"]
        return kernels["measurements"]

    def test_members_are_those_promised(self):
        self.assertEqual(sorted(keys(self.measured())), sorted(listed("Members of JSON")["bench --json"]))

    def test_measures_every_kernel_and_blend(self):
        expected = {("multiply_add", None, None), ("copy", None, None)}
        expected |= {(name, blend, splats) for name in KERNELS for blend in BLENDS for splats in (500, 2500)}
        self.assertEqual({(row["name"], row.get("blend"), row.get("splats")) for row in self.rows()}, expected)

    def test_seconds_are_in_order(self):
        for row in self.rows() + self.measured()["codec"]:
            self.assertTrue(0 < row["fastest_s"] <= row["median_s"] <= row["slowest_s"], row)

    def test_few_evaluations_lie_outside_the_outlines(self):
        for row in self.rows():
            if "work_per_needed" in row:
                self.assertTrue(1 <= row["work_per_needed"] <= 1.5, row)

    def test_stages_add_up_to_the_run(self):
        runs = self.measured()["codec"]
        self.assertEqual([(run["operation"], run["bpp"]) for run in runs],
                         [("encode", 0.042), ("decode", 0.042), ("encode", 0.183), ("decode", 0.183)])
        for run in runs:
            seconds = sum(stage["seconds"] for stage in run["stages"])
            self.assertTrue(0.7 * run["median_s"] < seconds < 1.02 * run["median_s"], run)
            for stage in run["stages"]:
                self.assertTrue(0 <= stage["kernel_seconds"] <= stage["seconds"], stage)
            for kernel in run["kernels"]:
                self.assertGreaterEqual(kernel["build_seconds"], 0, kernel)
                self.assertTrue(0 < kernel["fewest_items"] <= kernel["mean_items"], kernel)

    def test_encodes_hardly_wait_for_the_device(self):
        """At most 60 times an encode, and 32 times more for each of the two fits of the search for effects."""
        for run in self.measured()["codec"]:
            waits = {stage["name"]: stage["waits"] for stage in run["stages"]}
            self.assertEqual(run["waits"], sum(waits.values()), run)
            self.assertLessEqual(waits.pop("effect search", 0), 2 * 32, run)
            self.assertTrue(0 < sum(waits.values()) <= (60 if run["operation"] == "encode" else 2), run)
            self.assertGreater(run["launches"], run["waits"])

    def test_refuses_a_file_that_is_no_image(self):
        self.write("text.png", b"no image")
        self.refused("text.png", ".", "bench", "text.png", "--encodes", "1", "--repetitions", "1")


class OpenCL(Host):
    """On a device of OpenCL."""

    arguments = (*OPENCL, "--mapping", "cpu")
    report = None


if __name__ == "__main__":
    main()
