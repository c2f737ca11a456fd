"""Sets a table of the folder for a page: answers.csv, equal-time.csv, time-to-error.csv or any other that a command wrote, or the
errors of the last passes, in Markdown or in LaTeX.

Numbers have three digits. Columns that are empty are left out, and so are settings, which the method's name stands for; --columns
names those that are wanted.
"""

from photonlab import typesetting
from photonlab.command import Command
from photonlab.records import tables
from photonlab.records.columns import as_number
from photonlab.records.files import InputError
from photonlab.report.cells import three_digits

LEFT_OUT = ["experiment", "point", "threads", tables.RECORDS]


def shown(text):
    number = as_number(text)
    return text if number is None or len(text) <= 5 else three_digits(number)


def chosen_columns(table, results, wanted, file):
    if wanted:
        tables.require_columns(file, table, wanted, f"it has {', '.join(table.columns)}")
        return wanted
    left_out = {*LEFT_OUT, *results.columns.table_settings}
    return [name for name in table.columns if name not in left_out and (table[name] != "").any()]


def make(results, options):
    file = results.folder / options.file
    table = tables.read_table(file)
    if tables.is_stale(table, results.hash):
        raise InputError(f"{file}: was not made from the records in iterations.csv; run `photonlab analyse {results.folder}` again")
    for name, kept in [("scene", options.scenes), ("method", options.methods)]:
        if kept and name in table:
            known = set(results.rows[name])
            table = table[table[name].isin(known)]
    columns = chosen_columns(table, results, options.columns, file)
    rows = [[shown(text) for text in row] for row in table[columns].to_numpy()]
    yield typesetting.table(options.table, [name.replace("_", " ") for name in columns], rows)


def add_options(parser):
    parser.add_argument("--file", default="answers.csv", metavar="NAME", help="the table (default: answers.csv)")
    parser.add_argument("--columns", nargs="+", metavar="NAME", help="which columns, in this order")
    parser.add_argument("--table", choices=typesetting.KINDS, default="markdown", help="how it is set (default: markdown)")


COMMAND = Command(
    name="table", summary="a table of the folder in Markdown or LaTeX", about=__doc__, writes="nothing: the table is printed",
    make=make, is_for=lambda results: False, add_options=add_options)
