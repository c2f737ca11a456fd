"""What each setting buys and costs: an experiment with a method that is named `default` and others that change one setting of it
each is turned into a table, a list in words and a figure per scene. There may be several defaults (`default-nearest`, say): a
method is compared with the one that it differs least from.

The knobs are found from the records: they are the settings in which a method differs from its default, less what follows from
another one (hit points from samples a pixel, say). Error is the RMSE of the last pass, the root of the mean over seeds of the
unbiased MSE of the whole picture; time is the mean over seeds of its seconds, by wall clock or, with --clock cpu_seconds, of the
processor, which other programs of a busy machine disturb less. Ratios to the default are taken over the seeds that
both have, which are the same photons where the setting leaves them the same. Standard errors are those of the jackknife over
seeds, of ratios on logarithmic axes; intervals are 95% by Student's distribution. Of many intervals one in twenty misses.

The figure draws error against seconds. A method is on the Pareto front when none is both faster and more accurate; neighbours on
it may be so by chance, which their error bars tell.
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import files
    import numpy
    import records
    import style
    import tables
    from decomposition import point_of
    from files import InputError
    from matplotlib import lines
    from scipy import stats
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)",
          file=sys.stderr)
    sys.exit(2)

DEFAULT = "default"
# A setting that follows from others: it is no knob where one of them has been turned.
FOLLOWS = {"radius_rule": ["radius_initial"], "caustic_radius": ["radius_initial", "footprints"],
           "caustic_max_radius": ["max_radius"], "hit_points": ["samples_per_pixel", "width", "height", "branch_cutoff"],
           "radius_initial": ["footprints", "samples_per_pixel", "width", "height", "branch_cutoff"]}
CLOCKS = {"seconds": "s", "cpu_seconds": "CPU s"}
RATIOS = ["error", "time"]
COLUMNS = ["scene", "point", "default", "knob", "value", "default_value", "seeds", "pass", "rmse", "rmse_error", "seconds", "seconds_error",
           *(f"{name}_ratio{part}" for name in RATIOS for part in ["", "_low", "_high"]), "pareto"]
BLACK = {"color": "black", "markersize": 8}
BLACK_MARKERS = [{"marker": "o"}, {"marker": "s"}, {"marker": "^"}]
FRONT = {"color": "#888888", "linewidth": 3, "alpha": 0.5, "zorder": 1}


def knobs_of(own, default, columns):
    """{setting: (value, value of the default)} of what a method changes; both are rows of the records."""
    differing = [column for column in columns if own[column] != default[column]]
    return {column: (own[column], default[column]) for column in differing
            if not any(cause in differing for cause in FOLLOWS.get(column, []))}


def shown_value(text):
    number = records.as_number(text)
    return "none" if text == "" else text if number is None or len(text) <= 7 else f"{number:.4g}"


def knob_text(knobs):
    """ "k 480 for 120"."""
    return ", ".join(f"{records.SETTING_NAMES.get(column, column.replace('_', ' '))} {shown_value(value)} for "
                     f"{shown_value(before)}" for column, (value, before) in knobs.items())


def jackknife(estimate, *samples):
    """(estimate of the samples, its standard error by leaving out each seed; NaN with a single one)."""
    count = len(samples[0])
    if count < 2:
        return estimate(*samples), math.nan
    left = numpy.array([estimate(*(numpy.delete(sample, place) for sample in samples)) for place in range(count)])
    return estimate(*samples), math.sqrt((count - 1) / count * ((left - left.mean()) ** 2).sum())


def root_of_mean(values):
    return records.root(values.mean())


def ratio_of(own, default, power):
    """(ratio of the means to a power, low, high), paired; NaN where a mean is not above 0."""
    def logarithm(x, y):
        return power * math.log(x.mean() / y.mean()) if x.mean() > 0 and y.mean() > 0 else math.nan
    found, error = jackknife(logarithm, own, default)
    reach = stats.t.ppf(0.975, len(own) - 1) * error if len(own) > 1 else math.nan
    return math.exp(found), math.exp(found - reach), math.exp(found + reach)


def last_rows(rows):
    """Rows of the last pass that all seeds recorded, by seed. `rows` are those of a point's total."""
    curve = records.aggregate_over_seeds(rows, "mse")
    return rows[rows["pass"] == curve.index.max()].set_index("seed").sort_index()


