"""Errors are those that were put into the images, and the range that is called right ends where they exceed 0.1%."""

import unittest

import numpy

from photonlab.figures import extremes
from photonlab.records import files
from support import synthetic
from support.images import grey, write_runs
from support.in_folder import InFolder

UPDATE = """axis,value,update,radius,count,estimate
passes,1,program,0,0,0
passes,1000000,program,1e-13,3e-13,2e-13
passes,1,float,0,0,0
passes,1000000,float,1e-4,5e-3,2e-3
alpha,0.7,float,1e-4,5e-4,2e-4
"""


class Extremes(InFolder):
    def setUp(self):
        super().setUp()
        self.results, self.rays = self.results / "photons", self.results / "rays"

    def make(self, results, images):
        """images: {(scene, integrator, branch cut-off): radiance of each seed}"""
        made = []
        for (scene, integrator, cutoff), radiances in images.items():
            settings = synthetic.PM_RADIUS if integrator == "photonmapper" else {"integrator": integrator}
            for seed, radiance in enumerate(radiances, 1):
                rows = synthetic.rows(lambda *_: 1e-3, seeds=[seed], passes=[8], **settings)
                run = f"{scene}_{integrator}_{cutoff}_seed-{seed}"
                made += [{**row, "scene": scene, "branch_cutoff": cutoff, "run": run} for row in rows]
                write_runs(results, [run], [8], lambda *_: grey(radiance))
        synthetic.write_csv(results, made)

    def make_all(self):
        photons = {}
        for method in ["ppm", "photonmapper"]:
            photons |= {("unit-1", method, "0.0001"): [4.04, 3.97], ("unit-1e-06", method, "0.0001"): [4.04, 3.97],
                        ("unit-1e+06", method, "0.0001"): [4.04 * 1.01, 3.97 * 1.01], ("light-1", method, "0.0001"): [2.0, 2.0],
                        ("light-100", method, "0.0001"): [200.0, 200.1], ("radius-0.015625", method, "0.0001"): [0.1, 0.2]}
        self.make(self.results, photons)
        self.make(self.rays, {("index-1.5", "path", "0.0001"): [0.9995], ("index-4", "path", "0.0001"): [0.99],
                              ("index-1.5", "path", "1e-06"): [0.99995]})
        (self.results / "update.csv").write_text(UPDATE)

    def test_recovers_what_was_put_in(self):
        self.make_all()
        output = self.output_of("extremes", self.rays)
        found = {(row["axis"], float(row["value"]), row["method"]): float(row["error"]) for row in self.table("extremes.csv")}
        for key, error in {("unit", 1e-6, "ppm"): 0, ("unit", 1e6, "photonmapper"): 0.01, ("light", 100, "ppm"): 2.5e-4,
                           ("index", 1.5, "0.0001"): 5e-4, ("index", 4, "0.0001"): 0.01, ("index", 1.5, "1e-06"): 5e-5,
                           ("passes", 1e6, "program"): 3e-13, ("passes", 1e6, "float"): 5e-3}.items():
            self.assertAlmostEqual(found[key], error, delta=1e-6 if key[0] != "passes" else 1e-15, msg=str(key))
        said = [" ".join(line.split()) for line in output.splitlines()]
        for line in ["furnace, PPM: +0.125% ± 0.875% from exact", "unit PM right from 1e-06 to 1, then 1e+06: 0.01",
                     "light PPM right from 1 to 100, at most 0.00025", "index branches cut at $10^{-4}$ right from 1.5 to 1.5, then 4: 0.01",
                     "alpha printed update, float right from 0.7 to 0.7, at most 0.0005",
                     "passes printed update, float right from 1 to 1, then 1e+06: 0.005"]:
            self.assertIn(line, said)
        self.assert_drawn(output, "extremes")

    def test_right_range_is_around_the_plain_value(self):
        points = [(1, 0.0), (2, 0.5), (3, 1e-3), (4, 0.0), (5, float("nan")), (6, 0.0)]
        self.assertEqual(extremes.right_range(points, 4), (3, 4))
        self.assertEqual(extremes.right_range(points, 1), (1, 1))
        self.assertIsNone(extremes.right_range(points, 2))
        self.assertIsNone(extremes.right_range(points, 7))

    def test_disc_at_the_foot_has_its_expectation(self):
        # The mean of (1 + s^2)^(-3/2) over s^2, which is uniform in the disc, of 1 / (2 pi).
        squares = (numpy.arange(100_000) + 0.5) / 400_000
        self.assertAlmostEqual(extremes.foot_answer() * 2 * numpy.pi, numpy.mean((1 + squares) ** -1.5), delta=1e-9)

    def test_refuses_other_scenes_and_missing_ones(self):
        with self.assertRaisesRegex(files.InputError, "scene cornell-box: expected a variant"):
            extremes.axis_of("cornell-box")
        self.make(self.results, {("unit-10", "ppm", "0.0001"): [1.0]})
        self.assertIn("scene unit-10: expected unit-1 with the same seeds beside it", self.refusal_of("extremes", self.rays))
        self.make_all()
        (self.results / "update.csv").unlink()
        self.assertIn("update.csv: is not there", self.refusal_of("extremes", self.rays))


if __name__ == "__main__":
    unittest.main()
