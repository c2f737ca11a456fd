"""What each setting buys and costs: methods that change one setting of a method named `default` beside that.

The knobs are found from the records: they are the settings in which a method differs from its default, less what follows from
another one (hit points from samples a pixel, say). Ratios are taken over the seeds that both have, which are the same photons where
the setting leaves them the same. Standard errors are those of the jackknife over seeds, of ratios on logarithmic axes; intervals are
95% by Student's distribution.
"""

import math

import numpy
from scipy import stats

from photonlab.records import methods
from photonlab.records.columns import as_number
from photonlab.records.files import InputError
from photonlab.statistics.errors import error_column, last_pass, root, two_digits
from photonlab.statistics.jackknife import over_seeds

NAME = "tradeoff.csv"
DEFAULT = "default"
CLOCKS = {"seconds": "s", "cpu_seconds": "CPU s"}
RATIOS = ["error", "time"]
COLUMNS = ["scene", "point", "default", "knob", "value", "default_value", "seeds", "pass", "rmse", "rmse_error", "seconds",
           "seconds_error", *(f"{name}_ratio{part}" for name in RATIOS for part in ["", "_low", "_high"]), "pareto"]


def knobs_of(own, default, columns, settings):
    """{setting: (value, value of the default)} of what a method changes; both are rows of the records."""
    differing = [name for name in settings if own[name] != default[name]]
    return {name: (own[name], default[name]) for name in differing if not set(columns[name].follows) & set(differing)}


def shown_value(column, text):
    return column.shown(text) or "none"


def knob_text(knobs, columns):
    """ "k 480 for 120"."""
    return ", ".join(f"{columns.name_of(name)} {shown_value(columns[name], value)} for {shown_value(columns[name], before)}"
                     for name, (value, before) in knobs.items())


def root_of_mean(values):
    return root(values.mean())


def ratio_of(own, default, power):
    """(ratio of the means to a power, low, high), paired; NaN where a mean is not above 0."""
    def logarithm(x, y):
        return power * math.log(x.mean() / y.mean()) if x.mean() > 0 and y.mean() > 0 else math.nan
    found, error = over_seeds(logarithm, own, default)
    reach = stats.t.ppf(0.975, len(own) - 1) * error if len(own) > 1 else math.nan
    return math.exp(found), math.exp(found - reach), math.exp(found + reach)


def points_of(scene):
    """{name: rows of the last pass that all its seeds recorded, by seed} of what has errors; names without the scene's."""
    rows = scene.rows[(scene.rows["component"] == "total") & scene.rows["mse"].notna()]
    names = rows["run"].map(methods.point_of).str.removeprefix(f"{scene.scene}_")
    return {name: last_pass(own).set_index("seed").sort_index() for name, own in rows.groupby(names, sort=False)}


def defaults_of(points):
    return [name for name in points if name.startswith(DEFAULT)]


def table_of(scene, clock):
    """Rows of the table of one scene, the default first, then by knob and value."""
    points = points_of(scene)
    defaults = defaults_of(points)
    if not defaults:
        raise InputError(f"{scene.file}: scene {scene.scene} has no method named {DEFAULT} with errors; expected one to compare with")
    settings = methods.settings_of(scene.rows, scene.columns)
    table = []
    for name, own in points.items():
        knobs_by_default = {other: knobs_of(own.iloc[0], points[other].iloc[0], scene.columns, settings) for other in defaults}
        compared = name if name in defaults else min(defaults, key=lambda other: len(knobs_by_default[other]))
        table.append(row_of(scene, name, compared, points, knobs_by_default[compared], clock))
    for row in table:
        row["pareto"] = "yes" if row["rmse"] > 0 and not any(
            other["seconds"] <= row["seconds"] and other["rmse"] <= row["rmse"] and
            (other["seconds"], other["rmse"]) != (row["seconds"], row["rmse"]) for other in table) else ""
    return sorted(table, key=lambda row: (defaults.index(row["default"]), not is_default(row), row["knob"],
                                          as_number(row["value"]) or 0.0, row["value"]))


