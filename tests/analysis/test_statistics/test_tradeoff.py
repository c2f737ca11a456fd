"""Knobs are found from what differs, their ratios are those that were put in, and what seeds cannot tell is said so."""

import unittest

import numpy

from photonlab.statistics import tradeoff
from support import synthetic
from support.in_folder import InFolder

SEEDS = list(range(1, 9))


class Tradeoff(InFolder):
    def setUp(self):
        super().setUp()
        self.noise = numpy.random.default_rng(4).standard_normal(len(SEEDS) + 1)

    def write(self, methods, seeds=SEEDS):
        """`methods` by name: (settings, MSE by seed, seconds by seed) after pass 8; half of each after pass 4."""
        made = []
        for name, (settings, mse, seconds) in methods.items():
            for row in synthetic.rows(lambda seed, number, _: mse(seed) * 8 / max(1, number), seeds=seeds, passes=[0, 4, 8],
                                      **settings):
                row.update({"run": f"cornell-box_{name}_seed-{row['seed']}",
                            "seconds": str(seconds(int(row["seed"])) * int(row["pass"]) / 8),
                            "cpu_seconds": str(seconds(int(row["seed"])) * int(row["pass"]) / 8 + 1)})
                made.append(row)
        synthetic.write_csv(self.results, made)

    def tables(self, *options):
        output = self.output_of("tradeoff", *options)
        table = {row["point"]: row for row in self.table("tradeoff.csv")}
        return table, (self.results / "tradeoff.md").read_text(encoding="utf-8"), output

    def noisy(self, mean, share, turn=0):
        return lambda seed: mean * (1 + share * self.noise[(seed + turn) % len(SEEDS)])

    def methods(self):
        return {"default": ({"alpha": "0.7"}, self.noisy(4e-4, 0.1), self.noisy(2.0, 0.05)),
                # Half the MSE on the same photons, twice the time: pairs leave next to no interval.
                "more": ({"alpha": "0.9"}, self.noisy(2e-4, 0.1), self.noisy(4.0, 0.05)),
                # The same in the mean, but other photons.
                "eps": ({"eps": "0.5"}, self.noisy(4e-4, 0.1, turn=3), self.noisy(2.0, 0.05, turn=3)),
                "worse": ({"kernel": "cone"}, self.noisy(8e-4, 0.1), self.noisy(3.0, 0.05))}

    def test_knobs_are_what_differs_from_the_default(self):
        self.write(self.methods())
        table, words, output = self.tables()
        self.assertEqual({name: (row["knob"], row["value"], row["default_value"]) for name, row in table.items()},
                         {"default": ("", "", ""), "more": ("alpha", "0.9", "0.7"), "eps": ("eps", "0.5", "0"),
                          "worse": ("kernel", "cone", "disc")})
        self.assertIn("tradeoff-cornell-box.pdf", output)
        self.assertEqual(next(iter(table)), "default")

    def test_ratios_are_paired_and_of_the_last_pass(self):
        self.write(self.methods())
        table, words, _ = self.tables()
        for name, error, time in [("more", 0.5 ** 0.5, 2.0), ("worse", 2 ** 0.5, 1.5)]:
            for ratio, expected in [("error", error), ("time", time)]:
                for part in ["", "_low", "_high"]:
                    self.assertAlmostEqual(float(table[name][f"{ratio}_ratio{part}"]), expected, places=9)
        mean = numpy.mean([self.noisy(4e-4, 0.1)(seed) for seed in SEEDS])
        self.assertAlmostEqual(float(table["default"]["rmse"]), mean ** 0.5, places=9)
        self.assertEqual((table["default"]["pass"], table["default"]["seeds"]), ("8", "8"))
        self.assertIn("α 0.9 for 0.7: error ×0.71 (0.71 to 0.71), time ×2.00 (2.00 to 2.00)", words)

    def test_time_can_be_that_of_the_processor(self):
        self.write(self.methods())
        table, words, _ = self.tables("--clock", "cpu_seconds")
        mean = numpy.mean([self.noisy(4.0, 0.05)(seed) for seed in SEEDS])
        self.assertAlmostEqual(float(table["more"]["seconds"]), mean + 1)
        self.assertIn("CPU s, 8 seeds", words)

    def test_what_the_seeds_cannot_tell_is_no_difference(self):
        self.write(self.methods())
        table, words, _ = self.tables()
        self.assertLess(float(table["eps"]["error_ratio_low"]), 1)
        self.assertGreater(float(table["eps"]["error_ratio_high"]), 1)
        self.assertIn("eps 0.5 for 0: no difference that 8 seeds can tell (error ×0.", words)

    def test_standard_errors_are_those_of_means(self):
        self.write(self.methods())
        table, *_ = self.tables()
        seconds = numpy.array([self.noisy(2.0, 0.05)(seed) for seed in SEEDS])
        mse = numpy.array([self.noisy(4e-4, 0.1)(seed) for seed in SEEDS])
        self.assertAlmostEqual(float(table["default"]["seconds_error"]), seconds.std(ddof=1) / 8 ** 0.5)
        self.assertAlmostEqual(float(table["default"]["rmse_error"]) / (mse.std(ddof=1) / 8 ** 0.5 / 2 / mse.mean() ** 0.5), 1,
                               delta=0.02)

    def test_the_front_has_what_nothing_beats_in_both(self):
        self.write(self.methods())
        table, words, _ = self.tables()
        self.assertEqual((table["more"]["pareto"], table["worse"]["pareto"]), ("yes", ""))
        self.assertIn("- **α 0.9 for 0.7", words)
        self.assertIn("- kernel cone for disc", words)

    def test_of_several_defaults_a_method_has_the_nearest(self):
        nearest = {"integrator": "photonmapper", "mode": "nearest", "schedule": "", "alpha": "", "k": "120", "max_radius": "40"}
        self.write({**self.methods(), "default-nearest": (nearest, self.noisy(1e-4, 0.1), self.noisy(8.0, 0.05)),
                    "k": ({**nearest, "k": "60"}, self.noisy(4e-4, 0.1), self.noisy(4.0, 0.05))})
        table, words, _ = self.tables()
        self.assertEqual([(name, row["default"]) for name, row in table.items()],
                         [("default", "default"), ("more", "default"), ("eps", "default"), ("worse", "default"),
                          ("default-nearest", "default-nearest"), ("k", "default-nearest")])
        self.assertEqual((table["k"]["knob"], table["k"]["default_value"]), ("k", "120"))
        self.assertAlmostEqual(float(table["k"]["error_ratio"]), 2.0, places=9)
        self.assertIn("`default-nearest`: RMSE 0.01", words)
        self.assertIn("- k 60 for 120: error ×2.00 (2.00 to 2.00), time ×0.50 (0.50 to 0.50)", words)

    def test_what_follows_from_a_knob_is_none(self):
        self.write({"default": ({}, self.noisy(4e-4, 0.1), self.noisy(2.0, 0.05)),
                    "given": ({"radius_rule": "given", "radius_initial": "4", "caustic_radius": "4"}, self.noisy(4e-4, 0.1),
                              self.noisy(2.0, 0.05)),
                    "footprints": ({"footprints": "2", "radius_initial": "8", "caustic_radius": "8"}, self.noisy(4e-4, 0.1),
                                   self.noisy(2.0, 0.05)),
                    "samples": ({"samples_per_pixel": "4", "hit_points": "12288"}, self.noisy(4e-4, 0.1), self.noisy(2.0, 0.05))})
        table, words, _ = self.tables()
        self.assertEqual([table[name]["knob"] for name in ["given", "footprints", "samples"]],
                         ["radius_initial", "footprints", "samples_per_pixel"])
        self.assertIn("initial radius 4 for 12.35", words)

    def test_an_error_that_is_not_resolved_has_no_ratio(self):
        self.write({**self.methods(), "less": ({"alpha": "0.5"}, lambda seed: -1e-6, self.noisy(1.0, 0.05))})
        table, words, _ = self.tables()
        self.assertEqual((table["less"]["rmse"], table["less"]["error_ratio"], table["less"]["pareto"]), ("", "", ""))
        self.assertIn("α 0.5 for 0.7: error: not resolved by this reference, time ×0.50 (0.50 to 0.50)", words)

    def test_one_seed_has_no_intervals(self):
        self.write(self.methods(), seeds=[1])
        table, words, _ = self.tables()
        self.assertEqual(table["more"]["error_ratio_low"], "")
        self.assertIn("time ×2.00 (one seed, so no interval)", words)

    def test_without_a_default_there_is_nothing_to_compare_with(self):
        self.write({"more": ({}, lambda seed: 1e-4, lambda seed: 1.0)})
        self.assertIn("iterations.csv: scene cornell-box has no method named default", self.refusal_of("tradeoff"))


class Intervals(unittest.TestCase):
    def test_95_of_100_hold_the_ratio(self):
        """Of 1000 pairs of 8 seeds, with 4 standard errors; Student's interval of a logarithm is only nearly exact."""
        random, held = numpy.random.default_rng(8), 0
        for _ in range(1000):
            common = random.standard_normal(8)
            default = 1 + 0.1 * common + 0.05 * random.standard_normal(8)
            own = 2 * (1 + 0.1 * common + 0.05 * random.standard_normal(8))
            _, low, high = tradeoff.ratio_of(own, default, 1.0)
            held += low <= 2 <= high
        self.assertAlmostEqual(held / 1000, 0.95, delta=0.028)


if __name__ == "__main__":
    unittest.main()
