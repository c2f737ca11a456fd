"""Reads what runs recorded: iterations.csv into checked rows, rows into methods, methods into curves.

A method is a set of settings (integrator, alpha, radius, ...); runs that differ in nothing but their seed are
repetitions of one method. Passes of one run are cumulative, so a method's spread is taken over its seeds, never over
the passes of a run. Errors are combined as mean squared errors and rooted last: the root of a mean is what theory
predicts, and an unbiased MSE may be negative, where no root exists but a mean does.
"""

import math
from pathlib import Path

import files
import pandas
from files import InputError
from tables import place, read_table, require_columns, to_numbers

SCHEMA = "1"
COMPONENTS = ["total", "emission", "direct", "gathered"]

# What makes a method, in the order in which a label names it. The seed is not among them.
SETTINGS = ["integrator", "mode", "schedule", "alpha", "k", "radius_rule", "footprints", "radius_initial",
            "max_radius", "caustic_k", "caustic_radius", "caustic_max_radius", "kernel", "eps", "direct",
            "direct_samples", "max_depth", "branch_cutoff", "photons_per_pass", "width", "height",
            "samples_per_pixel", "hit_points", "threads"]
COUNTS = ["seed", "pass", "nonfinite"]
NUMBERS = ["seconds", "cpu_seconds", "mse", "mse_unbiased", "rmse", "relmse", "smape", "bias", "max_error",
           "reference_floor"]

# Every column of the contract. The other ones are carried along as text for whoever wants them.
COLUMNS = ["schema", "experiment", "run", "scene", *SETTINGS[:-1], "seed", "threads", "pass", "component",
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


def read_records(results):
    """Rows of RESULTS/iterations.csv: settings as the text they were written in, counts and measurements as numbers
    (NaN where the file has nothing), and the column `method` with the label of the row's method."""
    file = Path(results) / "iterations.csv"
    if not files.is_there(results) or not Path(results).is_dir():
        raise InputError(f"{results}: is not a folder; expected the results of `photonlab run`")
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected the records of `photonlab run`")
    records = read_table(file)
    check(file, records)
    for column in COUNTS + NUMBERS:
        records[column] = to_numbers(file, records[column], whole=column in COUNTS)
    if (records["pass"].isna() | records["seed"].isna()).any():
        raise InputError(f"{file}: has rows without pass or seed")
    check_settings(file, records)
    refuse_repeated_rows(file, records)
    records["method"] = method_labels(records)
    return records


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


def read_run(results, run):
    """run.json of a run, with what figures need checked."""
    file = Path(results) / "runs" / run / "run.json"
    record = files.read_json(file)
    snapshots = record.get("snapshots") if isinstance(record, dict) else None
    if not isinstance(snapshots, list) or not all(
            isinstance(snapshot, dict) and isinstance(snapshot.get("pass"), int) and
            isinstance(snapshot.get("file"), str) for snapshot in snapshots):
        raise InputError(f"{file}: expected \"snapshots\", a list of objects with \"pass\" and \"file\"")
    reference = record.get("reference")
    if reference is not None and not isinstance(reference.get("path") if isinstance(reference, dict) else None, str):
        raise InputError(f"{file}: expected \"reference\" to be null or an object with \"path\"")
    if not isinstance(record.get("working_directory", ""), str):
        raise InputError(f"{file}: expected \"working_directory\" to be a path")
    return record


def snapshot_files(results, run, record):
    """{pass: file} of the snapshots that a run kept and that are still there."""
    found = {snapshot["pass"]: Path(results) / "runs" / run / snapshot["file"] for snapshot in record["snapshots"]}
    return {number: file for number, file in found.items() if files.is_there(file)}


def reference_files(results, record):
    """The EXRs of a run's reference: two halves, one image, or none. A relative path is relative to the folder in which
    the run was started, which run.json records; where that is not there any more (the results came from
    another machine), to the folder of this one."""
    if record.get("reference") is None:
        return []
    path = record["reference"]["path"]
    for start in [record.get("working_directory") or ".", ".", results]:
        found = Path(start) / path
        halves = [found / "half_a.exr", found / "half_b.exr"]
        if all(files.is_there(half) for half in halves):
            return halves
        if files.is_there(found) and not found.is_dir():
            return [found]
    return []


def file_name(scene):
    """The scene's name as part of a file's name."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in scene)
