"""The figure of bias and variance shows what decomposition.csv says, theory beside it, and marks what is not resolved."""

import unittest

import numpy

from photonlab.figures import bias_variance
from photonlab.records import methods
from photonlab.statistics import decomposition, theory
from photonlab.statistics.moments import QUANTITIES
from support import ensembles as made
from support.in_folder import InFolder


class BiasVariance(InFolder):
    def setUp(self):
        super().setUp()
        random = numpy.random.default_rng(31)
        made.write_reference(self.results, 0.001, random)
        seeds = list(range(1, 9))
        settings = {}
        for alpha in ["0.5", "0.9"]:
            made.write_ensemble(self.results, f"box_alpha-{alpha}", seeds, lambda n: 0.1 if alpha == "0.9" else 0.0,
                                lambda n: 0.2 / max(1, n) ** 0.25, random)
            settings[f"box_alpha-{alpha}"] = {"alpha": alpha, "schedule": "knaus-zwicker"}
        made.write_records(self.results, settings, seeds)
        self.output_of("decomposition")

    def test_a_curve_lies_where_its_photons_and_seconds_are(self):
        rows = decomposition.read_decomposition(self.read())
        own = rows[(rows["point"] == "box_alpha-0.9") & (rows["component"] == "gathered") & (rows["region"] == "image") &
                   (rows["pass"] > 0)]
        for against, place in [("passes", lambda n: n), ("photons", lambda n: 50000 * n), ("seconds", lambda n: 0.01 + n / 4)]:
            places, values, *_ = bias_variance.curve_of(own, "mse", against)
            numpy.testing.assert_allclose(places, [place(n) for n in [1, 2, 4, 8, 16, 32, 64, 128]])
            numpy.testing.assert_allclose(bias_variance.places_of(own, numpy.array([4, 128]), against), [place(4), place(128)])
        self.assertEqual(len(bias_variance.curve_of(own.assign(paths_emitted=numpy.nan), "mse", "photons")[0]), 0)

    def test_roots_are_drawn_of_the_same_values(self):
        found = self.read()
        squares, roots = (bias_variance.draw(found, decomposition.read_decomposition(found), "seconds", roots)
                          for roots in [False, True])
        for one, other in zip(squares.axes, roots.axes):
            for line, root in zip(one.lines, other.lines):
                if line.get_marker() in ["o", "s"]:
                    numpy.testing.assert_allclose(root.get_ydata() ** 2, line.get_ydata())
                    numpy.testing.assert_allclose(root.get_xdata(), 0.01 + 2.0 ** numpy.arange(8) / 4)
        self.assertEqual([axes.get_ylabel() for axes in roots.axes[::3]], [f"{region} (radiance)" for region in
                                                                          ["image", "smooth", "edge"]])
        self.assertIn("(s)", roots.axes[0].get_xlabel())

    def test_the_file_is_named_after_the_axes(self):
        output = self.output_of("bias_variance", "--against", "photons", "--roots")
        self.assert_drawn(output, "bias-variance-cornell-box-roots-photons")

    def test_what_is_not_above_two_errors_is_not_resolved(self):
        rows = decomposition.read_decomposition(self.read())
        gathered = rows[(rows["component"] == "gathered") & (rows["region"] == "image") & (rows["pass"] > 0)]
        *_, resolved = bias_variance.curve_of(gathered[gathered["point"] == "box_alpha-0.9"], "squared_bias")
        self.assertTrue(resolved.all())
        *_, resolved = bias_variance.curve_of(gathered[gathered["point"] == "box_alpha-0.5"], "squared_bias")
        self.assertLess(resolved.sum(), 4)    # of 8 passes; above two errors by chance in a few

    def test_theory_starts_at_the_first_value_of_the_window(self):
        rows = decomposition.read_decomposition(self.read())
        rows = rows[(rows["point"] == "box_alpha-0.9") & (rows["pass"] > 0)]
        recorded = self.read().rows
        recorded = recorded[recorded["run"].map(methods.point_of) == "box_alpha-0.9"]
        passes, values = bias_variance.theory_of(recorded, rows, "gathered", "image")
        self.assertEqual((passes[0], passes[-1]), (4, 128))
        at_first = rows[(rows["pass"] == 4) & (rows["region"] == "image") & (rows["component"] == "gathered")].iloc[0]
        for quantity in QUANTITIES:
            for kind, line in values[quantity].items():
                self.assertAlmostEqual(line[0] / at_first[quantity], 1, places=9)
        self.assertEqual([list(values[quantity]) for quantity in ["variance", "squared_bias", "mse"]],
                         [["squared_bias"], ["squared_bias", "edge"], ["squared_bias", "edge"]])
        squared = theory.knaus_zwicker_radii(0.9, 128)
        smooth, edge = (numpy.cumsum(squared) / numpy.arange(1, 129)) ** 2, theory.squared_bias_at_edges(squared)
        for kind, expected in [("squared_bias", smooth), ("edge", edge)]:
            self.assertAlmostEqual(values["squared_bias"][kind][-1] / values["squared_bias"][kind][0], expected[-1] / expected[3])

    def test_without_a_decomposition_it_says_what_to_run(self):
        (self.results / "decomposition.csv").unlink()
        self.assertIn("run `photonlab analyse decomposition` first", self.refusal_of("bias_variance"))


if __name__ == "__main__":
    unittest.main()
