"""Reads what runs recorded: iterations.csv into checked rows, each with the label of its method (methods.py).

Runs that differ in nothing but their seed are repetitions of one method. In `rows` settings stay text, as they were written; measures
and times are numbers, NaN where there is nothing. `frame` is the same for a notebook: all that is a number is one, and its units are
there.
"""

import contextlib
import fnmatch
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy
import pandas

from photonlab.records import columns, files, kept_files, methods, runs, tables
from photonlab.records.files import InputError
from photonlab.records.tables import place, to_numbers

SCHEMA = "1"
COMPONENTS = ["total", "emission", "direct", "gathered"]
ROWS_A_BLOCK = 5_000
COUNTED = ["seed", "pass"]    # identities that are numbers


@dataclass
class Records:
    """What a results folder holds: the rows of its runs, and what else each run left."""
    folder: Path
    columns: columns.Columns
    rows: pandas.DataFrame    # settings as text, counts and measurements as numbers; `method` is the label of a row's method
    labels: list              # of the methods, in the order for legends
    hash: str                 # of iterations.csv: what is drawn says by it which records it is of
    has_stamps: bool          # of a program that writes down what each file is (kept_files.py)
    rows_by_run: dict         # {run: hash of its own iterations.csv}
    is_part: bool = False     # of what the folder has: tables of it are not the folder's
    runs: dict = field(default_factory=dict)    # those that were asked for

    @property
    def file(self):
        return self.folder / "iterations.csv"

    @property
    def scene(self):
        """The name of the scene, of records of one."""
        return self.rows["scene"].iloc[0]

    def scenes(self):
        """The records of each scene."""
        return [self.of_rows(rows) for _, rows in self.rows.groupby("scene", sort=False)]

    @property
    def frame(self):
        """The rows as a tidy table: one row a run, recorded pass and component. Numbers are numbers, what does not apply is missing,
        and `frame.attrs["units"]` has the unit of each column that has one."""
        frame = self.rows.drop(columns=methods.GIVEN).copy()
        for column in self.columns:
            if column.type != "text" and frame[column.name].dtype == object:
                frame[column.name] = pandas.to_numeric(frame[column.name], errors="coerce")
            elif column.kind == "setting":
                frame[column.name] = frame[column.name].where(frame[column.name] != "")
        frame["method"] = pandas.Categorical(frame["method"], self.labels, ordered=True)
        frame.attrs["units"] = {column.name: column.unit for column in self.columns if column.unit and column.name in frame}
        return frame

    def scene_named(self, name):
        """The records of one scene."""
        return self.only([name]).scenes()[0]

    def only(self, scenes=None, labels=None):
        """The records of these scenes and methods alone; * stands for anything. Throws InputError where there are none."""
        rows = self.rows
        for option, column, wanted in [("--scenes", "scene", scenes), ("--methods", "method", labels)]:
            known = list(dict.fromkeys(rows["scene"])) if column == "scene" else self.labels
            for pattern in wanted or []:
                if pattern not in known and not fnmatch.filter(known, pattern):
                    raise InputError(f"{option} {pattern}: {self.file} has no such {column}; expected one of {'; '.join(known)}")
            if wanted:
                kept = {name for pattern in wanted for name in known if name == pattern or fnmatch.fnmatchcase(name, pattern)}
                rows = rows[rows[column].isin(kept)]
        if rows.empty:
            raise InputError(f"{self.file}: no scene has these methods")
        return self if rows is self.rows else replace(self.of_rows(rows), is_part=True)

    def of_rows(self, rows):
        """The records of these rows alone."""
        present = set(rows["method"])
        return replace(self, rows=rows, labels=[label for label in self.labels if label in present])

    def of_method(self, label):
        return self.rows[self.rows["method"] == label]

    def has_run(self, name):
        """False where run.json is not there: a run that is made again, or records that were copied without their runs."""
        return files.is_there(self.folder / "runs" / name / "run.json")

    def run(self, name):
        if name not in self.runs:
            self.runs[name] = runs.read_run(self, name)
        return self.runs[name]


def read(results):
    """The records of a folder."""
    results = Path(results)
    if not files.is_there(results) or not results.is_dir():
        raise InputError(f"{results}: is not a folder; expected the results of `photonlab run`")
    file = results / "iterations.csv"
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected the records of `photonlab run`")
    described = columns.read_columns(results)
    by_run = HashesByRun()
    with opened_merged(results, file.name) as (stream, hashed, has_stamps):
        rows = read_rows(file, stream, described, by_run.add)
    require_own_folder(results, rows)
    rows[methods.GIVEN] = methods.given_names(rows, described)
    check_settings(file, rows, described)
    refuse_repeated_rows(file, rows, described)
    rows["method"] = methods.method_labels(rows, described)
    return Records(results, described, rows, methods.methods_in_order(rows, described), hashed, has_stamps, by_run.hexdigests())


def read_rows(file, stream, described, note):
    """All rows, checked. They are read in blocks: as text a row takes ten times the memory that it takes once its numbers are."""
    blocks, known = [], {}
    for block in tables.blocks_in(file, stream, ROWS_A_BLOCK, note):
        block = with_all_columns(file, block, described)
        check(file, block)
        blocks.append(with_texts_once(with_numbers(file, block, described), known))
    return pandas.concat(blocks)


def with_texts_once(rows, known):
    """The table with each text that is in `known` as it is there: in memory once, whatever number of rows has it. Others are added."""
    texts = [name for name in rows if rows[name].dtype == object]
    return rows.assign(**{name: [known.setdefault(text, text) for text in rows[name]] for name in texts})


