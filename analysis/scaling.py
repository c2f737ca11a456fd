"""How cost grows: seconds and memory of a pass against its photons and its hit points, with one thread and two, and memory
against passes, PPM beside PM.

    python3 analysis/scaling.py RESULTS_DIR --run build/release/src/app/photonlab

makes the records first, RESULTS_DIR/scaling.csv: the Cornell box, one setting at a time from 100,000 paths a pass and 256 x 256
hit points with an initial radius of 5.55. Each row is a run (or, against passes, what a run was at a pass), with seconds by the
pass. PM is there only against passes: it keeps every photon, so its memory is the photons' and their index' of all passes, while
PPM keeps those of one. Without --run an older scaling.csv is drawn.

`exponent` in the list that is printed is the slope on logarithmic axes from a tenth of the largest value (or from what is next
to that) to the largest: 1 is proportional, 0 is constant.
"""

import argparse
import math
import subprocess
import sys
from pathlib import Path

try:
    import files
    import kept_files
    import style
    import tables
    from files import InputError
    from matplotlib import lines
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and matplotlib (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-matplotlib)", file=sys.stderr)
    sys.exit(2)

SCENE = Path(__file__).resolve().parents[1] / "scenes/cornell-box/scene.xml"
STAGES = ["trace", "build", "gather", "direct"]
SECONDS = ["seconds", "cpu_seconds", *(f"seconds_{stage}" for stage in STAGES)]
BYTES = ["map_bytes", "hit_point_bytes"]
COLUMNS = ["axis", "value", "integrator", "threads", "passes", "photons_per_pass", "hit_points", "photons_stored", *SECONDS, *BYTES,
           "peak_rss_mib"]
MEBIBYTE = 2 ** 20
BOX = {"--radius": "5.55", "--resolution": "256x256", "--photons": "100000"}
# axis, value, passes, options; each with one thread and two.
RUNS = [("photons", photons, passes, {**BOX, "--photons": str(photons)})
        for photons, passes in [(10 ** 4, 16), (10 ** 5, 16), (10 ** 6, 4), (10 ** 7, 1)]]
RUNS += [("hit_points", side * side, passes, {**BOX, "--resolution": f"{side}x{side}"})
         for side, passes in [(100, 16), (316, 16), (1000, 4)]]
PASSES = {"--radius": "20", "--resolution": "48x48", "--photons": "500", "--passes": "10000"}
TWO_INTEGRATORS = ["ppm", "photonmapper"]
LOOKS = {1: {"color": style.COLOURS[0], "marker": "o", "label": "1 thread"},
         2: {"color": style.COLOURS[1], "marker": "s", "label": "2 threads"},
         "ppm": {"color": style.COLOURS[2], "marker": "^", "label": "PPM"},
         "photonmapper": {"color": style.COLOURS[3], "marker": "D", "linestyle": style.LINES["photonmapper radius"], "label": "PM"}}
GUIDE = {"color": "#999999", "linestyle": (0, (1, 1.5)), "linewidth": 1, "zorder": 1}


def render(program, folder, options):
    """The rows of component total of one run of the program."""
    table = folder / "run.csv"
    command = [str(program), "render", str(SCENE), "-o", str(folder / "run.exr"), "--csv", str(table),
               *(word for option in options.items() for word in option)]
    print(" ".join(command), flush=True)
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise InputError(f"{' '.join(command)}: {done.stderr.strip()}")
    rows = tables.read_table(table)
    return rows[rows["component"] == "total"].to_dict("records")


def row_of(axis, value, run):
    """A row of scaling.csv from one of iterations.csv."""
    passes = int(run["pass"])
    return {"axis": axis, "value": value, "integrator": run["integrator"], "threads": run["threads"], "passes": passes,
            **{column: run[column] for column in ["photons_per_pass", "hit_points", "photons_stored", *BYTES, "peak_rss_mib"]},
            **{column: float(run[column]) / passes for column in SECONDS}}


def make(program, results):
    results.mkdir(parents=True, exist_ok=True)
    table = []
    for axis, value, passes, options in RUNS:
        for threads in [1, 2]:
            run = render(program, results, {**options, "--passes": str(passes), "--threads": str(threads)})[-1]
            table.append(row_of(axis, int(run["hit_points"]) if axis == "hit_points" else value, run))
    for integrator in TWO_INTEGRATORS:
        runs = render(program, results, {**PASSES, "--integrator": integrator, "--threads": "1"})
        table += [row_of("passes", int(run["pass"]), run) for run in runs if int(run["pass"]) > 0]
    tables.write_table(results / "scaling.csv", COLUMNS, table)
    for name in ["run.csv", "run.exr"]:
        (results / name).unlink()


