"""The rows of docs/replications/README.md and their code say the same: numbers, verdicts, and what they are made from."""

import re
import unittest

import numpy

from support import ROOT

from photonlab.records import tables
from photonlab.replications import claims, variants
from photonlab.replications.claims import Value
from photonlab.replications.rows import PROGRAMS, ROWS
from photonlab.replications.values import Made

VERDICTS = [claims.HELD, claims.IN_PART, claims.DID_NOT_HOLD, claims.CANNOT_TELL]
PAGE = (ROOT / "docs/replications/README.md").read_text(encoding="utf-8")
TRIED, _, NOT_TRIED = PAGE.partition("## Not tried yet")


def rows_of_page():
    """{number: cells} of the rows that were tried."""
    lines = [line for line in TRIED.splitlines() if re.match(r"\| \d+ \|", line)]
    return {int(cells[0]): cells for cells in ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)}


def stands_in(text, cell):
    """Whether the text is in the cell, and no part of a longer number."""
    return re.search(rf"(?<![\d.]){re.escape(text)}(?!\.?\d)", cell) is not None


class RowsOfThePage(unittest.TestCase):
    def test_all_that_were_tried_have_code_and_are_twenty_at_least(self):
        self.assertEqual(set(rows_of_page()), set(ROWS))
        self.assertGreaterEqual(len(ROWS), 20)

    def test_numbers_that_are_compared_are_those_of_the_page(self):
        compared = 0
        for number, cells in rows_of_page().items():
            for name, found in (ROWS[number].numbers or {}).items():
                if found.stated is not None:
                    self.assertTrue(stands_in(found.stated, cells[5]), f"row {number}, {name}: {found.stated} is not in: {cells[5]}")
                    self.assertIsNotNone(claims.STATED.search(found.stated))
                    compared += 1
        self.assertGreater(compared, 100)

    def test_verdicts_are_those_of_the_page(self):
        for number, cells in rows_of_page().items():
            said = max((verdict for verdict in VERDICTS if cells[6].startswith(verdict)), key=len, default=cells[6])
            self.assertEqual(ROWS[number].verdict, said, f"row {number}")

    def test_what_rows_are_made_from_is_there_and_named_by_the_page(self):
        for number, row in ROWS.items():
            self.assertTrue(row.sources or row.test, number)
            for source in row.sources:
                if source not in PROGRAMS:
                    self.assertTrue((ROOT / "experiments" / f"{source}.toml").exists(), source)
            for name in {number.made for number in (row.numbers or {}).values()} - {None}:
                self.assertIn(name, row.sources)

    def test_experiments_have_checksums(self):
        for source in {source for row in ROWS.values() for source in row.sources} - set(PROGRAMS):
            file = ROOT / "experiments/replications" / f"{source.split('/')[-1]}.csv"
            self.assertTrue(file.exists(), f"{file}: experiments/replications/run --keep")

    def test_experiments_of_this_folder_are_needed_by_rows_and_can_be_written_again(self):
        needed = {source for row in ROWS.values() for source in row.sources}
        for file in (ROOT / "experiments/replications").glob("*.toml"):
            self.assertTrue(f"replications/{file.stem}" in needed or f"`replications/{file.stem}`" in NOT_TRIED, file)
        for file in (ROOT / "experiments").rglob("*.toml"):
            experiment = variants.read(file)
            self.assertEqual(variants.tomllib.loads(variants.written(experiment)), experiment)


