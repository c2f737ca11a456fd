"""Reads what runs recorded: iterations.csv into checked rows, rows into methods, methods into curves.

A method is a set of settings (integrator, alpha, radius, ...); runs that differ in nothing but their seed are
repetitions of one method. Passes of one run are cumulative, so a method's spread is taken over its seeds, never over
the passes of a run. Errors are combined as mean squared errors and rooted last: the root of a mean is what theory
predicts, and an unbiased MSE may be negative, where no root exists but a mean does.
"""

import math
import time
from dataclasses import dataclass, field
from pathlib import Path

import files
import kept_files
import pandas
import tables
from files import InputError
from tables import place, require_columns, to_numbers

SCHEMA = "1"
COMPONENTS = ["total", "emission", "direct", "gathered"]

# What makes a method, in the order in which a label names it. Neither the seed is among them nor the number of threads, which
# changes no result and may be another after a night on another machine.
SETTINGS = ["integrator", "mode", "schedule", "alpha", "k", "radius_rule", "footprints", "radius_initial",
            "max_radius", "caustic_k", "caustic_radius", "caustic_max_radius", "kernel", "eps", "direct",
            "direct_samples", "max_depth", "branch_cutoff", "photons_per_pass", "width", "height",
            "samples_per_pixel", "hit_points"]
TABLE_SETTINGS = [*SETTINGS, "threads"]    # what tables say of a method
COUNTS = ["seed", "pass", "nonfinite"]
NUMBERS = ["seconds", "cpu_seconds", "mse", "mse_unbiased", "rmse", "relmse", "smape", "bias", "max_error",
           "reference_floor"]

# Every column of the contract. The other ones are carried along as text for whoever wants them.
COLUMNS = ["schema", "experiment", "run", "scene", *SETTINGS, "seed", "threads", "pass", "component",
           "paths_emitted", "photons_stored", "photons_gathered", "seconds", "cpu_seconds", "seconds_trace",
           "seconds_build", "seconds_gather", "map_bytes", "hit_point_bytes", "peak_rss_mib", "radius_min",
           "radius_mean", "radius_max", "mse", "mse_unbiased", "rmse", "relmse", "smape", "bias", "max_error",
           "reference_floor", "nonfinite"]

INTEGRATOR_NAMES = {"photonmapper": "PM", "ppm": "PPM", "path": "path tracing"}
SETTING_NAMES = {"alpha": "α", "radius_initial": "initial radius", "max_radius": "maximum radius",
                 "caustic_k": "caustic k", "caustic_radius": "caustic radius",
                 "caustic_max_radius": "maximum caustic radius", "branch_cutoff": "branch cut-off",
                 "footprints": "radius in footprints",
                 "photons_per_pass": "photons a pass", "samples_per_pixel": "samples a pixel"}
LENGTHS = ["radius_initial", "max_radius", "caustic_radius", "caustic_max_radius"]    # in scene units
MODE_ORDER = ["radius", "nearest"]
BARE_SETTINGS = ["integrator", "mode", "schedule", "kernel"]    # their values say what they are


RUN_AGAIN = "run the experiment again, which makes nothing anew that is as it was"


@dataclass
class Records:
    """What a results folder holds: the rows of its runs, and what else each run left."""
    folder: Path
    rows: pandas.DataFrame    # settings as text, counts and measurements as numbers; `method` is the label of a row's method
    hash: str                 # of iterations.csv: what is drawn says by it which records it is of
    has_stamps: bool          # of a program that writes down what each file is (kept_files.py)
    rows_by_run: dict         # {run: hash of its own iterations.csv}; None where rows are no lines
    runs: dict = field(default_factory=dict)    # those that were asked for

    @property
    def file(self):
        return self.folder / "iterations.csv"

    def has_run(self, name):
        """False where run.json is not there: a run that is made again, or records that were copied without their runs."""
        return files.is_there(self.folder / "runs" / name / "run.json")

    def run(self, name):
        if name not in self.runs:
            self.runs[name] = read_run(self, name)
        return self.runs[name]


def read(results):
    """The records of a folder. Numbers are NaN where iterations.csv has nothing."""
    results = Path(results)
    if not files.is_there(results) or not results.is_dir():
        raise InputError(f"{results}: is not a folder; expected the results of `photonlab run`")
    file = results / "iterations.csv"
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected the records of `photonlab run`")
    data, has_stamps = read_merged(results, file.name)
    rows = tables.table_in(file, data)
    check(file, rows)
    require_own_folder(results, rows)
    for column in COUNTS + NUMBERS:
        rows[column] = to_numbers(file, rows[column], whole=column in COUNTS)
    if (rows["pass"].isna() | rows["seed"].isna()).any():
        raise InputError(f"{file}: has rows without pass or seed")
    check_settings(file, rows)
    refuse_repeated_rows(file, rows)
    rows["method"] = method_labels(rows)
    return Records(results, rows, kept_files.hash_of(data), has_stamps, hashes_by_run(data, rows["run"]))