def table_of(file, scene, rows, columns, clock):
    """Rows of the table of one scene, the default first, then by knob and value."""
    rows = rows[(rows["component"] == "total") & rows["mse"].notna()]
    names = rows["run"].map(point_of).str.removeprefix(f"{scene}_")
    error = records.error_column(rows)
    points = {name: last_rows(own) for name, own in rows.groupby(names, sort=False)}
    defaults = [name for name in points if name.startswith(DEFAULT)]
    if not defaults:
        raise InputError(f"{file}: scene {scene} has no method named {DEFAULT} with errors; expected one to compare with")
    table = []
    for name, own in points.items():
        compared = name if name in defaults else min(
            defaults, key=lambda other: len(knobs_of(own.iloc[0], points[other].iloc[0], columns)))
        default = points[compared]
        knobs = knobs_of(own.iloc[0], default.iloc[0], columns)
        seeds = own.index.intersection(default.index)
        rmse, seconds = jackknife(root_of_mean, own[error].to_numpy()), jackknife(numpy.mean, own[clock].to_numpy())
        ratios = {"error": (1.0, 1.0, 1.0), "time": (1.0, 1.0, 1.0)}
        if name != compared:
            if not len(seeds):
                raise InputError(f"{file}: {scene}_{name} has no seed in common with {scene}_{compared}")
            ratios = {"error": ratio_of(own.loc[seeds, error].to_numpy(), default.loc[seeds, error].to_numpy(), 0.5),
                      "time": ratio_of(own.loc[seeds, clock].to_numpy(), default.loc[seeds, clock].to_numpy(), 1.0)}
        table.append({
            "scene": scene, "point": name, "default": compared, "knob": ", ".join(knobs), "value": ", ".join(value for value, _ in knobs.values()),
            "default_value": ", ".join(before for _, before in knobs.values()), "seeds": len(seeds), "pass": int(own["pass"].iloc[0]),
            "rmse": rmse[0], "rmse_error": rmse[1], "seconds": seconds[0], "seconds_error": seconds[1],
            **{f"{ratio}_ratio{part}": number for ratio in RATIOS for part, number in zip(["", "_low", "_high"], ratios[ratio])},
            "text": knob_text(knobs)})
    for row in table:
        row["pareto"] = "yes" if row["rmse"] > 0 and not any(
            other["seconds"] <= row["seconds"] and other["rmse"] <= row["rmse"] and
            (other["seconds"], other["rmse"]) != (row["seconds"], row["rmse"]) for other in table) else ""
    return sorted(table, key=lambda row: (defaults.index(row["default"]), not is_default(row), row["knob"],
                                          records.as_number(row["value"]) or 0.0, row["value"]))


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


def markdown(tables, clock, noise):
    """All scenes: each default in numbers, then a line a method; those on the Pareto front are bold."""
    parts = ["# What each setting buys and costs", "", "RMSE and seconds of the last pass; ratios to the default with 95% intervals "
             "over paired seeds. Bold: on the Pareto front of its scene (nothing is both faster and more accurate). "
             + noise, ""]
    for table in tables:
        parts.append(f"## {table[0]['scene']}")
        for row in table:
            if is_default(row):
                count = row["seeds"]
                parts += ["", f"`{row['point']}`: RMSE {style.two_digits(row['rmse'])} after {style.two_digits(row['seconds'])} {CLOCKS[clock]}, "
                          f"{count} seed{'' if count == 1 else 's'}{'; on the front' if row['pareto'] else ''}.", ""]
            else:
                parts.append(f"- **{sentence(row)}**" if row["pareto"] else f"- {sentence(row)}")
        parts.append("")
    return "\n".join(parts)


