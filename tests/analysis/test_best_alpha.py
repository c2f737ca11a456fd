"""The figure of the best alpha has a line and a band for each sweep, and says what it lacks."""

import tempfile
import unittest
from pathlib import Path

import synthetic

try:
    import best_alpha
    import fits
    import records
    import tables
except ImportError as error:
    raise unittest.SkipTest(f"{error} (Debian: python3-openimageio)")


def write_best(results, radii=("4", "16"), regions=("image", "edge"), passes=(1, 2, 4)):
    """A sweep whose candidates shrink from 0.5;0.7;0.9 to 0.7 alone."""
    made = [{"experiment": "made-up", "scene": "cornell-box", "integrator": "ppm", "radius_initial": radius,
             "component": component, "region": region, "pass": number, "paths_emitted": 1000 * number, "best_alpha": 0.7,
             "probability": 0.9, "candidates": "0.7" if number > 2 else "0.5;0.7;0.9"}
            for component in ["total", "gathered"] for radius in radii for region in regions for number in passes]
    synthetic.write_csv(results, synthetic.rows(lambda *_: 1e-4))
    tables.write_derived(records.read(results), "best-alphas.csv", fits.BEST_COLUMNS, made)
    return records.read(results)


class BestAlpha(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

    def test_a_figure_a_scene_is_drawn(self):
        write_best(self.results)
        code, output, errors = synthetic.run(best_alpha, self.results)
        self.assertEqual((code, errors), (0, ""))
        for name in ["best-alpha-cornell-box.png", "best-alpha-cornell-box.pdf"]:
            self.assertIn(name, output)

    def test_sweeps_are_told_apart_by_what_differs_and_are_in_its_order(self):
        families = best_alpha.families_of(best_alpha.read_best(write_best(self.results, radii=["16", "4"])))
        self.assertEqual(list(families), ["initial radius = 4", "initial radius = 16"])
        self.assertEqual(set(families["initial radius = 16"]["radius_initial"]), {"16"})
        self.assertEqual(list(best_alpha.families_of(best_alpha.read_best(write_best(self.results, radii=["4"])))), [""])

    def test_the_band_reaches_from_the_least_candidate_to_the_largest(self):
        figure = best_alpha.draw_scene(best_alpha.read_best(write_best(self.results, radii=["4"])))
        axes = figure.axes[0]
        x, y = axes.lines[0].get_data()
        self.assertEqual([list(x), [str(one) for one in y]], [[1000, 2000, 4000], ["nan", "nan", "0.7"]])
        corners = {(round(x), round(y, 3)) for x, y in axes.collections[0].get_paths()[0].vertices}
        # Boxes reach half an alpha beyond the candidates, and to the geometric mean of two passes.
        self.assertLessEqual({(707, 0.4), (707, 1.0), (2828, 0.4), (2828, 1.0), (2828, 0.6), (5657, 0.6), (5657, 0.8)}, corners)
        self.assertEqual(len(figure.axes), 2)    # a column a region

    def test_without_a_table_or_with_an_older_one_it_says_what_to_run(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1e-4))
        code, _, errors = synthetic.run(best_alpha, self.results)
        self.assertEqual(code, 2)
        self.assertIn("best-alphas.csv: is not there; run fits.py", errors)
        (self.results / "best-alphas.csv").write_text("scene,best_alpha\nbox,0.7\n")
        code, _, errors = synthetic.run(best_alpha, self.results)
        self.assertEqual(code, 2)
        self.assertIn("candidates", errors)
        write_best(self.results)
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 2e-4))
        code, _, errors = synthetic.run(best_alpha, self.results)
        self.assertEqual(code, 2)
        self.assertIn("best-alphas.csv: was made from other records than those in iterations.csv; run fits.py", errors)


if __name__ == "__main__":
    unittest.main()
