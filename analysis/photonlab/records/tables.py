"""Tables in CSV, as the program and the analysis write them.

A cell of text that a spreadsheet would take for a formula (a scene that is called `=1+1`) is written with an apostrophe before it,
and read without: whatever text goes in comes out.
"""

import csv
import math
import re
from dataclasses import dataclass

import pandas

from photonlab.records import files
from photonlab.records.files import InputError

RECORDS = "records"    # column of tables that are made from records
FORMULA = re.compile("'*[=+\\-@\t\r]")    # how a text begins that has an apostrophe more in the file
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(inf|nan)", re.IGNORECASE)


def in_file(value):
    """What the cell of a value is in the file. Empty for what there is not."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    is_formula = isinstance(value, str) and FORMULA.match(value) and not NUMBER.fullmatch(value)
    return f"'{value}" if is_formula else value


def from_file(text):
    return text[1:] if text.startswith("'") and FORMULA.match(text) else text


def read_table(file):
    with files.opened(file) as stream:
        return table_in(file, stream)


def table_in(file, stream):
    """A stream of the bytes of a CSV as a table of text."""
    return next(blocks_in(file, stream, None))


class Lines:
    """The lines of a stream as text, one at a time, with the bytes of those that were taken since they were last asked for."""

    def __init__(self, file, stream):
        self.file, self.stream = file, stream
        self.before, self.since = 0, b""    # bytes

    def __iter__(self):
        return self

    def __next__(self):
        try:
            line = next(self.stream)
        except OSError as error:
            raise InputError(f"{self.file}: cannot be read: {files.reason(error)}") from error
        try:
            text = line.decode("utf-8")
        except UnicodeDecodeError as error:
            raise InputError(f"{self.file}: is not text in UTF-8: byte {self.before + error.start + 1} is no part of it") from error
        self.before += len(line)
        self.since += line
        return text

    def taken(self):
        since, self.since = self.since, b""
        return since


def blocks_in(file, stream, rows_each, note=lambda row, data: None):
    """The same in blocks of so many rows, one after another, the first of which may be empty. Rows are counted on from block to
    block. `note` is told of each row, the header first, as a list of texts and as the bytes that it is. pandas would fill up a row
    that was cut, so the fields are counted here."""
    lines = Lines(file, stream)
    reader = csv.reader(lines, strict=True)
    header = next_row(file, reader) or []
    note(header, lines.taken())
    if not header:
        raise InputError(f"{file}: is not a table in CSV: it is empty")
    if len(set(header)) < len(header):
        raise InputError(f"{file}: names a column twice")
    first = 0
    while True:
        rows = []
        while (rows_each is None or len(rows) < rows_each) and (row := next_row(file, reader)) is not None:
            if len(row) != len(header):
                raise InputError(f"{file}:{reader.line_num}: has {len(row)} fields; the header has {len(header)}")
            data = lines.taken()
            note(row, data)
            if b"'" in data:
                row = [from_file(cell) for cell in row]
            rows.append(row)
        if not rows and first > 0:
            return
        table = pandas.DataFrame(rows, columns=header, dtype=str, index=pandas.RangeIndex(first, first + len(rows)))
        first += len(rows)
        yield table
        if rows_each is None or len(rows) < rows_each:
            return


def next_row(file, reader):
    """None behind the last."""
    try:
        return next(reader, None)
    except csv.Error as error:
        raise InputError(f"{file}: is not a table in CSV: {error}") from error


def write_table(file, columns, rows):
    """Replaces the file by a table of rows, which are dictionaries; what else they have is left out."""
    lines = [columns, *([in_file(row.get(column)) for column in columns] for row in rows)]
    return files.replace_file(file, "".join(",".join(map(quoted, line)) + "\n" for line in lines))


@dataclass
class Derived:
    """A table that is made of records: rows are dictionaries."""
    name: str
    columns: list
    rows: list


@dataclass
class Words:
    """What is said of records in a text of its own."""
    name: str
    text: str


def write_derived(results, table):
    """RESULTS/NAME: of a table with a column `records`, the hash of the records that the rows were made from. The folder's tables are
    of all scenes and methods: of a part of the records none is written."""
    if getattr(results, "is_part", False):
        return f"{table.name} is of all scenes and methods, so it is not written"
    if isinstance(table, Words):
        return files.replace_file(results.folder / table.name, table.text)
    return write_table(results.folder / table.name, [*table.columns, RECORDS], [{**row, RECORDS: results.hash} for row in table.rows])


def read_derived(results, name, columns, command):
    """The same, refused where it was made from other records than there are now. `command` makes it."""
    file = results.folder / name
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; run {command} first")
    table = read_table(file)
    require_columns(file, table, columns, f"run {command} again")
    if is_stale(table, results.hash):
        raise InputError(f"{file}: was made from other records than those in iterations.csv; run {command} again")
    return table


def is_stale(table, records):
    """True where a table does not say in every row that it was made from the records with this hash."""
    return not table.empty and (RECORDS not in table.columns or (table[RECORDS] != records).any())


def quoted(value):
    text = str(value)
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in ',"\r\n') else text


def place(file, wrong):
    """file:line of the first row that is wrong; the header is line 1."""
    return f"{file}:{wrong.index[wrong.to_numpy().argmax()] + 2}"


def to_numbers(file, texts, whole=False):
    """The column as numbers; NaN where it is empty."""
    numbers = pandas.to_numeric(texts, errors="coerce")
    wrong = numbers.isna() & ~texts.str.lower().isin(["", "nan", "-nan"])
    if whole:
        wrong |= numbers.notna() & ((numbers < 0) | (numbers % 1 != 0))
    if wrong.any():
        expected = "a whole number that is not negative" if whole else "a number"
        raise InputError(f"{place(file, wrong)}: {texts.name} is \"{texts[wrong].iloc[0]}\"; expected {expected}")
    return numbers.astype(float)


def require_columns(file, table, columns, advice):
    missing = [column for column in columns if column not in table.columns]
    if missing:
        raise InputError(f"{file}: lacks the columns {', '.join(missing)}; {advice}")