def draw_scene(table, clock, noise):
    """Error against seconds: a line a knob through the default, and the Pareto front under them. None when nothing is resolved."""
    table = [row for row in table if row["rmse"] > 0]
    if not table:
        return None
    style.use()
    defaults = {row["point"]: row for row in table if is_default(row)}
    knobs = list(dict.fromkeys((row["default"], row["knob"] or row["point"]) for row in table if not is_default(row)))
    looks = {knob: {"color": style.COLOURS[place % len(style.COLOURS)], "marker": style.MARKERS[place % len(style.MARKERS)],
                    "linestyle": "-" if knob[0] == DEFAULT else "--", "linewidth": 0.8} for place, knob in enumerate(knobs)}
    names = {knob: ", ".join(records.SETTING_NAMES.get(column, column.replace("_", " ")) for column in knob[1].split(", "))
             for knob in knobs}
    handles = [lines.Line2D([], [], label=names[knob] + (f" ({knob[0]})" if len(defaults) > 1 and knob[0] != DEFAULT else ""),
                            **looks[knob]) for knob in knobs]
    handles += [lines.Line2D([], [], label=name, linestyle="none", **BLACK, **BLACK_MARKERS[place % len(BLACK_MARKERS)])
                for place, name in enumerate(defaults)]
    handles.append(lines.Line2D([], [], label="Pareto front", **FRONT))
    figure, [[axes]] = style.panels_over_legend(1, 1, handles, "Bars: standard errors over seeds. A line joins the values of one "
                                                f"setting; the rest is as in its default. {noise}", panel_height=3.4)
    for knob in knobs:
        of_knob = [row for row in table if not is_default(row) and (row["default"], row["knob"] or row["point"]) == knob]
        line = sorted(of_knob + [defaults[name] for name in [knob[0]] if name in defaults],
                      key=lambda row: records.as_number(of_knob[0]["default_value"] if is_default(row) else row["value"]) or 0.0)
        axes.plot([row["seconds"] for row in line], [row["rmse"] for row in line],
                  **{**looks[knob], "marker": "none"})
        axes.errorbar([row["seconds"] for row in of_knob], [row["rmse"] for row in of_knob],
                      xerr=[numpy.nan_to_num(row["seconds_error"]) for row in of_knob],
                      yerr=[numpy.nan_to_num(row["rmse_error"]) for row in of_knob], **{**looks[knob], "linestyle": "none"})
        for row in of_knob:
            axes.annotate(shown_value(row["value"]), (row["seconds"], row["rmse"]), (4, 4), textcoords="offset points", fontsize=7,
                          color=looks[knob]["color"])
    for place, row in enumerate(defaults.values()):
        axes.errorbar(row["seconds"], row["rmse"], xerr=numpy.nan_to_num(row["seconds_error"]),
                      yerr=numpy.nan_to_num(row["rmse_error"]), zorder=4, **BLACK, **BLACK_MARKERS[place % len(BLACK_MARKERS)])
    front = sorted((row for row in table if row["pareto"]), key=lambda row: row["seconds"])
    axes.plot([row["seconds"] for row in front], [row["rmse"] for row in front], **FRONT)
    for axis, column in [(axes.xaxis, "seconds"), (axes.yaxis, "rmse")]:
        low, high = min(row[column] for row in table), max(row[column] for row in table)
        margin = max((high / low) ** 0.08, 1.1)
        style.logarithmic(axis, low / margin, high * margin)
    axes.set_xlabel(f"time of all passes ({CLOCKS[clock]})")
    axes.set_ylabel("RMSE (radiance)")
    axes.set_title(table[0]["scene"], loc="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/tradeoff.csv, tradeoff.md and figures/tradeoff-SCENE, .png and "
                                     ".pdf.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    parser.add_argument("--clock", choices=CLOCKS, default="seconds", help="what time is taken from (default: seconds)")
    options = parser.parse_args(arguments)
    results, clock = records.read(options.results), options.clock
    recorded = results.rows
    of_scenes = [table_of(results.file, scene, rows, records.settings_of(recorded), clock)
              for scene, rows in recorded.groupby("scene", sort=False)]
    print(tables.write_derived(results, "tradeoff.csv", COLUMNS, [row for table in of_scenes for row in table]))
    noise = records.noise_note(recorded[recorded["component"] == "total"])
    words = f"{markdown(of_scenes, clock, noise)}\n<!-- {style.RECORDS} {results.hash} -->\n"
    print(files.replace_file(results.folder / "tradeoff.md", words))
    for table in of_scenes:
        figure = draw_scene(table, clock, noise)
        if figure is None:
            print(f"{table[0]['scene']}: nothing is resolved, so there is nothing to draw")
            continue
        for file in style.save(figure, results.folder, f"tradeoff-{records.file_name(table[0]['scene'])}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
