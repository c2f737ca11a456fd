"""What is drawn of probes is what was recorded, and what does not belong to the records is refused."""

import csv
import tempfile
import unittest
from pathlib import Path

import synthetic

import probes
import records


class Probes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)
        made = synthetic.rows(lambda seed, number, component: 1e-4, seeds=[1, 2])
        synthetic.write_csv(self.results, made)
        self.run = made[0]["run"]

    def write(self, rows):
        with open(self.results / "probes.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, probes.COLUMNS)
            writer.writeheader()
            writer.writerows(rows)

    def row(self, number, **changed):
        return {"schema": 1, "experiment": "made-up", "run": self.run, "scene": "cornell-box", "seed": 1,
                "probe": "corner", "x": 3, "y": 4, "pass": number, "radius": 10 / number, "photons": 5 * number,
                "density": number ** 3, "radiance_r": 0.3, "radiance_g": 0.2, "radiance_b": 0.1, **changed}

    def test_rows_are_numbers_with_the_label_of_their_method(self):
        self.write([self.row(1), self.row(2, density="")])
        rows = probes.read_probes(records.read(self.results), {self.run: "PPM"})
        self.assertEqual(list(rows["radius"]), [10, 5])
        self.assertTrue(rows["density"].isna().iloc[1])
        self.assertAlmostEqual(rows["radiance"].iloc[0], 0.2)
        self.assertEqual(set(rows["method"]), {"PPM"})

    def test_a_figure_a_scene_is_drawn(self):
        self.write([self.row(number, probe=probe) for probe in ["corner", "wall"] for number in range(1, 9)])
        code, output, errors = synthetic.run(probes, self.results)
        self.assertEqual((code, errors), (0, ""))
        for name in ["probes-cornell-box.png", "probes-cornell-box.pdf"]:
            self.assertIn(name, output)
            self.assertGreater((self.results / "figures" / name).stat().st_size, 1000)

    def test_what_does_not_fit_is_refused(self):
        for rows, expected in [([self.row(1, run="other")], "probes.csv:2: run other is not in iterations.csv"),
                               ([self.row(1), self.row(2, radius="wide")], "probes.csv:3: radius is \"wide\"")]:
            self.write(rows)
            code, _, errors = synthetic.run(probes, self.results)
            self.assertEqual(code, 2)
            self.assertIn(expected, errors)
        (self.results / "probes.csv").unlink()
        self.assertIn("expected an experiment with probes", synthetic.run(probes, self.results)[2])

    def test_labels_are_those_of_the_records(self):
        self.write([self.row(1)])
        rows = records.read(self.results).rows
        self.assertEqual(set(rows["method"]), {"PPM"})


if __name__ == "__main__":
    unittest.main()
