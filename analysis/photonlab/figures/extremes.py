"""Where the answer stops being right: relative error against size, place and light of the scene, against radius, glass, triangles
and passes.

    /usr/bin/python3 analysis extremes RESULTS RESULTS_RAYS

RESULTS is what experiments/extremes.toml made, with update.csv of the program update_records in it, RESULTS_RAYS is that of
extremes-rays.toml. Every scene's name is an axis and a value, and every scene's answer is known (scenes/extremes/README.md).

Photons: unit, offset, light and radius must change nothing, so an image's mean is compared with that of the same scene at its plain
value, for the same seeds: without noise. How far that one is from its exact answer, with the noise of its seeds, is printed.
Rays: the worst pixel's |x - 1|, without any noise. Update: the closed form of radius, count and estimate, the worst of the three.

"right" in the table that is printed, extremes.csv, is the range of values around the plain one with errors of at most 0.1%.
"""

import itertools
import math
import re
from pathlib import Path

import numpy
from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import panels_over_legend
from photonlab.drawing.saving import Drawn
from photonlab.records import files, images, records, tables
from photonlab.records.columns import as_number
from photonlab.records.files import InputError

TOLERANCE = 1e-3
LOWEST, HIGHEST = 1e-13, 1.0    # of the figure; what is outside is drawn on its edge

# axis: what it is, the scene that its values are compared with, the plain value from which "right" reaches out
PHOTON_AXES = {"unit": ("scene size (scene units)", "unit-1", 1.0),
               "offset": ("distance from the origin (scene sizes)", "offset-1", 1.0),
               "light": ("light (radiance)", "light-1", 1.0),
               "radius": ("radius (scene sizes)", "radius-0.015625", 0.015625)}
RAY_AXES = {"index": ("index of refraction of a ball", 1.5),
            "thickness": ("thickness of a glass sheet (scene sizes)", 1e-2),
            "slivers": ("length by width of triangles", 10.0)}
UPDATE_AXES = {"passes": ("passes", 1.0), "alpha": ("alpha, after a million passes", 0.7),
               "photons": ("photons, one a pass", 1.0)}
COLUMNS = ["axis", "value", "method", "error"]
UPDATES = {"program": ("the program's update", "o", "solid"), "double": ("printed update, double", "X", (0, (1, 1.2))),
           "float": ("printed update, float", "P", "solid")}
NAME = "extremes.csv"


def axis_of(scene):
    """("unit", 1e-6) of "unit-1e-06"."""
    found = re.fullmatch(r"([a-z]+)-(\d.*)", scene)
    value = as_number(found[2]) if found else None
    if value is None or found[1] not in {**PHOTON_AXES, **RAY_AXES}:
        raise InputError(f"scene {scene}: expected a variant of scenes/extremes, AXIS-VALUE")
    return found[1], value


def last_images(results, told_by):
    """{(scene, method): [last image of each seed]}, where methods are told by this setting."""
    runs = results.rows.drop_duplicates("run")
    found = {}
    for _, row in runs.sort_values("seed").iterrows():
        run = results.run(row["run"])
        by_pass = run.snapshots
        if not by_pass:
            raise InputError(f"{run.folder}: has no snapshot; run the experiment again")
        image = images.read_component(by_pass[max(by_pass)], "total")
        found.setdefault((row["scene"], row[told_by]), []).append(image)
    return found


def photon_errors(found):
    """Rows of extremes.csv: of each scene its mean's difference from the plain one's."""
    rows = []
    for (scene, method), of_seeds in found.items():
        axis, value = axis_of(scene)
        if axis not in PHOTON_AXES:
            raise InputError(f"scene {scene}: expected a scene of extremes.toml")
        plain = found.get((PHOTON_AXES[axis][1], method))
        if plain is None or len(plain) != len(of_seeds):
            raise InputError(f"scene {scene}: expected {PHOTON_AXES[axis][1]} with the same seeds beside it")
        light = value if axis == "light" else 1.0
        rows.append((axis, value, method, abs(numpy.mean(of_seeds) / (light * numpy.mean(plain)) - 1.0)))
    return rows