def read_merged(results, name):
    """(bytes of a table that was merged from those of the runs, whether merged.json says what it is). The program replaces the table
    and merged.json one after the other, so what does not fit is read again. (src/experiment/merged_records.h)"""
    file, description = results / name, results / "merged.json"
    for attempt in range(5):
        data = files.read_bytes(file)
        if not files.is_there(description):
            return data, False
        merged = kept_files.read_json(description, RUN_AGAIN, must_be_checked=True)
        listed = merged.get("files") if isinstance(merged, dict) else None
        if not isinstance(listed, dict) or not isinstance(listed.get(name, []), list):
            raise InputError(f"{description}: expected \"files\", with a list by name; {RUN_AGAIN}")
        if {"bytes": len(data), "hash": kept_files.hash_of(data)} in listed.get(name, []):
            return data, True
        time.sleep(0.05 * attempt)
    raise InputError(f"{file}: is not what was merged from the runs: its checksum is another; {RUN_AGAIN}")


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


def hashes_by_run(data, runs):
    """{run: hash of the table that its rows are, header and all}; None where a row is not a line."""
    header, *lines = data.splitlines(keepends=True)
    if len(lines) != len(runs):
        return None
    hashes = {}
    for run, line in zip(runs, lines):
        if run not in hashes:
            hashes[run] = kept_files.running_hash(header)
        hashes[run].update(line)
    return {run: hashed.hexdigest() for run, hashed in hashes.items()}


def check(file, records):
    """Throws InputError unless the columns, the schema and the components are those of the contract."""
    require_columns(file, records, COLUMNS, f"expected those of schema {SCHEMA}")
    if records.empty:
        raise InputError(f"{file}: has no rows; has a run finished?")
    for column, known in [("schema", [SCHEMA]), ("component", COMPONENTS)]:
        unknown = ~records[column].isin(known)
        if unknown.any():
            raise InputError(f"{place(file, unknown)}: unknown {column} \"{records[column][unknown].iloc[0]}\"; "
                              f"known here: {', '.join(known)}")


def check_settings(file, records):
    """Throws InputError where a run changes its settings, or has an alpha, paths or a radius that it cannot have."""
    changing = (records.groupby("run")[SETTINGS].nunique() > 1).any(axis=1)
    if changing.any():
        raise InputError(f"{file}: run {changing.index[changing.to_numpy().argmax()]} has rows with different settings")
    alpha = to_numbers(file, records["alpha"])
    wrong = (alpha <= 0) | (alpha > 1) | ((records["integrator"] == "ppm") & alpha.isna())
    if wrong.any():
        raise InputError(f"{place(file, wrong)}: alpha is \"{records['alpha'][wrong].iloc[0]}\"; expected a number in (0, 1]")
    to_numbers(file, records["paths_emitted"], whole=True)
    wrong = to_numbers(file, records["radius_mean"]) <= 0
    if wrong.any():
        raise InputError(f"{place(file, wrong)}: radius_mean is \"{records['radius_mean'][wrong].iloc[0]}\"; expected a number "
                          "above 0")


def settings_of(records):
    """The columns of settings: SETTINGS and, of columns that are not in the contract, those that no row of a point changes (a
    point is a run without its seed), but some point does."""
    points = records["run"].str.rpartition("_seed-")[0].where(records["run"].str.contains("_seed-"), records["run"])
    return SETTINGS + [column for column in records.columns if column not in [*COLUMNS, "seconds_direct", "method"] and
                       records[column].nunique() > 1 and (records[column].groupby(points).nunique() == 1).all()]


def table_settings(rows):
    """{column: text} of what tables say of the method that these rows are of."""
    return {**rows.iloc[0][SETTINGS], "threads": ";".join(dict.fromkeys(rows["threads"]))}


def refuse_repeated_rows(file, records):
    repeated = records.duplicated(["scene", *settings_of(records), "seed", "pass", "component"])
    if repeated.any():
        row = records[repeated].iloc[0]
        raise InputError(f"{place(file, repeated)}: run {row['run']} repeats pass {row['pass']:.0f}, "
                          f"{row['component']}, of an earlier row with the same settings and seed")


def as_number(text):
    try:
        return float(text)
    except ValueError:
        return None


