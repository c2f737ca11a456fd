"""How cost grows: seconds and memory of a pass against its photons, its hit points and the scene's triangles, with one thread and
two, memory against passes, PPM beside PM, and what more cores would do.

    /usr/bin/python3 tests/benchmarks/meshes.py results/meshes --triangles 1000,10000,100000,1000000,10000000
    /usr/bin/python3 analysis scaling RESULTS --run build/release/src/app/photonlab --meshes results/meshes

makes the records first, RESULTS/scaling.csv: the Cornell box, one setting at a time from 100,000 paths a pass and 256 x 256
hit points with an initial radius of 5.55, and the scenes ply-N.xml of that folder. Each row is a run (or, against passes, what a
run was at a pass), with seconds by the pass. PM is there only against passes: it keeps every photon, so its memory is the photons'
and their index' of all passes, while PPM keeps those of one. Without --run an older scaling.csv is drawn.

More cores are not measured but computed, from a pass with one thread and with two: what did not become shorter stays, and the rest
is divided by the cores (Amdahl 1967). What two threads cost each other by sharing the memory counts as what does not become
shorter, so a machine whose memory keeps up with its cores does better.

`exponent` in the list that is printed is the slope on logarithmic axes from a tenth of the largest value (or from what is next
to that) to the largest: 1 is proportional, 0 is constant.
"""

import math
import subprocess
from pathlib import Path

from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import one_table, style
from photonlab.drawing.panels import panels_over_legend
from photonlab.drawing.saving import Drawn
from photonlab.records import columns, files, tables
from photonlab.records.files import InputError

SCENE = Path(__file__).resolve().parents[3] / "scenes/cornell-box/scene.xml"
STAGES = ["trace", "build", "gather", "direct"]
SECONDS = ["seconds", "cpu_seconds", *(f"seconds_{stage}" for stage in STAGES)]
BYTES = ["map_bytes", "hit_point_bytes"]
NAME = "scaling.csv"
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
PASSES_OF = ["ppm", "photonmapper"]    # integrators
THREADS = {1: "1 thread", 2: "2 threads"}
CORES = [1, 2, 4, 8, 16, 32, 64]
GUIDE = {"color": "#999999", "linestyle": (0, (1, 1.5)), "linewidth": 1, "zorder": 1}


