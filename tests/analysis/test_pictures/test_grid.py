"""A grid's cells are the errors of its two settings, the least one in bold, and a sweep that is none is refused."""

import unittest

import numpy

from photonlab.figures import grid
from support import synthetic
from support.images import layered, write_exr, write_runs
from support.in_folder import InFolder


class Grid(InFolder):
    def make(self, alphas=("0.5", "0.9"), radii=("4", "16", "100")):
        made = []
        for alpha in alphas:
            for radius in radii:
                error = float(alpha) * 1e-4 + abs(float(radius) - 16) * 1e-5
                made += synthetic.rows(lambda seed, number, component: error * (1 + 0.5 * (-1) ** seed), seeds=[1, 2],
                                       alpha=alpha, radius_rule="given", radius_initial=radius)
        synthetic.write_csv(self.results, made)
        return sorted({row["run"] for row in made})

    def test_cells_are_root_mean_errors_of_the_last_pass(self):
        self.make()
        found = self.read()
        self.assertEqual(grid.swept_settings(found), ["radius_initial", "alpha"])
        columns, lines, errors = grid.final_errors(found.rows, "alpha", "radius_initial")
        self.assertEqual((columns, lines), (["0.5", "0.9"], ["4", "16", "100"]))
        numpy.testing.assert_allclose(errors ** 2, [[1.7e-4, 2.1e-4], [5e-5, 9e-5], [8.9e-4, 9.3e-4]])

    def test_heat_map_and_differences_are_drawn(self):
        write_runs(self.results, self.make(), [64], lambda *_: layered(1.0, 0.5), "half.exr")
        write_exr(self.results / "half.exr", layered(1.0, 0.4))
        self.assert_drawn(self.output_of("grid"), "grid-cornell-box", "differences-cornell-box")

    def test_one_setting_or_three_are_no_grid(self):
        self.make(radii=["4"])
        self.assertIn("expected a sweep over two settings, found alpha", self.refusal_of("grid"))


if __name__ == "__main__":
    unittest.main()
