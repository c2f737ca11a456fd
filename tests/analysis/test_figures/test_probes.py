"""What is drawn of probes is what was recorded, and what does not belong to the records is refused."""

import unittest

from photonlab.figures import probes
from support import synthetic
from support.in_folder import InFolder


class Probes(InFolder):
    def setUp(self):
        super().setUp()
        made = synthetic.rows(lambda seed, number, component: 1e-4, seeds=[1, 2])
        synthetic.write_csv(self.results, made)
        self.name_of_run = made[0]["run"]

    def write(self, rows):
        synthetic.write_rows(self.results / "probes.csv", probes.COLUMNS, rows)

    def row(self, number, **changed):
        return {"schema": 1, "experiment": "made-up", "run": self.name_of_run, "scene": "cornell-box", "seed": 1,
                "probe": "corner", "x": 3, "y": 4, "pass": number, "radius": 10 / number, "photons": 5 * number,
                "density": number ** 3, "radiance_r": 0.3, "radiance_g": 0.2, "radiance_b": 0.1, **changed}

    def test_rows_are_numbers_with_the_label_of_their_method(self):
        self.write([self.row(1), self.row(2, density="")])
        rows = probes.read_probes(self.read())
        self.assertEqual(list(rows["radius"]), [10, 5])
        self.assertTrue(rows["density"].isna().iloc[1])
        self.assertAlmostEqual(rows["radiance"].iloc[0], 0.2)
        self.assertEqual(set(rows["method"]), {"PPM"})

    def test_a_figure_a_scene_is_drawn(self):
        self.write([self.row(number, probe=probe) for probe in ["corner", "wall"] for number in range(1, 9)])
        self.assert_drawn(self.output_of("probes"), "probes-cornell-box")

    def test_what_does_not_fit_is_refused(self):
        for rows, expected in [([self.row(1, run="other")], "probes.csv:2: run other is not in iterations.csv"),
                               ([self.row(1), self.row(2, radius="wide")], "probes.csv:3: radius is \"wide\"")]:
            self.write(rows)
            self.assertIn(expected, self.refusal_of("probes"))
        (self.results / "probes.csv").unlink()
        self.assertIn("expected an experiment with probes", self.refusal_of("probes"))


if __name__ == "__main__":
    unittest.main()