def read(file):
    """The rows of scaling.csv, numbers as numbers."""
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected what --run PROGRAM makes")
    table = tables.read_table(file)
    tables.require_columns(file, table, COLUMNS, "make it anew with --run")
    for column in COLUMNS:
        if column not in ["axis", "integrator"]:
            table[column] = tables.to_numbers(file, table[column])
    return table


def curve(table, axis, column, **chosen):
    """[(value, column)] of one line, by value."""
    rows = table[table["axis"] == axis]
    for name, wanted in chosen.items():
        rows = rows[rows[name] == wanted]
    return sorted(zip(rows["value"], rows[column]))


def exponent(points):
    """The slope on logarithmic axes over the last decade of values; NaN with fewer than two."""
    if len(points) < 2:
        return math.nan
    x1, y1 = points[-1]
    x0, y0 = min(points[:-1], key=lambda point: abs(math.log(10 * point[0] / x1)))
    if min(y0, y1) <= 0:
        return math.nan
    return math.log(y1 / y0) / math.log(x1 / x0)


def statements(table):
    """What the records say, a line each."""
    said = []
    for axis, unit in [("photons", "photons a pass"), ("hit_points", "hit points")]:
        for threads in [1, 2]:
            points = curve(table, axis, "seconds", threads=threads)
            if points:
                value, seconds = points[-1]
                said.append(f"{value:.0f} {unit}, {threads} thread{'s' * (threads > 1)}: {seconds:.3g} s a pass, exponent "
                            f"{exponent(points):.2f}")
        one, two = (dict(curve(table, axis, "seconds", threads=threads)) for threads in [1, 2])
        said += [f"{value:.0f} {unit}: two threads are {one[value] / two[value]:.2f} times as fast as one"
                 for value in sorted(set(one) & set(two))]
    for integrator in TWO_INTEGRATORS:
        points = curve(table, "passes", "map_bytes", integrator=integrator)
        resident = curve(table, "passes", "peak_rss_mib", integrator=integrator)
        if len(points) > 1:
            said.append(f"{LOOKS[integrator]['label']}, {points[0][0]:.0f} to {points[-1][0]:.0f} passes: map from "
                        f"{points[0][1] / MEBIBYTE:.3g} to {points[-1][1] / MEBIBYTE:.3g} MiB, exponent {exponent(points):.2f}; process "
                        f"from {resident[0][1]:.0f} to {resident[-1][1]:.0f} MiB")
    return said


def draw(table):
    style.use()
    handles = [lines.Line2D([], [], **look) for look in LOOKS.values()]
    handles.append(lines.Line2D([], [], label="proportional", **GUIDE))
    figure, grid = style.panels_over_legend(
        2, 2, handles, "Cornell box; upper row and lower left: PPM from 100,000 photon paths a pass and 256 x 256 hit points. Memory is "
        "photons with their index, at their largest so far.", panel_height=2.0)

    def panel(axes, label, drawn):
        for look, points in drawn:
            axes.plot(*zip(*points), **LOOKS[look])
        every = [point for _, points in drawn for point in points]
        style.logarithmic(axes.xaxis, min(x for x, _ in every) / 1.3, max(x for x, _ in every) * 1.3)
        axes.set_xlabel(label)
        return every

    def seconds(axis):
        return [(threads, points) for threads in [1, 2] if (points := curve(table, axis, "seconds", threads=threads))]

    def mebibytes(axis, name, values):
        return [(value, [(x, y / MEBIBYTE) for x, y in points]) for value in values
                if (points := curve(table, axis, "map_bytes", **{name: value}))]

    every = panel(grid[0][0], "photon paths a pass", seconds("photons"))
    every += panel(grid[0][1], "hit points", seconds("hit_points"))
    limits(grid[0][0], every, "seconds a pass")
    every = panel(grid[1][0], "photon paths a pass", mebibytes("photons", "threads", [1, 2]))
    every += panel(grid[1][1], "passes (500 paths each)", mebibytes("passes", "integrator", TWO_INTEGRATORS))
    limits(grid[1][0], every, "photon map (MiB)")
    for axes in grid.flat:
        (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        # From the upper right corner down, and from the middle of the left side up.
        axes.plot([low, high], [top * low / high, top], **GUIDE)
        axes.set_xlim(low, high)
        axes.set_ylim(bottom, top)
    return figure


def limits(axes, every, label):
    style.logarithmic(axes.yaxis, min(y for _, y in every) / 1.3, max(y for _, y in every) * 1.3)
    axes.set_ylabel(label)


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/scaling.csv (with --run) and figures/scaling.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of scaling.csv")
    parser.add_argument("--run", metavar="PROGRAM", type=Path, help="make the records first, with this photonlab")
    chosen = parser.parse_args(arguments)
    if chosen.run:
        make(chosen.run, chosen.results)
    file = chosen.results / "scaling.csv"
    table = read(file)
    print("\n".join(statements(table)))
    for file in style.save(draw(table), chosen.results, "scaling", kept_files.hash_of(files.read_bytes(file))):
        print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