def setting_text(column, value):
    """How a label names a setting: "PPM", "α = 0.7", "max_depth = 5"."""
    if column == "integrator":
        return INTEGRATOR_NAMES.get(value, value)
    if column in BARE_SETTINGS:
        return value
    number = as_number(value)
    shown = value if number is None else f"{number:.4g}" if len(value) > 7 else value
    return f"{SETTING_NAMES.get(column, column.replace('_', ' '))} = {shown}"


def axis_text(column):
    """How an axis names a setting, with its unit: "α", "initial radius (scene units)"."""
    return SETTING_NAMES.get(column, column.replace("_", " ")) + (" (scene units)" if column in LENGTHS else "")


def method_labels(records):
    """A label for each row: the integrator, and those settings that take more than one value among the methods of some
    scene to which they apply. Where that leaves two methods of a scene with one label, what only one of them has is
    named as well."""
    settings = settings_of(records)
    methods = records[["scene", *settings]].drop_duplicates()

    def varying(groups, empty_counts):
        return {column for _, group in groups for column in settings
                if group[column][empty_counts | (group[column] != "")].nunique() > 1}

    def labels(columns):
        def label(row):
            return ", ".join(setting_text(column, row[column]) for column in settings
                             if column in columns and row[column] != "")
        return methods.apply(label, axis=1)

    named = {"integrator", "mode"} if methods["mode"].nunique() > 1 else {"integrator"}
    named |= varying(methods.groupby("scene"), empty_counts=False)
    # A sweep over given radii is named by the radii; the rule would say the same again.
    if "radius_initial" in named or "max_radius" in named:
        named.discard("radius_rule")
    # Neither do the radii and hit points that follow from settings.
    if "footprints" in named and (methods["radius_rule"] != "given").all():
        named.discard("radius_initial")
    if "branch_cutoff" in named:
        named.discard("hit_points")
    if ((methods["caustic_radius"] == "") | (methods["caustic_radius"] == methods["radius_initial"])).all():
        named.discard("caustic_radius")
    first = labels(named)
    clashes = [group for _, group in methods.groupby([methods["scene"], first]) if len(group) > 1]
    named |= varying(enumerate(clashes), empty_counts=True)
    methods = methods.assign(method=labels(named))
    return records.merge(methods, on=["scene", *settings], how="left")["method"].to_numpy()


def methods_in_order(records):
    """Labels in the order for legends and strips: by integrator as theory goes from PM to PPM, then by settings, as
    numbers where they are numbers."""
    def rank(value, order):
        return (order.index(value) if value in order else len(order), value)

    columns = settings_of(records)

    def key(item):
        settings = item[1]
        rest = []
        for column in columns[2:]:
            if column == "radius_rule":    # the radius itself orders better
                continue
            number = as_number(settings[column])
            rest.append((0, number, "") if number is not None else (-1 if settings[column] == "" else 1, 0.0,
                                                                    settings[column]))
        return (rank(settings["integrator"], list(INTEGRATOR_NAMES)), rank(settings["mode"], MODE_ORDER), rest)

    first_rows = records.drop_duplicates("method").set_index("method")
    return [label for label, _ in sorted(first_rows.iterrows(), key=key)]


def error_column(rows):
    """`mse_unbiased` where the reference has two halves, so that its own noise drops out; `mse` where it has not."""
    judged = rows["mse"].notna()
    return "mse_unbiased" if judged.any() and rows["mse_unbiased"][judged].notna().all() else "mse"


def error_name(column):
    """What the root of this column is called, where noise_note() stands beside it."""
    return "RMSE" if column == "mse_unbiased" else "RMSE with noise"


def noise_note(rows):
    """What an RMSE of these rows holds, as a sentence; "" where there is none."""
    judged = rows[rows["mse"].notna()]
    columns = {error_column(own) for _, own in judged.groupby(["scene", "component"])}
    return {frozenset(): "", frozenset(["mse_unbiased"]): "RMSE is without the reference's noise.",
            frozenset(["mse"]): "RMSE holds the reference's noise, since it has no second half.",
            }.get(frozenset(columns), "RMSE is without the reference's noise, or named with it: that reference has no second half.")


def aggregate_over_seeds(rows, column):
    """A method's curve: by pass, how many seeds recorded it, the mean of their seconds, and the mean, least and largest
    of their `column`. `rows` are those of one scene, component and method. A pass that only some of the seeds
    recorded is left out: a mean over other seeds would be a step in the curve."""
    passes = rows.groupby("pass")
    curve = pandas.DataFrame({
        "seeds": passes.size(),
        "seconds": passes["seconds"].mean(),
        # A NaN (no finite pixel was left) stays one: the mean of the other seeds would hide it.
        "mean": passes[column].agg(lambda values: values.mean(skipna=False)),
        "least": passes[column].agg(lambda values: values.min(skipna=False)),
        "largest": passes[column].agg(lambda values: values.max(skipna=False)),
    })
    return curve[curve["seeds"] == rows["seed"].nunique()]