class Claims(unittest.TestCase):
    def test_numbers_are_told_apart_beyond_two_standard_errors(self):
        self.assertIs(claims.less(Value(0.9, 0.04), 1), True)
        self.assertIsNone(claims.less(Value(0.9, 0.06), 1))
        self.assertIs(claims.less(Value(1.2, 0.06), 1), False)
        self.assertIs(claims.less(Value(1.0, 0.03), Value(1.1, 0.03)), True)
        self.assertIsNone(claims.less(Value(1.0, 0.04), Value(1.1, 0.04)))
        self.assertIs(claims.less(0.99, 1), True)    # without an error it is as it is
        self.assertIsNone(claims.less(Value(float("nan"), 0.1), 1))

    def test_numbers_of_numpy_are_told_apart_as_well(self):
        one = Value(numpy.float64(1.0), numpy.float64(0.01))
        self.assertEqual(claims.verdict(claims.less(one, numpy.float64(2)), claims.near(one, numpy.float64(1))), claims.HELD)
        self.assertEqual(claims.verdict(claims.less(numpy.float64(2), one)), claims.DID_NOT_HOLD)

    def test_what_is_near_is_within_its_error_or_the_tolerance(self):
        self.assertIs(claims.near(Value(0.7, 0.05), 0.79), True)
        self.assertIs(claims.near(Value(0.7, 0.04), 0.79), False)
        self.assertIs(claims.near(Value(0.7, 0.04), 0.79, 0.1), True)
        self.assertIsNone(claims.near(Value(float("nan")), 1))

    def test_a_verdict_is_of_all_claims(self):
        self.assertEqual(claims.verdict(True, True), claims.HELD)
        self.assertEqual(claims.verdict(True, False), claims.IN_PART)
        self.assertEqual(claims.verdict(True, None), claims.IN_PART)
        self.assertEqual(claims.verdict(False, None), claims.DID_NOT_HOLD)
        self.assertEqual(claims.verdict(None, None), claims.CANNOT_TELL)

    def test_numbers_of_the_page_are_read(self):
        for text, value, error, half_digit in [("box 0.69 ± 0.01", 0.69, 0.01, 0.005), ("46%", 0.46, None, 0.005), ("7.5", 7.5, None, 0.05),
                                               ("PPM -0.192 (-0.203 to -0.181)", -0.192, 0.022 / 3.92, 0.0005),
                                               ("disc 3.8e-6", 3.8e-6, None, 0.05e-6)]:
            found, half = claims.stated(text)
            self.assertAlmostEqual(found.value, value)
            self.assertAlmostEqual(half, half_digit)
            if error is not None:
                self.assertAlmostEqual(found.error, error)
        found, half = claims.stated("k 30: 8.5", 1e-3)
        self.assertAlmostEqual(found.value, 8.5e-3)
        self.assertAlmostEqual(half, 0.05e-3)

    def test_a_number_agrees_by_its_digits_or_within_both_errors(self):
        self.assertEqual(claims.agreement(Value(0.6949, 0.02), "0.69 ± 0.01"), claims.AS_STATED)
        self.assertEqual(claims.agreement(Value(0.72, 0.02), "0.69 ± 0.01"), claims.WITHIN_ERROR)
        self.assertEqual(claims.agreement(Value(0.79, 0.02), "0.69 ± 0.01"), claims.OFF)
        self.assertEqual(claims.agreement(Value(0.79, 0.05), "0.69"), claims.WITHIN_ERROR)    # the page's error is taken to be ours
        self.assertEqual(claims.agreement(Value(0.79), "0.69"), claims.OFF)
        self.assertEqual(claims.agreement(Value(0.75), "0.69"), claims.WITHIN_ERROR)          # neither has one: a tenth
        self.assertEqual(claims.agreement(Value(0.79), None), claims.NOT_STATED)


class KeptSlopes(unittest.TestCase):
    """Rows whose tables of slopes are kept beside their pages come to the numbers and the verdicts of the page."""
    NUMBERS = ["slope", "low", "high", "predicted", "predicted_edge", "seeds"]
    KEPT = {"pm-vs-ppm": "pm-vs-ppm/fits.csv", "paper-2011": "paper-2011/fits.csv", "point-light": "point-light/fits.csv",
            "replications/point-light-again": "point-light/fits-seeds-101-164.csv"}

    def made(self, source):
        file = ROOT / "docs" / self.KEPT[source]
        made = Made(file.parent)
        made.fits = tables.read_table(file)    # in place of what is computed
        for column in self.NUMBERS:
            made.fits[column] = tables.to_numbers(file, made.fits[column])
        return made

    def test_are_those_of_the_page(self):
        for number in [2, 7, 8, 9, 10, 11]:
            row, found = ROWS[number], {}
            for name, wanted in row.numbers.items():
                found[name] = wanted.take(self.made(wanted.made or row.made))
                if wanted.stated:
                    self.assertEqual(claims.agreement(found[name], wanted.stated), claims.AS_STATED, f"row {number}, {name}: {found[name]}")
            self.assertEqual(row.claims(found), row.verdict, f"row {number}")


if __name__ == "__main__":
    unittest.main()
