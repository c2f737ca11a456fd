"""Errors by region: at the same pass as they are, at the same time by a power of the time between passes."""

import unittest

import numpy
import pandas
from photonlab.figures import regions
from support import ensembles as made
from support.in_folder import InFolder

SEEDS = list(range(1, 9))


def curve(method, seconds_a_pass, mse_at_one, passes):
    """MSE falls as one over the passes, in both regions; twice as large in the second."""
    return [{"method": method, "region": region, "pass": number, "cpu_seconds": seconds_a_pass * number, "seeds": 8,
             "mse": factor * mse_at_one / number, "mse_error": 0.1 * factor * mse_at_one / number}
            for number in passes for region, factor in [("smooth", 1), ("edge", 2)]]


class Budgets(unittest.TestCase):
    def setUp(self):
        self.rows = pandas.DataFrame(curve("fast", 1.0, 4.0, [1, 2, 4, 8]) + curve("slow", 3.0, 1.0, [1, 4, 8, 16]))

    def test_a_pass_that_one_has_alone_is_not_shown(self):
        rows = pandas.DataFrame(curve("fast", 1.0, 4.0, [1, 2, 4, 100]) + curve("slow", 3.0, 1.0, [1, 2, 4, 128]))
        self.assertEqual(regions.at_pass(rows)[0], 4)

    def test_the_pass_is_the_last_of_all(self):
        last, found = regions.at_pass(self.rows)
        self.assertEqual(last, 8)
        self.assertEqual(found["fast"]["smooth"][0], 0.5)
        self.assertEqual(found["slow"]["edge"][0], 0.25)

    def test_between_passes_mse_is_a_power_of_the_time(self):
        budget, found = regions.at_seconds(self.rows)
        self.assertEqual(budget, 8.0)
        self.assertAlmostEqual(found["fast"]["smooth"][0], 0.5)
        self.assertAlmostEqual(found["slow"]["smooth"][0], 1.0 / (8.0 / 3.0))
        self.assertAlmostEqual(found["slow"]["edge"][1], 0.1 * 2.0 / (8.0 / 3.0))

    def test_who_has_not_begun_is_left_out(self):
        rows = pandas.concat([self.rows, pandas.DataFrame(curve("late", 10.0, 1.0, [1, 2]))])
        self.assertNotIn("late", regions.at_seconds(rows)[1])


class Regions(InFolder):
    def test_a_panel_has_a_place_a_region_and_a_line_a_method(self):
        random = numpy.random.default_rng(7)
        made.write_reference(self.results, 0.001, random)
        settings = {}
        for alpha in ["0.5", "0.7"]:
            made.write_ensemble(self.results, f"box_{alpha}", SEEDS, lambda n: 0.0, lambda n: 0.1 / max(1, n) ** 0.5, random)
            settings[f"box_{alpha}"] = {"alpha": alpha}
        made.write_records(self.results, settings, SEEDS)
        self.output_of("decomposition")
        scene = self.read().scenes()[0]
        figure = regions.draw(scene, regions.curves_of(self.read(), scene))
        axes = figure.axes[0]
        self.assertEqual([label.get_text() for label in axes.get_xticklabels()], list(made.REGIONS))
        self.assertEqual(len(axes.containers), 2)
        self.assert_drawn(self.output_of("regions"), f"regions-{scene.scene}")


if __name__ == "__main__":
    unittest.main()
