"""How long methods take to a given error: seconds to a relMSE of 0.1, 0.01 and 0.001, by wall clock and by processor, for every
scene, component and method.

A seed's curve is followed from pass to pass, with straight lines on logarithmic axes, to where it first comes down to the
threshold. A seed that is there at its first pass already took "at most" that pass: it is given the first pass's time, and the
note says for how many. A method is given the mean over its seeds with its standard error, and none if a seed never got there:
"more than the budget", with the time that was spent as `budget`.

relMSE is taken against the mean of the reference's halves. The noise of that mean is in it and cannot be subtracted, as it can
from MSE: no method comes below the mean of its variance / (r^2 + 0.01), which is at most `reference_floor` / 0.01 (that of a black
picture). This is the column `floor_bound`. Where it is a tenth of a threshold or more, times may be too long by the noise, and
the note says so.
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
    from matplotlib import lines
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and matplotlib (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-matplotlib)", file=sys.stderr)
    sys.exit(2)

CLOCKS = {"seconds": "wall clock", "cpu_seconds": "processor"}
COLUMNS = ["scene", "component", "method", "threshold", "clock", "seeds", "seeds_there", "time", "time_error", "budget",
           "floor_bound", "note"]
MORE = "more than the budget"
RELMSE_OFFSET = 0.01    # of relMSE = mean of (x - r)^2 / (r^2 + 0.01)


def time_to(times, errors, threshold):
    """(time at which the curve first comes down to the threshold, whether it was there at its first point); None when it never
    does. Both arrays are in the order of the passes."""
    there = numpy.flatnonzero(errors <= threshold)
    if not len(there):
        return None
    last = there[0]
    if last == 0:
        return times[0], True
    x, y = numpy.log(times[last - 1:last + 1]), numpy.log(numpy.maximum(errors[last - 1:last + 1], 1e-300))
    return math.exp(x[0] + (x[1] - x[0]) * (math.log(threshold) - y[0]) / (y[1] - y[0])), False


def row_of(rows, threshold, clock):
    """What a method's seeds took: the columns from `seeds` on. `rows` are those of one scene, component and method, by pass."""
    found, budgets = [], []
    for _, seed in rows.groupby("seed"):
        times, errors = seed[clock].to_numpy(), seed["relmse"].to_numpy()
        found.append(time_to(times, errors, threshold))
        budgets.append(times[-1])
    there = [one for one in found if one is not None]
    bound = rows["reference_floor"].max() / RELMSE_OFFSET
    notes = []
    row = {"seeds": len(found), "seeds_there": len(there), "budget": float(numpy.mean(budgets)),
           "floor_bound": "" if math.isnan(bound) else float(bound)}
    if len(there) < len(found):
        notes.append(MORE + (f" for {len(found) - len(there)} of {len(found)} seeds" if there else ""))
    else:
        times = numpy.array([time for time, _ in there])
        row["time"] = float(times.mean())
        row["time_error"] = float(times.std(ddof=1) / math.sqrt(len(times))) if len(times) > 1 else ""
        early = sum(at_first for _, at_first in there)
        if early:
            notes.append(f"at most, for {early} of {len(there)} seeds: there at the first recorded pass")
    if bound >= threshold / 10:
        notes.append("the reference's noise may be a tenth of the threshold or more")
    return {**row, "note": "; ".join(notes)}


def table_of(recorded, labels, thresholds):
    """Rows of the table. Components that no method has an error in (emission) are left out."""
    judged = recorded[(recorded["pass"] > 0) & recorded["relmse"].notna() & (recorded["seconds"] > 0)]
    table = []
    for (scene, component), rows in judged.groupby(["scene", "component"], sort=False):
        if (rows["relmse"] == 0).all():
            continue
        for label in labels:
            own = rows[rows["method"] == label].sort_values("pass")
            for threshold in thresholds if not own.empty else []:
                for clock in CLOCKS:
                    table.append({"scene": scene, "component": component, "method": label, "threshold": threshold,
                                  "clock": clock, **row_of(own, threshold, clock)})
    return table


def draw(recorded, table, labels):
    """Time against threshold, a row a scene and a column a clock, of the whole picture; None when nothing was reached."""
    whole = [row for row in table if row["component"] == "total"]
    reached = [row for row in whole if "time" in row]
    if not reached:
        return None
    style.use()
    scenes = list(dict.fromkeys(row["scene"] for row in whole))
    styles = style.method_styles(recorded, labels)
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels]
    figure, grid = style.panels_over_legend(
        len(scenes), len(CLOCKS), handles, "Whole picture. Means over seeds with standard errors; arrows: more than the budget, "
        "which is where they start. relMSE holds the reference's noise.")
    thresholds = [row["threshold"] for row in whole]
    for scene, panels in zip(scenes, grid):
        of_scene = [row for row in whole if row["scene"] == scene]
        times = [row.get("time", row["budget"]) for row in of_scene]
        for clock, axes in zip(CLOCKS, panels):
            for place, label in enumerate(labels):
                own = [row for row in of_scene if (row["method"], row["clock"]) == (label, clock)]
                shift = 1.03 ** (place - (len(labels) - 1) / 2)    # so that arrows do not hide each other
                there = [row for row in own if "time" in row]
                axes.errorbar([row["threshold"] * shift for row in there], [row["time"] for row in there],
                              yerr=[row["time_error"] or 0.0 for row in there], **styles[label])
                for row in own:
                    if "time" not in row:
                        axes.annotate("", (row["threshold"] * shift, row["budget"] * 1.5),
                                      (row["threshold"] * shift, row["budget"]),
                                      arrowprops={"arrowstyle": "->", "color": styles[label]["color"]})
            style.logarithmic(axes.yaxis, min(times) / 1.5, max(times) * 2)
            style.logarithmic(axes.xaxis, min(thresholds) / 2, max(thresholds) * 2)
            axes.invert_xaxis()
            axes.set_title(CLOCKS[clock], loc="right")
            axes.set_xlabel("relMSE to be reached")
        panels[0].set_title(scene, loc="left")
        panels[0].set_ylabel("time (s)")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/time-to-error.csv and figures/time-to-error, .png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    parser.add_argument("--thresholds", type=style.positive, nargs="+", default=[1e-1, 1e-2, 1e-3], metavar="RELMSE",
                        help="errors to be reached (default: 0.1 0.01 0.001)")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    recorded = results.rows
    labels = records.methods_in_order(recorded)
    table = table_of(recorded, labels, sorted(set(options.thresholds), reverse=True))
    if not table:
        print(f"{results.folder}: no relmse was recorded (was there a reference?), so no times")
        return 0
    print(tables.write_derived(results, "time-to-error.csv", COLUMNS, table))
    figure = draw(recorded, table, labels)
    if figure is None:
        print(f"{results.folder}: no method reached a threshold, so there is nothing to draw")
        return 0
    for file in style.save(figure, results.folder, "time-to-error", results.hash):
        print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