def with_all_columns(file, rows, described):
    """The table with the columns that are described but not in it, as their descriptions say; and with those that older results
    had, so that each which the analysis knows by name is there."""
    required = [name for name in described.of_kind("identity") if not described[name].default]
    tables.require_columns(file, rows, required, f"expected those of schema {SCHEMA}")
    for column in [*described, *columns.before_descriptions()]:
        if column.name not in rows:
            applies = rows["integrator"].isin(column.used_by) if column.used_by and "integrator" in rows else True
            rows = rows.assign(**{column.name: numpy.where(applies, column.default, "")})
    return rows


def with_numbers(file, rows, described):
    """The table with measures and times as numbers, NaN where there are none."""
    numbers = {}
    for column in [*columns.before_descriptions(), *described]:
        if column.name in COUNTED or (column.kind in ["measure", "time"] and column.type != "text"):
            numbers[column.name] = to_numbers(file, rows[column.name], whole=column.type == "integer")
    rows = rows.assign(**numbers)
    if (rows["pass"].isna() | rows["seed"].isna()).any():
        raise InputError(f"{file}: has rows without pass or seed")
    require_radii(file, rows)
    return rows


@contextlib.contextmanager
def opened_merged(results, name):
    """A table that was merged from those of the runs: (a stream of its bytes, their hash, whether merged.json says what it is). The
    program replaces the table and merged.json one after the other, so what does not fit is opened again; what is open stays what it
    is when it is replaced. (src/record/merged_records.h)"""
    file, description = results / name, results / "merged.json"
    for attempt in range(5):
        with files.opened(file) as stream:
            hashed, size = kept_files.hash_of_stream(file, stream), stream.tell()
            stream.seek(0)
            is_described = files.is_there(description)
            if not is_described or {"bytes": size, "hash": hashed} in listed_in(description, name):
                yield stream, hashed, is_described
                return
        time.sleep(0.05 * attempt)
    raise InputError(f"{file}: is not what was merged from the runs: its checksum is another; {kept_files.RUN_AGAIN}")


def listed_in(description, name):
    """What merged.json says of a table: its bytes and hash, of this merging and the one that it replaces."""
    merged = kept_files.read_json(description, kept_files.RUN_AGAIN, must_be_checked=True)
    listed = merged.get("files") if isinstance(merged, dict) else None
    if not isinstance(listed, dict) or not isinstance(listed.get(name, []), list):
        raise InputError(f"{description}: expected \"files\", with a list by name; {kept_files.RUN_AGAIN}")
    return listed.get(name, [])


def require_own_folder(results, rows):
    """Throws InputError where the folder says that it is another experiment's than the rows."""
    file = results / "experiment.json"
    if not files.is_there(file):
        return
    description = files.read_json(file)
    owner = description.get("experiment") if isinstance(description, dict) else None
    other = rows["experiment"] != owner
    if other.any():
        raise InputError(f"{place(results / 'iterations.csv', other)}: is of the experiment {rows['experiment'][other].iloc[0]}; "
                         f"experiment.json says that the folder is that of {owner}")


class HashesByRun:
    """The hash of the table that the rows of each run are, header and all, from all rows one by one."""

    def __init__(self):
        self.place, self.header, self.hashes = None, b"", {}

    def add(self, row, data):
        if self.place is None:    # the header
            self.header, self.place = data, row.index("run") if "run" in row else -1
        elif self.place >= 0:
            name = tables.from_file(row[self.place])
            if name not in self.hashes:
                self.hashes[name] = kept_files.running_hash(self.header)
            self.hashes[name].update(data)

    def hexdigests(self):
        return {run: hashed.hexdigest() for run, hashed in self.hashes.items()}


def check(file, rows):
    """Throws InputError unless there are rows, and the schema and the components are those of the contract."""
    if rows.empty:
        raise InputError(f"{file}: has no rows; has a run finished?")
    for column, known in [("schema", [SCHEMA]), ("component", COMPONENTS)]:
        unknown = ~rows[column].isin(known)
        if unknown.any():
            raise InputError(f"{place(file, unknown)}: unknown {column} \"{rows[column][unknown].iloc[0]}\"; "
                             f"known here: {', '.join(known)}")


def check_settings(file, rows, described):
    """Throws InputError where a run changes its settings, or has an alpha that it cannot have."""
    number, _ = pandas.factorize(rows["run"])
    _, first = numpy.unique(number, return_index=True)    # row of each run
    for name in [*described.settings, "scene", methods.GIVEN]:
        column = rows[name].to_numpy()
        changing = column != column[first[number]]
        if changing.any():
            raise InputError(f"{file}: run {rows['run'].iloc[changing.argmax()]} has rows with different settings")
    alpha = to_numbers(file, rows["alpha"])
    wrong = (alpha <= 0) | (alpha > 1)
    if wrong.any():
        raise InputError(f"{place(file, wrong)}: alpha is \"{rows['alpha'][wrong].iloc[0]}\"; expected a number in (0, 1]")


def require_radii(file, rows):
    """Throws InputError where a radius is none: slopes are predicted from their logarithms."""
    wrong = rows["radius_mean"] <= 0
    if wrong.any():
        raise InputError(f"{place(file, wrong)}: radius_mean is \"{rows['radius_mean'][wrong].iloc[0]:g}\"; expected a number above 0")


def refuse_repeated_rows(file, rows, described):
    repeated = rows.duplicated(["scene", *methods.settings_of(rows, described), methods.GIVEN, "seed", "pass", "component"])
    if repeated.any():
        row = rows[repeated].iloc[0]
        raise InputError(f"{place(file, repeated)}: run {row['run']} repeats pass {row['pass']:.0f}, "
                         f"{row['component']}, of an earlier row with the same settings and seed")
