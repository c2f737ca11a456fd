"""A table says what was written into it, and no cell of it is a formula."""

import csv
import unittest

from photonlab.records import files, kept_files, tables
from photonlab.records.files import InputError
from support.in_folder import InFolder

TEXTS = ["=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "\r=1", "'=1", "''=1", "'", "'quoted'", "-", "=", "--", "+-1", "-1", "+2.5e-3", "-nan",
         "-inf", "-1_000", "-0x10", "a,b", 'a"b', "a\nb", "a\rb", " =1", "", "plain", "α=1", "-1 ", "-1e", "=cmd|' /C calc'!A0"]


class Tables(InFolder):
    def setUp(self):
        super().setUp()
        self.file = self.results / "table.csv"

    def test_what_goes_in_comes_out(self):
        tables.write_table(self.file, ["text", "number"], [{"text": text, "number": -0.5, "other": 1} for text in TEXTS])
        table = tables.read_table(self.file)
        self.assertEqual(list(table.columns), ["text", "number"])
        self.assertEqual(list(table["text"]), TEXTS)
        self.assertEqual(set(table["number"]), {"-0.5"})

    def test_no_cell_but_a_number_begins_like_a_formula(self):
        tables.write_table(self.file, ["text", "number"], [{"text": text, "number": 1} for text in TEXTS])
        with open(self.file, newline="", encoding="utf-8") as stream:
            for cell, _ in csv.reader(stream):
                if cell[:1] in list("=+-@\t\r"):
                    self.assertTrue(cell.lower().lstrip("+-") in ["nan", "inf"] or isinstance(float(cell), float), cell)

    def test_numbers_are_as_they_were(self):
        tables.write_table(self.file, ["a", "b", "c", "d", "e"], [{"a": -1e-300, "b": float("nan"), "c": None, "d": "-0.1", "e": 3}])
        self.assertEqual(self.file.read_text(), "a,b,c,d,e\n-1e-300,,,-0.1,3\n")

    def refused(self, text, expected):
        self.file.write_text(text)
        with self.assertRaisesRegex(files.InputError, expected):
            tables.read_table(self.file)

    def test_what_is_no_table_is_refused_with_its_line(self):
        self.refused("a,b\n1,2\n3\n", "table.csv:3: has 1 fields; the header has 2")
        self.refused("a,a\n1,2\n", "table.csv: names a column twice")
        self.refused('a\n"1\n', "table.csv: is not a table in CSV: unexpected end of data")


class Unreadable:
    """A stream of a disk that fails."""

    def read(self, size):
        raise OSError(5, "Input/output error")

    def __next__(self):
        return self.read(1)


class Failures(unittest.TestCase):
    def test_what_cannot_be_read_is_named(self):
        for read in [lambda: kept_files.hash_of_stream("a.csv", Unreadable()), lambda: tables.table_in("a.csv", Unreadable())]:
            with self.assertRaisesRegex(InputError, "^a.csv: cannot be read: Input/output error$"):
                read()


if __name__ == "__main__":
    unittest.main()