def ray_errors(found):
    rows = []
    for (scene, method), of_seeds in found.items():
        axis, value = axis_of(scene)
        if axis not in RAY_AXES:
            raise InputError(f"scene {scene}: expected a scene of extremes-rays.toml")
        rows.append((axis, value, method, float(numpy.max(numpy.abs(numpy.array(of_seeds) - 1.0)))))
    return rows


def update_errors(file):
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected what build/release/tests/extremes/update_records prints")
    table = tables.read_table(file)
    expected = ["axis", "value", "update", "radius", "count", "estimate"]
    if list(table.columns) != expected:
        raise InputError(f"{file}: expected the columns {', '.join(expected)}")
    numbers = {column: tables.to_numbers(file, table[column]) for column in expected if column not in ["axis", "update"]}
    worst = numpy.maximum(numpy.maximum(numbers["radius"], numbers["count"]), numbers["estimate"])
    unknown = ~table["update"].isin(UPDATES) | ~table["axis"].isin(UPDATE_AXES)
    if unknown.any():
        raise InputError(f"{tables.place(file, unknown)}: expected an axis that is one of {', '.join(UPDATE_AXES)} and an update that "
                         f"is one of {', '.join(UPDATES)}")
    return list(zip(table["axis"], numbers["value"], table["update"], worst))


def plain_answers(found, looks, shrinking):
    """What the plain scenes' means are beside their exact answers, a line each. `shrinking` are the methods whose radius is no longer
    that of the scene."""
    said = []
    for scene, exact, what in [("unit-1", 4.0, "furnace"), ("radius-0.015625", foot_answer(), "foot of the light")]:
        for method in looks:
            means = [float(numpy.mean(image)) / exact - 1.0 for image in found.get((scene, method), [])]
            if len(means) > 1 and not (scene.startswith("radius") and method in shrinking):
                error = numpy.std(means, ddof=1) / math.sqrt(len(means))
                said.append(f"{what}, {looks[method]['label']}: {100 * numpy.mean(means):+.3f}% ± {100 * error:.3f}% from exact")
    return said


def foot_answer():
    """Expectation of the radiance estimated over a disc of half the light's height, where irradiance at the foot is 1."""
    q = math.sqrt(1 + 1 / 4)
    return 0.5 / math.pi * 2 / (q * (q + 1))


def right_range(points, plain):
    """(least, largest) of the values around the plain one with errors of at most the tolerance; None when it is not."""
    points = sorted(points)
    places = [i for i, (value, _) in enumerate(points) if value == plain]
    if not places or not points[places[0]][1] <= TOLERANCE:
        return None
    low = high = places[0]
    while low > 0 and points[low - 1][1] <= TOLERANCE:
        low -= 1
    while high + 1 < len(points) and points[high + 1][1] <= TOLERANCE:
        high += 1
    return points[low][0], points[high][0]


def statements(rows, looks):
    """The range that each method is right in, a line each."""
    said = []
    plains = {**{axis: plain for axis, (_, _, plain) in PHOTON_AXES.items()},
              **{axis: plain for axis, (_, plain) in {**RAY_AXES, **UPDATE_AXES}.items()}}
    for axis, plain in plains.items():
        for method in looks:
            points = [(value, error) for of, value, by, error in rows if (of, by) == (axis, method)]
            if not points:
                continue
            right = right_range(points, plain)
            outside = [(value, error) for value, error in sorted(points) if not right or not right[0] <= value <= right[1]]
            said.append(f"{axis:9} {looks[method]['label']:26} " +
                        (f"right from {right[0]:.3g} to {right[1]:.3g}" if right else "right nowhere") +
                        (", then " + ", ".join(f"{value:.3g}: {error:.2g}" for value, error in outside) if outside else
                         f", at most {max(error for _, error in points):.2g}"))
    return said