def root(mean_squared_error):
    """RMSE of an MSE; NaN for 0 and below, which is less than what the reference can resolve."""
    return math.sqrt(mean_squared_error) if mean_squared_error > 0 else math.nan


@dataclass
class Run:
    """What a run left beside its rows."""
    folder: Path
    description: dict    # run.json
    snapshots: dict      # {pass: file}


@dataclass
class Reference:
    """What a run was judged by."""
    path: str
    halves: list    # the EXRs of two halves, or of one image; none where it cannot be used
    why_not: str    # it cannot be


def read_run(records, name):
    """A run with what figures need checked."""
    folder = records.folder / "runs" / name
    file = folder / "run.json"
    advice = f"move {folder} away and run the experiment again, which makes this run alone anew"
    description = kept_files.read_json(file, advice, must_be_checked=records.has_stamps)
    snapshots = description.get("snapshots") if isinstance(description, dict) else None
    if not isinstance(snapshots, list) or not all(
            isinstance(snapshot, dict) and isinstance(snapshot.get("pass"), int) and
            isinstance(snapshot.get("file"), str) for snapshot in snapshots):
        raise InputError(f"{file}: expected \"snapshots\", a list of objects with \"pass\" and \"file\"")
    check_reference(file, description)
    by_pass = {snapshot["pass"]: snapshot["file"] for snapshot in snapshots}
    listed = description.get("files")
    if listed is None and not records.has_stamps:
        found = {number: folder / name for number, name in by_pass.items()}
        return Run(folder, description, {number: file for number, file in found.items() if files.is_there(file)})
    if not isinstance(listed, dict):
        raise InputError(f"{file}: expected \"files\", the bytes and hash of each file of the run")
    own_rows = kept_files.kept_file(folder / "iterations.csv", listed.get("iterations.csv"), advice)
    if records.rows_by_run and records.rows_by_run[name] != own_rows.hash:
        raise InputError(f"{records.file}: the rows of {name} are of another making of this run than what is in {folder}; {RUN_AGAIN}")
    return Run(folder, description, {number: kept_files.kept_file(folder / name, listed.get(name), advice)
                                     for number, name in by_pass.items()})


def check_reference(file, description):
    """Throws InputError unless a description in JSON names its reference as reference_of() needs it."""
    reference = description.get("reference")
    if reference is not None and not (isinstance(reference, dict) and isinstance(reference.get("path"), str) and
                                      isinstance(reference.get("key", ""), str)):
        raise InputError(f"{file}: expected \"reference\" to be null or an object with \"path\"")
    if not isinstance(description.get("working_directory", ""), str):
        raise InputError(f"{file}: expected \"working_directory\" to be a path")


def reference_of(records, description):
    """What a run.json or ensemble.json names as its reference; None where it names none. A relative path is relative to the folder
    in which the run was started, which is named too; where that is not there any more (the results came from another machine), to
    the folder of this one."""
    named = description.get("reference")
    if named is None:
        return None
    path, key = named["path"], named.get("key")
    for start in [description.get("working_directory") or ".", ".", records.folder]:
        found = Path(start) / path
        halves = [found / "half_a.exr", found / "half_b.exr"]
        if all(files.is_there(half) for half in halves):
            return reference_of_halves(path, found, halves, key)
        if files.is_there(found) and not found.is_dir():
            with files.opened(found) as stream:
                is_same = key is None or kept_files.hash_of_stream(stream) == key
            return Reference(path, [found] if is_same else [], "" if is_same else IS_ANOTHER)
    return Reference(path, [], "is not there")


IS_ANOTHER = "is another one than the errors in the records are against"


def reference_of_halves(path, folder, halves, key):
    """The halves with the checksums in reference.json, if that is of the reference with this key, or it is not known which."""
    file = folder / "reference.json"
    if not files.is_there(file):
        return Reference(path, halves, "") if key is None else Reference(path, [], "has no reference.json")
    description = files.read_json(file)
    checksums = description.get("checksums") if isinstance(description, dict) else None
    if not isinstance(checksums, dict) or not all(isinstance(checksums.get(half.stem), str) for half in halves):
        raise InputError(f"{file}: expected \"checksums\" of half_a and half_b")
    if key is not None and f"{description.get('key')}-{description.get('samples_per_half')}" != key:
        return Reference(path, [], IS_ANOTHER)
    advice = "bring the reference back as it was, or make it anew"
    return Reference(path, [kept_files.KeptFile(half, None, checksums[half.stem], advice) for half in halves], "")


def file_name(scene):
    """The scene's name as part of a file's name."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in scene)
