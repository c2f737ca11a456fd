"""Errors at equal seconds are those of the curve through the records, and nothing is made up outside of them."""

import unittest

import numpy

from photonlab.drawing import compared
from photonlab.statistics import equal_time
from support import ensembles as made
from support import synthetic
from support.images import grey, layered, write_exr, write_runs
from support.in_folder import InFolder


class EqualTime(InFolder):
    def write(self, reference=None):
        """A pass of ppm takes 0.25 s (and the first 0.01 s more), one of path 1 s; errors fall as 1 / n and 1 / n^2."""
        ppm = synthetic.rows(lambda seed, number, component: 1e-2 / max(1, number), seeds=[1, 2])
        path = synthetic.rows(lambda seed, number, component: 1e-2 / max(1, number) ** 2, seeds=[1, 2],
                              integrator="path", schedule="", alpha="", kernel="", direct="", direct_samples="",
                              photons_per_pass="", radius_rule="", radius_initial="")
        for row in path:
            row["seconds"] = str(float(row["pass"]))
        synthetic.write_csv(self.results, ppm + path)
        write_runs(self.results, {row["run"] for row in ppm + path}, [16, 64], lambda *_: layered(1.0, 0.5), reference)

    def test_errors_are_interpolated_on_logarithmic_axes(self):
        self.write()
        self.output_of("equal_time")
        rows = [row for row in self.table("equal-time.csv") if row["component"] == "total"]
        # ppm is recorded from 0.26 s to 16.01 s, path from 1 s to 64 s.
        self.assertEqual(sorted({float(row["seconds"]) for row in rows}), [0.5, 1, 2, 4, 8, 16, 32, 64])
        for row in rows:
            seconds = float(row["seconds"])
            note = ("more than recorded" if row["method"] == "PPM" and seconds > 16.01 else
                    "less than one pass" if row["method"] != "PPM" and seconds < 1 else "")
            self.assertEqual((row["note"], row["rmse"] == "", row["region"]), (note, note != "", "image"))
            if note:
                continue
            if row["method"] == "PPM":
                expected = 1e-2 / ((seconds - 0.01) / 0.25)
                self.assertAlmostEqual(float(row["mse"]) / expected, 1, delta=0.01)
            else:
                self.assertAlmostEqual(float(row["mse"]) / (1e-2 / seconds ** 2), 1, delta=1e-9)
                self.assertAlmostEqual(float(row["pass"]), seconds)

    def test_pictures_are_of_the_nearest_pass(self):
        self.write("half.exr")
        write_exr(self.results / "half.exr", layered(1.0, 0.4))
        output = self.output_of("equal_time")
        self.assertIn("equal-time-cornell-box.png", output)

    def test_the_regions_of_the_experiment_are_in_the_table_and_are_the_insets(self):
        seeds = [1, 2, 3]
        made.write_reference(self.results, 0.0, numpy.random.default_rng(1))
        bias = numpy.zeros((made.HEIGHT, made.WIDTH, 1))
        bias[12:, 16:] = 0.1    # the region "edge"
        made.write_ensemble(self.results, "box", seeds, lambda n: bias, lambda n: 0.0, numpy.random.default_rng(2))
        made.write_records(self.results, {"box": {"width": str(made.WIDTH), "height": str(made.HEIGHT)}}, seeds)
        self.output_of("decomposition")
        write_runs(self.results, [f"box_seed-{seed}" for seed in seeds], [16], lambda *_: grey(1.0, (made.HEIGHT, made.WIDTH)),
                   "reference")
        output = self.output_of("equal_time")
        self.assertIn("equal-time-cornell-box.png", output)
        for row in self.table("equal-time.csv"):
            if row["region"] != "image":    # those of the image are the records', which are made up
                self.assertEqual(row["rmse"] != "", row["region"] == "edge", row)    # "smooth" has no error at all
                self.assertTrue(row["note"] == "not resolved" or abs(float(row["rmse"]) - 0.1) < 1e-6)
        self.assertEqual({row["region"] for row in self.table("equal-time.csv")}, {"image", "smooth", "edge"})
        reference = numpy.ones((made.HEIGHT, made.WIDTH, 3))
        self.assertEqual(compared.insets_of(self.read(), reference, None, []), list(made.REGIONS.values()))

    def test_insets_have_no_light_in_them(self):
        reference = numpy.zeros((40, 40, 3))
        reference[4:8, 4:8] = 100.0    # the light, with the most contrast
        reference[30:, 30:] = 1.0
        is_light = reference[:, :, 0] > 10
        y, x = compared.place_of_inset(reference, is_light, 8)
        self.assertFalse(is_light[y:y + 8, x:x + 8].any())
        self.assertGreater(reference[y:y + 8, x:x + 8].std(), 0)

    def test_a_budget_outside_the_records_has_no_error(self):
        self.write()
        curve = equal_time.curve_of(self.read().of_method("PPM"), "total")
        self.assertEqual(equal_time.at_budget(curve, 0.1), "less than one pass")
        self.assertEqual(equal_time.at_budget(curve, 100), "more than recorded")
        self.assertEqual(equal_time.at_budget(curve.assign(mean=-curve["mean"]), 3.0), "not resolved")
        self.assertAlmostEqual(equal_time.at_budget(curve, 3.0)[0], 11.96, delta=0.05)


if __name__ == "__main__":
    unittest.main()
