"""A grid's cells are the errors of its two settings, the least one in bold, and a sweep that is none is refused."""

import tempfile
import unittest
from pathlib import Path

import numpy
import synthetic

try:
    import grid
    import records
    from test_strip import layered, write_exr
except ImportError as error:
    raise unittest.SkipTest(f"{error} (Debian: python3-openimageio)")


class Grid(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

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
        rows = records.read(self.results).rows
        self.assertEqual(grid.swept_settings(rows), ["radius_initial", "alpha"])
        columns, lines, errors = grid.final_errors(rows, "alpha", "radius_initial")
        self.assertEqual((columns, lines), (["0.5", "0.9"], ["4", "16", "100"]))
        numpy.testing.assert_allclose(errors ** 2, [[1.7e-4, 2.1e-4], [5e-5, 9e-5], [8.9e-4, 9.3e-4]])

    def test_heat_map_and_differences_are_drawn(self):
        for run in self.make():
            folder = synthetic.write_run(self.results, run, [64], "half.exr", working_directory=str(self.results))
            write_exr(folder / "snapshots/pass-000064.exr", layered(1.0, 0.5))
        write_exr(self.results / "half.exr", layered(1.0, 0.4))
        code, output, errors = synthetic.run(grid, self.results)
        self.assertEqual((code, errors), (0, ""))
        for name in ["grid-cornell-box.png", "differences-cornell-box.pdf"]:
            self.assertIn(name, output)

    def test_one_setting_or_three_are_no_grid(self):
        self.make(radii=["4"])
        code, _, errors = synthetic.run(grid, self.results)
        self.assertEqual(code, 2)
        self.assertIn("expected a sweep over two settings, found alpha", errors)


if __name__ == "__main__":
    unittest.main()