def row_of(scene, name, compared, points, knobs, clock):
    """The row of one point beside the default that it is compared with."""
    own, default = points[name], points[compared]
    error = error_column(scene.rows[(scene.rows["component"] == "total")])
    seeds = own.index.intersection(default.index)
    if not len(seeds):
        raise InputError(f"{scene.file}: {scene.scene}_{name} has no seed in common with {scene.scene}_{compared}")
    rmse, seconds = over_seeds(root_of_mean, own[error].to_numpy()), over_seeds(numpy.mean, own[clock].to_numpy())
    ratios = {"error": (1.0, 1.0, 1.0), "time": (1.0, 1.0, 1.0)}
    if name != compared:
        ratios = {ratio: ratio_of(own.loc[seeds, column].to_numpy(), default.loc[seeds, column].to_numpy(), power)
                  for ratio, column, power in [("error", error, 0.5), ("time", clock, 1.0)]}
    return {"scene": scene.scene, "point": name, "default": compared, "knob": ", ".join(knobs),
            "value": ", ".join(value for value, _ in knobs.values()),
            "default_value": ", ".join(before for _, before in knobs.values()), "seeds": len(seeds), "pass": int(own["pass"].iloc[0]),
            "rmse": rmse[0], "rmse_error": rmse[1], "seconds": seconds[0], "seconds_error": seconds[1],
            **{f"{ratio}_ratio{part}": number for ratio in RATIOS for part, number in zip(["", "_low", "_high"], ratios[ratio])},
            "text": knob_text(knobs, scene.columns),
            "shown": ", ".join(shown_value(scene.columns[name], value) for name, (value, _) in knobs.items())}


def is_default(row):
    return row["point"] == row["default"]


def ratio_text(row, name):
    """ "error ×0.71 (0.69 to 0.73)", or that there is no difference, or no ratio."""
    found, low, high = (row[f"{name}_ratio{part}"] for part in ["", "_low", "_high"])
    if math.isnan(found):
        return f"{name}: not resolved by this reference"
    if math.isnan(low):
        return f"{name} ×{found:.2f} (one seed, so no interval)"
    if low <= 1 <= high:
        return f"{name}: no difference that {row['seeds']} seeds can tell ({low:.2f} to {high:.2f})"
    return f"{name} ×{found:.2f} ({low:.2f} to {high:.2f})"


def sentence(row):
    """What a knob buys and costs, as a line of the list."""
    texts = [ratio_text(row, name) for name in RATIOS]
    if all("no difference" in text for text in texts):
        ranges = ", ".join(f"{name} ×{row[f'{name}_ratio_low']:.2f} to {row[f'{name}_ratio_high']:.2f}" for name in RATIOS)
        return f"{row['text'] or row['point']}: no difference that {row['seeds']} seeds can tell ({ranges})"
    return f"{row['text'] or row['point']}: {', '.join(texts)}"


def words(tables, clock, noise):
    """All scenes in Markdown: each default in numbers, then a line a method; those on the Pareto front are bold."""
    parts = ["# What each setting buys and costs", "", "RMSE and seconds of the last pass; ratios to the default with 95% intervals "
             "over paired seeds. Bold: on the Pareto front of its scene (nothing is both faster and more accurate). "
             + noise, ""]
    for table in tables:
        parts.append(f"## {table[0]['scene']}")
        for row in table:
            if is_default(row):
                count = row["seeds"]
                parts += ["", f"`{row['point']}`: RMSE {two_digits(row['rmse'])} after {two_digits(row['seconds'])} {CLOCKS[clock]}, "
                          f"{count} seed{'' if count == 1 else 's'}{'; on the front' if row['pareto'] else ''}.", ""]
            else:
                parts.append(f"- **{sentence(row)}**" if row["pareto"] else f"- {sentence(row)}")
        parts.append("")
    return "\n".join(parts)
