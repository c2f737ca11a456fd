"""The figure of the best alpha has a line and a band for each sweep, and says what it lacks."""

import unittest

from photonlab.figures import best_alpha
from photonlab.records import records, tables
from photonlab.statistics import best_alphas
from support import synthetic
from support.in_folder import InFolder


def write_best(results, radii=("4", "16"), regions=("image", "edge"), passes=(1, 2, 4)):
    """A sweep whose candidates shrink from 0.5;0.7;0.9 to 0.7 alone."""
    made = [{"experiment": "made-up", "scene": "cornell-box", "integrator": "ppm", "radius_initial": radius,
             "component": component, "region": region, "pass": number, "paths_emitted": 1000 * number, "best_alpha": 0.7,
             "probability": 0.9, "candidates": "0.7" if number > 2 else "0.5;0.7;0.9"}
            for component in ["total", "gathered"] for radius in radii for region in regions for number in passes]
    synthetic.write_csv(results, synthetic.rows(lambda *_: 1e-4))
    found = records.read(results)
    tables.write_derived(found, tables.Derived(best_alphas.NAME, best_alphas.columns_of(found.columns), made))
    return found


class BestAlpha(InFolder):
    def test_sweeps_are_told_apart_by_what_differs_and_are_in_its_order(self):
        families = self.families(["16", "4"])
        self.assertEqual(list(families), ["initial radius = 4", "initial radius = 16"])
        self.assertEqual(set(families["initial radius = 16"]["radius_initial"]), {"16"})
        self.assertEqual(list(self.families(["4"])), [""])

    def families(self, radii):
        found = write_best(self.results, radii)
        return best_alpha.families_of(best_alphas.read_best(found), found.columns)

    def test_the_band_reaches_from_the_least_candidate_to_the_largest(self):
        found = write_best(self.results, radii=["4"])
        figure = best_alpha.draw(best_alphas.read_best(found), found.columns)
        axes = figure.axes[0]
        x, y = axes.lines[0].get_data()
        self.assertEqual([list(x), [str(one) for one in y]], [[1000, 2000, 4000], ["nan", "nan", "0.7"]])
        corners = {(round(x), round(y, 3)) for x, y in axes.collections[0].get_paths()[0].vertices}
        # Boxes reach half an alpha beyond the candidates, and to the geometric mean of two passes.
        self.assertLessEqual({(707, 0.4), (707, 1.0), (2828, 0.4), (2828, 1.0), (2828, 0.6), (5657, 0.6), (5657, 0.8)}, corners)
        self.assertEqual(len(figure.axes), 2)    # a column a region

    def test_without_a_table_or_with_an_older_one_it_says_what_to_run(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1e-4))
        self.assertIn("best-alphas.csv: is not there; run `photonlab analyse fits`", self.refusal_of("best_alpha"))
        (self.results / "best-alphas.csv").write_text("scene,best_alpha\nbox,0.7\n")
        self.assertIn("candidates", self.refusal_of("best_alpha"))
        write_best(self.results)
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 2e-4))
        self.assertIn("best-alphas.csv: was made from other records than those in iterations.csv; run `photonlab analyse fits`",
                      self.refusal_of("best_alpha"))


if __name__ == "__main__":
    unittest.main()
