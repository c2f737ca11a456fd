"""Whether the records of an experiment are still what they were when its numbers were taken.

Beside each experiment's file in experiments/replications stands NAME.csv, a table of the records that its runs leave in small
(`photonlab run --smoke`): of each column that is a setting or a measure, and no time and no memory, the checksum of all its values in
the order of runs, passes and components, and the mean of its numbers. columns.json says which columns these are. Columns that the
program has now and the table has not are no difference.

The checksums are of bits, which processors of one kind have in common; another kind rounds otherwise here and there. Then the means
tell: they differ from a 10,000th on where the program does something else, and by less where a processor does. What that leaves open is
said.
"""

from dataclasses import dataclass

import numpy
import pandas

from photonlab.records import kept_files, tables

COLUMNS = ["column", "checksum", "mean"]
MEMORY = ["bytes", "MiB"]    # units of what a library or a machine decides
CLOSE = 1e-4                 # of a mean: less than that is rounding
SAME, CLOSE_ENOUGH, OTHER = "the same bits", "the same numbers, other bits", "other numbers"


def compared_columns(described):
    """The names of columns that a checksum is of."""
    return [column.name for column in described if column.kind in ["setting", "measure"] and column.unit not in MEMORY]


def table_of(records):
    """The rows of the table of these records, from the lines as they were written."""
    texts = tables.read_table(records.file)
    order = texts.assign(number=texts["pass"].astype(int)).sort_values(["run", "number", "component"], kind="stable").index
    rows = []
    for name in compared_columns(records.columns):
        if name not in texts:
            continue
        column = texts[name][order]
        numbers = pandas.to_numeric(column, errors="coerce").to_numpy(dtype=float)
        known = numbers[numpy.isfinite(numbers)]
        rows.append({"column": name, "checksum": kept_files.hash_of("\n".join(column).encode()),
                     "mean": f"{known.mean():.9g}" if len(known) else ""})
    return rows


@dataclass(frozen=True)
class Comparison:
    state: str
    differing: list    # sentences, one a column

    def __str__(self):
        return self.state + (": " + "; ".join(self.differing) if self.differing else "")


def compared(kept, now):
    """The table that was kept beside that of now, both as rows."""
    by_name = {row["column"]: row for row in now}
    differing, state = [], SAME
    for row in kept:
        found = by_name.get(row["column"])
        if found is None:
            state, said = OTHER, "is no column any more"
        elif found["checksum"] == row["checksum"]:
            continue
        else:
            is_close = are_close(row["mean"], found["mean"])
            state = OTHER if not is_close or state == OTHER else CLOSE_ENOUGH
            said = f"has the mean {found['mean'] or 'none'}, had {row['mean'] or 'none'}"
        differing.append(f"{row['column']} {said}")
    return Comparison(state, differing)


def are_close(kept, found):
    """Whether two means are one but for rounding. Without a number there is nothing that could be rounded."""
    if not kept or not found:
        return False
    kept, found = float(kept), float(found)
    return abs(found - kept) <= CLOSE * max(abs(kept), abs(found))


def read(file):
    table = tables.read_table(file)
    tables.require_columns(file, table, COLUMNS, "make it anew with --keep")
    return table.to_dict("records")


def write(file, rows):
    return tables.write_table(file, COLUMNS, rows)
