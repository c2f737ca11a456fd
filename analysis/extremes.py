"""Where the answer stops being right: relative error against size, place and light of the scene, against radius, glass, triangles
and passes.

    python3 analysis/extremes.py RESULTS RESULTS_RAYS

RESULTS is what experiments/extremes.toml made, with update.csv of the program update_records in it, RESULTS_RAYS is that of
extremes-rays.toml. Every scene's name is an axis and a value, and every scene's answer is known (scenes/extremes/README.md).

Photons: unit, offset, light and radius must change nothing, so an image's mean is compared with that of the same scene at its plain
value, for the same seeds: without noise. How far that one is from its exact answer, with the noise of its seeds, is printed.
Rays: the worst pixel's |x - 1|, without any noise. Update: the closed form of radius, count and estimate, the worst of the three.

"right" in the table that is printed, extremes.csv, is the range of values around the plain one with errors of at most 0.1%.
"""

import argparse
import math
import re
import sys
from pathlib import Path

try:
    import files
    import numpy
    import pictures
    import records
    import style
    import tables
    from files import InputError
    from matplotlib import lines
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

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
LOOKS = {"ppm": {"label": "PPM", "color": style.COLOURS[0], "marker": "o"},
         "photonmapper": {"label": "PM", "color": style.COLOURS[1], "marker": "s", "linestyle": (0, (5, 1.5))},
         "0.0001": {"label": "branches cut at $10^{-4}$", "color": style.COLOURS[2], "marker": "^"},
         "1e-06": {"label": "branches cut at $10^{-6}$", "color": style.COLOURS[3], "marker": "D"},
         "1e-08": {"label": "branches cut at $10^{-8}$", "color": style.COLOURS[4], "marker": "v"},
         "program": {"label": "the program's update", "color": style.COLOURS[5], "marker": "o"},
         "double": {"label": "printed update, double", "color": style.COLOURS[6], "marker": "X", "linestyle": (0, (1, 1.2))},
         "float": {"label": "printed update, float", "color": style.COLOURS[7], "marker": "P"}}


def axis_of(scene):
    """("unit", 1e-6) of "unit-1e-06"."""
    found = re.fullmatch(r"([a-z]+)-(\d.*)", scene)
    value = records.as_number(found[2]) if found else None
    if value is None or found[1] not in {**PHOTON_AXES, **RAY_AXES}:
        raise InputError(f"scene {scene}: expected a variant of scenes/extremes, AXIS-VALUE")
    return found[1], value


def images(results):
    """{(scene, integrator or branch cut-off): [last image of each seed]}"""
    runs = results.rows.drop_duplicates("run")
    found = {}
    for row in runs.sort_values("seed").itertuples():
        run = results.run(row.run)
        by_pass = run.snapshots
        if not by_pass:
            raise InputError(f"{run.folder}: has no snapshot; run the experiment again")
        image = pictures.read_component(by_pass[max(by_pass)], "total")
        method = row.branch_cutoff if row.integrator == "path" else row.integrator
        found.setdefault((row.scene, method), []).append(image)
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
    return list(zip(table["axis"], numbers["value"], table["update"], worst))


def plain_answers(found):
    """What the plain scenes' means are beside their exact answers, a line each."""
    said = []
    for scene, exact, what in [("unit-1", 4.0, "furnace"), ("radius-0.015625", foot_answer(), "foot of the light")]:
        for method in ["ppm", "photonmapper"]:
            means = [float(numpy.mean(image)) / exact - 1.0 for image in found.get((scene, method), [])]
            if len(means) > 1 and not (scene.startswith("radius") and method == "ppm"):    # whose radii differ
                error = numpy.std(means, ddof=1) / math.sqrt(len(means))
                said.append(f"{what}, {LOOKS[method]['label']}: {100 * numpy.mean(means):+.3f}% ± {100 * error:.3f}% from exact")
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


def statements(rows):
    said = []
    plains = {**{axis: plain for axis, (_, _, plain) in PHOTON_AXES.items()},
              **{axis: plain for axis, (_, plain) in {**RAY_AXES, **UPDATE_AXES}.items()}}
    for axis, plain in plains.items():
        for method in LOOKS:
            points = [(value, error) for of, value, by, error in rows if (of, by) == (axis, method)]
            if not points:
                continue
            right = right_range(points, plain)
            outside = [(value, error) for value, error in sorted(points) if not right or not right[0] <= value <= right[1]]
            said.append(f"{axis:9} {LOOKS[method]['label']:26} " +
                        (f"right from {right[0]:.3g} to {right[1]:.3g}" if right else "right nowhere") +
                        (", then " + ", ".join(f"{value:.3g}: {error:.2g}" for value, error in outside) if outside else
                         f", at most {max(error for _, error in points):.2g}"))
    return said


def draw(rows):
    style.use()
    used = [method for method in LOOKS if any(row[2] == method for row in rows)]
    handles = [lines.Line2D([], [], **LOOKS[method]) for method in used]
    handles.append(lines.Line2D([], [], color="#D55E00", linewidth=0.8, linestyle=(0, (4, 2)), label="0.1%"))
    figure, grid = style.panels_over_legend(
        5, 2, handles, "Photons, first four panels: mean of the image against that of the same scene and photons at its plain value, "
        "which is exact within its noise. Rays, next three: error of the worst pixel. Last three: radius, count and "
        f"estimate of a point, in its first pass a thousand photons or one, the worst of the three. On the lowest line: {LOWEST:g} and "
        "less.",
        panel_height=1.3)
    labels = {axis: about[0] for axis, about in {**PHOTON_AXES, **RAY_AXES, **UPDATE_AXES}.items()}
    for axes, (axis, label) in zip(grid.flat, labels.items()):
        values = [row[1] for row in rows if row[0] == axis]
        for method in used:
            points = sorted((value, error) for of, value, by, error in rows if (of, by) == (axis, method))
            if points:
                # NaN, which is no number at all, is drawn at the top.
                heights = [min(HIGHEST, max(LOWEST, error if error == error else HIGHEST)) for _, error in points]
                axes.plot([value for value, _ in points], heights, clip_on=False, **LOOKS[method])
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


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS/extremes.csv and RESULTS/figures/extremes.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS", type=Path, help="of experiments/extremes.toml, with update.csv")
    parser.add_argument("rays", metavar="RESULTS_RAYS", type=Path, help="of experiments/extremes-rays.toml")
    chosen = parser.parse_args(arguments)
    results = records.read(chosen.results)
    found = images(results)
    rows = sorted(photon_errors(found) + ray_errors(images(records.read(chosen.rays))) + update_errors(chosen.results / "update.csv"))
    table = [dict(zip(COLUMNS, (axis, f"{value:.8g}", method, f"{error:.3g}"))) for axis, value, method, error in rows]
    print("\n".join(plain_answers(found) + statements(rows)))
    print(tables.write_derived(results, "extremes.csv", COLUMNS, table))
    for file in style.save(draw(rows), results.folder, "extremes", results.hash):
        print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
