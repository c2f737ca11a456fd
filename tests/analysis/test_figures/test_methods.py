"""What is said of methods beside each other: ratios to PPM's MSE, radii, and whether estimated errors are right."""

import shutil
import unittest

import numpy
from photonlab.figures import calibration, methods, radii
from support import ensembles as made
from support import synthetic
from support.images import grey, write_runs
from support.in_folder import InFolder

SEEDS = list(range(1, 9))
NOISE = {"hachisuka": 0.2, "adaptive": 0.1}    # standard deviation after a pass


class Methods(InFolder):
    def setUp(self):
        super().setUp()
        random = numpy.random.default_rng(31)
        made.write_reference(self.results, 0.001, random)
        settings = {}
        for schedule, noise in NOISE.items():
            for footprints in ["2", "8"]:
                point = f"box_{schedule}-{footprints}"
                made.write_ensemble(self.results, point, SEEDS, lambda n: 0.0, lambda n: noise / max(1, n) ** 0.5, random)
                settings[point] = {"schedule": schedule, "footprints": footprints, "alpha": ""}
        made.write_records(self.results, settings, SEEDS)
        self.output_of("decomposition")

    def test_ratios_are_those_of_the_variances(self):
        self.output_of("methods")
        image = {row["method"]: row for row in self.table("methods.csv") if row["region"] == "image"}
        self.assertEqual(len(image), 2)
        for method, row in image.items():
            expected = 1.0 if "hachisuka" in method else (NOISE["adaptive"] / NOISE["hachisuka"]) ** 2
            error = float(row["relative_error"])
            self.assertLess(abs(float(row["relative"]) - expected), 4 * error + 1e-12, method)
            self.assertEqual(error == 0.0, "hachisuka" in method)
            self.assertLess(error, 0.2 * expected)

    def test_the_noise_that_both_have_is_in_neither_error(self):
        for schedule, noise in NOISE.items():
            made.write_ensemble(self.results, f"box_{schedule}-2", SEEDS, lambda n: 0.0, lambda n: noise / max(1, n) ** 0.5,
                                numpy.random.default_rng(8))
        self.output_of("decomposition")
        self.output_of("methods")
        row, = (row for row in self.table("methods.csv") if row["region"] == "image" and "adaptive" in row["method"])
        self.assertAlmostEqual(float(row["relative"]), (NOISE["adaptive"] / NOISE["hachisuka"]) ** 2, delta=1e-3)
        self.assertLess(float(row["relative_error"]), 5e-4)    # 2.4e-3 if they were independent

    def test_without_the_sums_over_seeds_errors_are_those_of_independent_methods(self):
        self.output_of("methods")
        rows = self.table("methods.csv")
        shutil.rmtree(self.results / "ensembles")
        self.assertIn("errors of ratios are those of independent methods", self.output_of("methods"))
        for row, other in zip(rows, self.table("methods.csv")):
            self.assertEqual(row["relative"], other["relative"])
            self.assertEqual(float(other["relative_error"]) == 0.0, "hachisuka" in row["method"])

    def test_scenes_that_were_not_asked_for_are_left_out(self):
        self.assertIn("no ppm with schedule hachisuka", self.output_of("methods", "--methods", "*adaptive*"))

    def test_the_sweep_has_a_line_a_rule_and_a_place_a_radius(self):
        figure = methods.draw_sweep(methods.last_rows(self.read()))
        for axes in figure.axes:
            places = [container.lines[0].get_xdata() for container in axes.containers]
            self.assertEqual([list(place) for place in places], [[2.0, 8.0], [2.0, 8.0]])
        self.assert_drawn(self.output_of("methods"), "initial-radius")

    def test_without_ppm_there_is_nothing_to_compare_with(self):
        text = (self.results / "iterations.csv").read_text().replace("hachisuka", "chi-square")
        (self.results / "iterations.csv").write_text(text)
        self.output_of("decomposition")
        self.assertIn("no ppm with schedule hachisuka", self.output_of("methods"))


class Radii(InFolder):
    def make_results(self, radius_of):
        rows = []
        for schedule in NOISE:
            rows += synthetic.rows(lambda *_: 0.01, seeds=[1], schedule=schedule, alpha="")
        synthetic.write_csv(self.results, rows)
        write_runs(self.results, sorted({row["run"] for row in rows}), [1, 64],
                   lambda run, number: {**grey(0.5), **radius_of(run, number)})

    def test_each_method_has_a_panel_of_its_last_snapshot(self):
        def radius_of(run, number):
            values = numpy.full((4, 6), 3.0 if "adaptive" in run else 2.0) / number
            values[0, 0] = 0.0
            return {"radius": values}

        self.make_results(radius_of)
        found = radii.collect(self.read().scenes()[0], False)
        self.assertEqual([float(numpy.nanmean(radius)) for radius in found.values()], [2.0 / 64, 3.0 / 64])
        for radius in found.values():
            self.assertTrue(numpy.isnan(radius[0, 0]))
        self.assert_drawn(self.output_of("radii"), "radii-cornell-box")

    def test_images_of_an_older_program_have_none(self):
        self.make_results(lambda run, number: {})
        self.assertIn("cornell-box: no snapshot that has radii", self.output_of("radii"))


class Calibration(InFolder):
    def test_shares_are_drawn_as_they_are_recorded(self):
        rows = synthetic.rows(lambda *_: 0.01, seeds=[1, 2], passes=[1, 2, 4], schedule="hachisuka")
        for row in rows:
            if row["component"] == "gathered" and row["pass"] != "1":
                row.update(within_50=str(0.4 + 0.02 * int(row["seed"])), within_90="0.8")
        synthetic.write_csv(self.results, rows, [*synthetic.COLUMNS, "within_50", "within_90"])
        found = self.read()
        known = calibration.known_rows(found)
        self.assertEqual(sorted(set(known["pass"])), [2, 4])
        drawn = [line.get_ydata() for line in calibration.draw(found, known).axes[0].lines if len(line.get_xdata()) == 2
                 and list(line.get_xdata()) == [2, 4]]
        numpy.testing.assert_allclose(drawn[0], [0.43, 0.43])
        numpy.testing.assert_allclose(drawn[1], [0.8, 0.8])
        self.assert_drawn(self.output_of("calibration"), "calibration")


if __name__ == "__main__":
    unittest.main()