def looks_of(rows, columns):
    """{method: line settings} of the methods in rows of the table. `columns` are those of the records."""
    def methods_of(axes, order):
        return sorted({method for axis, _, method, _ in rows if axis in axes}, key=order)

    column = columns["integrator"]
    integrators = methods_of(PHOTON_AXES, lambda name: -style.place_of(name, column))
    looks = {name: {"label": column.shown(name), "linestyle": style.pattern([("integrator", name)], columns)} for name in integrators}
    for cutoff in methods_of(RAY_AXES, lambda text: -float(text)):
        looks[cutoff] = {"label": f"branches cut at {style.short_number(float(cutoff))}"}
    looks = {name: {**look, "marker": marker} for (name, look), marker in zip(looks.items(), itertools.cycle(style.MARKERS))}
    for name in methods_of(UPDATE_AXES, list(UPDATES).index):
        looks[name] = dict(zip(["label", "marker", "linestyle"], UPDATES[name]))
    return {name: {**look, "color": colour} for (name, look), colour in zip(looks.items(), itertools.cycle(style.COLOURS))}


@style.drawn
def draw(rows, looks):
    """The figure of rows of the table."""
    handles = [lines.Line2D([], [], **look) for look in looks.values()]
    handles.append(lines.Line2D([], [], color="#D55E00", linewidth=0.8, linestyle=(0, (4, 2)), label="0.1%"))
    figure, grid = panels_over_legend(
        5, 2, handles, "Photons, first four panels: mean of the image against that of the same scene and photons at its plain value, "
        "which is exact within its noise. Rays, next three: error of the worst pixel. Last three: radius, count and "
        f"estimate of a point, in its first pass a thousand photons or one, the worst of the three. On the lowest line: {LOWEST:g} and "
        "less.",
        panel_height=1.3)
    labels = {axis: about[0] for axis, about in {**PHOTON_AXES, **RAY_AXES, **UPDATE_AXES}.items()}
    for axes, (axis, label) in zip(grid.flat, labels.items()):
        values = [row[1] for row in rows if row[0] == axis]
        for method, look in looks.items():
            points = sorted((value, error) for of, value, by, error in rows if (of, by) == (axis, method))
            if points:
                # NaN, which is no number at all, is drawn at the top.
                heights = [min(HIGHEST, max(LOWEST, error if error == error else HIGHEST)) for _, error in points]
                axes.plot([value for value, _ in points], heights, clip_on=False, **look)
        if values:
            set_scale(axes, min(values), max(values), linear=axis == "index")
        axes.axhline(TOLERANCE, color="#D55E00", linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
        style.logarithmic(axes.yaxis, LOWEST, HIGHEST, most=5)
        axes.set_xlabel(label)
        if axes in grid[:, 0]:
            axes.set_ylabel("relative error")
    return figure


def set_scale(axes, low, high, linear):
    if linear:
        axes.set_xlim(low - 0.1, high + 0.1)
        return
    axes.set_xscale("log")
    reach = max(1.5, (high / low) ** 0.04)
    axes.set_xlim(low / reach, high * reach)
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    step = next(step for step in [1, 2, 5, 10, 20, 50] if last - first <= 7 * step or step == 50)
    axes.xaxis.set_major_locator(style.ticker.FixedLocator([10.0 ** power for power in range(first, last + 1) if power % step == 0]))
    axes.xaxis.set_minor_locator(style.ticker.NullLocator())


def make(results, options):
    found = last_images(results, "integrator")
    rows = photon_errors(found) + ray_errors(last_images(records.read(options.rays), "branch_cutoff"))
    rows = sorted(rows + update_errors(results.folder / "update.csv"))
    looks = looks_of(rows, results.columns)
    shrinking = set(results.rows["integrator"][results.rows["alpha"] != ""])
    yield from plain_answers(found, looks, shrinking) + statements(rows, looks)
    yield tables.Derived(NAME, COLUMNS, [dict(zip(COLUMNS, (axis, f"{value:.8g}", method, f"{error:.3g}")))
                                                        for axis, value, method, error in rows])
    yield Drawn("extremes", draw(rows, looks, **options.look))


def add_options(parser):
    parser.add_argument("rays", metavar="RESULTS_RAYS", type=Path, help="of experiments/extremes-rays.toml; RESULTS is of "
                        "extremes.toml, with update.csv")


COMMAND = Command(
    name="extremes", draws=True, summary="where the answer stops being right, of two folders of results", about=__doc__,
    writes="extremes.csv and figures/extremes.png and .pdf, both in RESULTS",
    make=make, is_for=lambda results: False, add_options=add_options)    # it wants two folders