def render(program, folder, options, scene=SCENE):
    """The rows of component total of one run of the program."""
    table = folder / "run.csv"
    command = [str(program), "render", str(scene), "-o", str(folder / "run.exr"), "--csv", str(table),
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


def scenes_by_triangles(folder):
    """{how many: scene file} of what meshes.py left there."""
    return {int(file.stem.removeprefix("ply-")): file for file in folder.glob("ply-*.xml")} if folder else {}


def make_records(program, results, meshes=None):
    results.mkdir(parents=True, exist_ok=True)
    table = []
    for axis, value, passes, options in RUNS:
        for threads in [1, 2]:
            run = render(program, results, {**options, "--passes": str(passes), "--threads": str(threads)})[-1]
            table.append(row_of(axis, int(run["hit_points"]) if axis == "hit_points" else value, run))
    for triangles, scene in sorted(scenes_by_triangles(meshes).items()):
        for threads in [1, 2]:
            run = render(program, results, {**BOX, "--passes": "16", "--threads": str(threads)}, scene)[-1]
            table.append(row_of("triangles", triangles, run))
    for integrator in PASSES_OF:
        runs = render(program, results, {**PASSES, "--integrator": integrator, "--threads": "1"})
        table += [row_of("passes", int(run["pass"]), run) for run in runs if int(run["pass"]) > 0]
    tables.write_table(results / NAME, COLUMNS, table)
    for name in ["run.csv", "run.columns.json", "run.exr"]:
        files.remove_file(results / name)


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


def times_as_fast(one, two, cores):
    """By how much so many cores are faster than one, where a pass takes these seconds with one thread and with two."""
    undivided = min(one, max(0.0, 2 * two - one))
    return one / (undivided + (one - undivided) / cores)


def with_cores(table):
    """{photons a pass: [(cores, times as fast as one)]} by the model."""
    one, two = (dict(curve(table, "photons", "seconds", threads=threads)) for threads in [1, 2])
    return {photons: [(cores, times_as_fast(one[photons], two[photons], cores)) for cores in CORES]
            for photons in sorted(set(one) & set(two))}


def integrators_of(table):
    """{integrator: how it is shown} of those that are compared over passes."""
    shown = columns.before_descriptions()["integrator"].shown
    return {name: shown(name) for name in dict.fromkeys(table["integrator"][table["axis"] == "passes"])}


def statements(table):
    """What the records say, a line each."""
    said = []
    for axis, unit in [("photons", "photons a pass"), ("hit_points", "hit points"), ("triangles", "triangles")]:
        for threads in THREADS:
            points = curve(table, axis, "seconds", threads=threads)
            if points:
                value, seconds = points[-1]
                said.append(f"{value:.0f} {unit}, {threads} thread{'s' * (threads > 1)}: {seconds:.3g} s a pass, exponent "
                            f"{exponent(points):.2f}")
        one, two = (dict(curve(table, axis, "seconds", threads=threads)) for threads in [1, 2])
        said += [f"{value:.0f} {unit}: two threads are {one[value] / two[value]:.2f} times as fast as one"
                 for value in sorted(set(one) & set(two))]
    for photons, points in with_cores(table).items():
        said.append(f"{photons:.0f} photons a pass, by the model: {points[-1][0]} cores are {points[-1][1]:.1f} times as fast as one")
    for integrator, name in integrators_of(table).items():
        points = curve(table, "passes", "map_bytes", integrator=integrator)
        resident = curve(table, "passes", "peak_rss_mib", integrator=integrator)
        if len(points) > 1:
            said.append(f"{name}, {points[0][0]:.0f} to {points[-1][0]:.0f} passes: map from "
                        f"{points[0][1] / MEBIBYTE:.3g} to {points[-1][1] / MEBIBYTE:.3g} MiB, exponent {exponent(points):.2f}; "
                        f"process from {resident[0][1]:.0f} to {resident[-1][1]:.0f} MiB")
    return said


def looks_of(table):
    """Line settings by number of threads and by integrator."""
    names = {**THREADS, **integrators_of(table)}
    looks = {key: {"color": colour, "marker": marker, "label": label}
             for (key, label), colour, marker in zip(names.items(), style.COLOURS, style.MARKERS)}
    for name in integrators_of(table):
        looks[name]["linestyle"] = style.pattern([("integrator", name)], columns.before_descriptions())
    return looks


@style.drawn
def draw(table):
    """The figure of scaling.csv."""
    looks = looks_of(table)
    handles = [lines.Line2D([], [], **look) for look in looks.values()]
    handles.append(lines.Line2D([], [], label="proportional", **GUIDE))
    has_meshes = any(curve(table, "triangles", "seconds", threads=threads) for threads in THREADS)
    figure, grid = panels_over_legend(
        3 if has_meshes else 2, 2, handles,
        f"Cornell box{', and where triangles are counted with two boulders in place of its blocks' if has_meshes else ''}. PPM from "
        "100,000 photon paths a pass and 256 x 256 hit points, but against passes. Memory is photons with their index, at their "
        f"largest so far{', and against triangles the whole process' if has_meshes else ''}.", panel_height=1.7, same_heights=False)

    def panel(axes, label, drawn):
        axes.set_visible(bool(drawn))
        for look, points in drawn:
            axes.plot(*zip(*points), **looks[look])
        every = [point for _, points in drawn for point in points]
        if every:
            style.logarithmic(axes.xaxis, min(x for x, _ in every) / 1.3, max(x for x, _ in every) * 1.6)
        axes.set_xlabel(label)
        return every

    def of_each(axis, column):
        return [(threads, points) for threads in THREADS if (points := curve(table, axis, column, threads=threads))]

    def seconds(axis):
        return of_each(axis, "seconds")

    def mebibytes(axis, name, values):
        return [(value, [(x, y / MEBIBYTE) for x, y in points]) for value in values
                if (points := curve(table, axis, "map_bytes", **{name: value}))]

    every = panel(grid[0][0], "photon paths a pass", seconds("photons"))
    every += panel(grid[1][0], "hit points", seconds("hit_points"))
    if has_meshes:
        every += panel(grid[2][0], "triangles", seconds("triangles"))
    limits(grid[:, 0], every, "seconds a pass")
    every = panel(grid[0][1], "photon paths a pass", mebibytes("photons", "threads", THREADS))
    every += panel(grid[1][1], "passes (500 paths each)", mebibytes("passes", "integrator", integrators_of(table)))
    if has_meshes:
        every += panel(grid[2][1], "triangles", of_each("triangles", "peak_rss_mib"))
    limits(grid[:, 1], every, "memory (MiB)")
    for axes in (axes for axes in grid.flat if axes.get_visible()):
        (low, high), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        # From the upper right corner down, and from the middle of the left side up.
        axes.plot([low, high], [top * low / high, top], **GUIDE)
        axes.set_xlim(low, high)
        axes.set_ylim(bottom, top)
    return figure


@style.drawn
def draw_cores(table):
    """How many times as fast more cores are, by the model: a line for each number of photons."""
    lines_of = with_cores(table)
    looks = {photons: {"color": colour, "marker": marker, "label": f"{photons:,.0f} photon paths a pass"}
             for photons, colour, marker in zip(lines_of, style.COLOURS, style.MARKERS)}
    handles = [lines.Line2D([], [], **look) for look in looks.values()]
    handles.append(lines.Line2D([], [], label="proportional", **GUIDE))
    figure, grid = panels_over_legend(
        1, 1, handles, "PPM, Cornell box, 256 x 256 hit points. Measured with one thread and two; dashed: what did not become shorter with "
        "the second stays, and the rest is divided by the cores.", panel_height=2.4)
    axes = grid[0][0]
    for photons, points in lines_of.items():
        axes.plot(*zip(*points[:2]), **looks[photons])
        axes.plot(*zip(*points[1:]), color=looks[photons]["color"], linestyle="--", zorder=2)
    axes.plot([1, CORES[-1]], [1, CORES[-1]], **GUIDE)
    style.logarithmic(axes.xaxis, 1 / 1.1, CORES[-1] * 1.1)
    axes.set_xlabel("cores")
    limits([axes], [(1, 1), (CORES[-1], CORES[-1])], "times as fast as one")
    return figure


def limits(panels, every, label):
    """The same for each, around all points."""
    for axes in panels:
        style.logarithmic(axes.yaxis, min(y for _, y in every) / 1.3, max(y for _, y in every) * 1.3)
        axes.set_ylabel(label)


def make(results, options):
    if options.run:
        make_records(options.run, results.folder, options.meshes)
    table = read(results.folder / NAME)
    yield from statements(table)
    yield Drawn("scaling", draw(table, **options.look))
    if with_cores(table):
        yield Drawn("cores", draw_cores(table, **options.look))


def add_options(parser):
    parser.add_argument("--run", metavar="PROGRAM", type=Path, help="make the records first, with this photonlab")
    parser.add_argument("--meshes", metavar="FOLDER", type=Path,
                        help="and of the scenes there that tests/benchmarks/meshes.py made, ply-N.xml")


COMMAND = Command(
    name="scaling", draws=True, summary="seconds and memory of a pass against its photons, hit points and triangles", about=__doc__,
    writes="scaling.csv (with --run), figures/scaling.png and .pdf, and cores.png and .pdf",
    make=make, starts_from=NAME, read=one_table.measured_in(NAME), add_options=add_options)
