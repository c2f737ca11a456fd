"""Times to an error are those of the curves through the records, and what was not reached has none."""

import unittest

import numpy

from photonlab.records import columns, files
from photonlab.statistics import time_to_error
from support import stamps, synthetic
from support.in_folder import InFolder, run


class TimeTo(unittest.TestCase):
    def test_is_exact_on_a_power(self):
        times = numpy.array([1.0, 2, 4, 8, 16])
        time, at_first = time_to_error.time_to(times, 0.5 / times, 0.5 / 11)
        self.assertAlmostEqual(time, 11)
        self.assertFalse(at_first)

    def test_is_the_first_crossing(self):
        times, errors = numpy.array([1.0, 2, 4, 8]), numpy.array([1.0, 0.1, 0.4, 0.01])
        self.assertAlmostEqual(time_to_error.time_to(times, errors, 0.1)[0], 2)

    def test_a_curve_that_starts_below_has_the_first_time_and_one_that_stays_above_none(self):
        times = numpy.array([1.0, 2])
        self.assertEqual(time_to_error.time_to(times, numpy.array([0.05, 0.01]), 0.1), (1.0, True))
        self.assertIsNone(time_to_error.time_to(times, numpy.array([0.5, 0.2]), 0.1))


    def test_an_error_below_zero_is_met_on_a_straight_line(self):
        times, errors = numpy.array([1.0, 2, 4, 8]), numpy.array([0.1, 0.02, -1e-4, 0.001])
        self.assertAlmostEqual(time_to_error.time_to(times, errors, 0.01)[0], 2 * 2 ** (0.01 / 0.0201))


class Tables(InFolder):
    def times(self, relmse, *arguments, floor=1e-9, unbiased=None):
        """Of PPM with seeds 1 and 2; a pass takes a second, and two of the processor's."""
        made = synthetic.rows(lambda *_: 1e-4, seeds=[1, 2], floor=floor)
        for row in made:
            number = max(1, int(row["pass"]))
            row.update(seconds=str(number), cpu_seconds=str(2 * number),
                       relmse="0" if row["component"] == "emission" else str(relmse(int(row["seed"]), number)))
            if unbiased:
                row.update(relmse_unbiased="0" if row["component"] == "emission" else str(unbiased(int(row["seed"]), number)))
        synthetic.write_csv(self.results, made, [*synthetic.COLUMNS, "relmse_unbiased"] if unbiased else None)
        if unbiased:
            listed = [*files.read_json(columns.BEFORE_DESCRIPTIONS)["columns"],
                      {"name": "relmse_unbiased", "kind": "measure", "type": "number", "error": True}]
            stamps.write_with_checksum(self.results / "columns.json", {"schema": 1, "columns": listed})
        output = self.output_of("time_to_error", *arguments)
        rows = self.table("time-to-error.csv")
        self.assertNotIn("emission", {row["component"] for row in rows})
        return {(float(row["threshold"]), row["clock"]): row for row in rows if row["component"] == "total"}, output

    def test_a_method_has_the_mean_over_its_seeds_and_its_standard_error(self):
        table, output = self.times(lambda seed, number: seed / number)
        row = table[0.1, "seconds"]    # 10 and 20 seconds
        self.assertAlmostEqual(float(row["time"]), 15)
        self.assertAlmostEqual(float(row["time_error"]), 5)
        self.assertAlmostEqual(float(table[0.1, "cpu_seconds"]["time"]), 30)
        self.assertEqual((row["seeds"], row["seeds_there"], row["note"]), ("2", "2", ""))
        self.assertIn("time-to-error.pdf", output)

    def test_what_a_seed_does_not_reach_is_more_than_the_budget(self):
        table, _ = self.times(lambda seed, number: seed / number, "--thresholds", "0.02", "0.01")
        self.assertEqual((table[0.02, "seconds"]["time"], table[0.02, "seconds"]["note"]),
                         ("", "more than the budget for 1 of 2 seeds"))
        self.assertEqual((table[0.01, "seconds"]["time"], table[0.01, "seconds"]["note"]), ("", "more than the budget"))
        self.assertEqual(float(table[0.01, "cpu_seconds"]["budget"]), 128)

    def test_what_is_there_at_the_first_pass_took_at_most_that(self):
        table, _ = self.times(lambda seed, number: 0.05 / number)
        self.assertEqual((float(table[0.1, "seconds"]["time"]), table[0.1, "seconds"]["note"]),
                         (1.0, "at most, for 2 of 2 seeds: there at the first recorded pass"))

    def test_noise_of_the_reference_that_may_matter_is_noted(self):
        table, _ = self.times(lambda seed, number: seed / number, floor=5e-5)
        self.assertAlmostEqual(float(table[0.01, "seconds"]["floor_bound"]), 5e-3)
        self.assertIn("the reference's noise", table[0.01, "seconds"]["note"])
        self.assertNotIn("the reference's noise", table[0.1, "seconds"]["note"])

    def test_errors_that_are_free_of_the_references_noise_are_taken_where_they_are_recorded(self):
        table, _ = self.times(lambda seed, number: 0.05 + 1 / number, floor=5e-5, unbiased=lambda seed, number: 1 / number - 0.02)
        row = table[0.01, "seconds"]    # 1 / 0.03, between passes 32 and 64; below 0 by then
        self.assertTrue(32 < float(row["time"]) < 64)
        self.assertEqual((row["note"], row["error"]), ("", "relmse_unbiased"))

    def test_without_errors_there_are_no_times(self):
        synthetic.write_csv(self.results, synthetic.rows(lambda *_: 1e-4))
        output = self.output_of("time_to_error")
        self.assertIn("no relmse was recorded", output)

    def test_a_threshold_has_to_be_positive(self):
        self.assertEqual(run("time_to_error", self.results, "--thresholds", "0")[0], 2)


if __name__ == "__main__":
    unittest.main()
