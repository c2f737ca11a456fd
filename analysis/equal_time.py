"""Compares methods at the same seconds: a table of errors, and pictures with insets at one budget.

Nothing is stopped by the clock: a method's error at a budget is interpolated between its recorded passes, on logarithmic
axes, where curves are nearly straight. Errors are means over seeds of the unbiased MSE, seconds the means of the
records, which hold passes alone. Nothing is extrapolated: a budget before a method's first pass or after its last has no error,
and the table says which ("less than one pass", "more than recorded"). "not resolved" is an error that came out at 0 or below.

The table has the whole image, and where decomposition.csv is there (decomposition.py) also the experiment's named regions. The
pictures are those of the recorded pass that is nearest to the budget, which is written under them; below them stand the regions,
or without any the square with the most contrast, each exposed for itself.

Budgets are powers of two of a second that at least one method reaches; the pictures are of the last that all reach.
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import bias_variance
    import decomposition
    import files
    import numpy
    import pictures
    import records
    import style
    import tables
    from matplotlib import patches
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

COLUMNS = ["scene", "component", "region", "seconds", "method", "pass", "mse", "rmse", "note"]
BUDGETS = 10   # at most
INSET = 0.2    # of the picture's side
CELL = 1.9     # inches


def curve_of(rows, component):
    """A method's mean MSE by recorded pass, with its mean seconds, from the first pass on."""
    of_component = rows[rows["component"] == component]
    curve = records.aggregate_over_seeds(of_component, records.error_column(of_component))
    return curve[(curve.index > 0) & (curve["seconds"] > 0) & curve["mean"].notna()]


def region_curve(rows, component, region):
    """The same of a named region, from a method's rows of decomposition.csv."""
    own = rows[(rows["component"] == component) & (rows["region"] == region) & rows["mse"].notna()]
    curve = own.set_index("pass")[["seconds", "mse"]].rename(columns={"mse": "mean"}).sort_index()
    return curve[(curve.index > 0) & (curve["seconds"] > 0)]


def at_budget(curve, seconds):
    """(pass, MSE) after `seconds`, both interpolated, or why there is none."""
    if seconds < curve["seconds"].iloc[0]:
        return "less than one pass"
    if seconds > curve["seconds"].iloc[-1]:
        return "more than recorded"
    place = numpy.log(curve["seconds"])
    number = math.exp(numpy.interp(math.log(seconds), place, numpy.log(curve.index.astype(float))))
    around = curve["mean"].to_numpy()
    right = min(int(numpy.searchsorted(curve["seconds"], seconds)), len(around) - 1)
    if min(around[max(0, right - 1)], around[right]) <= 0:
        return "not resolved"
    with numpy.errstate(invalid="ignore", divide="ignore"):
        return number, math.exp(numpy.interp(math.log(seconds), place, numpy.log(around)))


def budgets_of(curves):
    """(powers of two of a second that some method reaches, the last that all reach or None)."""
    first = min(curve["seconds"].iloc[0] for curve in curves.values())
    last = max(curve["seconds"].iloc[-1] for curve in curves.values())
    powers = range(math.ceil(math.log2(first)), math.floor(math.log2(last)) + 1)
    budgets = [2.0 ** power for power in powers][-BUDGETS:]
    common = [seconds for seconds in budgets
              if all(curve["seconds"].iloc[0] <= seconds <= curve["seconds"].iloc[-1] for curve in curves.values())]
    return budgets, common[-1] if common else None


def curves_of(rows, split, labels):
    """{(component, region): {label: curve}}. `split` are the scene's rows of decomposition.csv, with methods, or None."""
    found = {}
    for component in ["total", "gathered"]:
        found[component, "image"] = {label: curve_of(rows[rows["method"] == label], component) for label in labels}
        for region in [] if split is None else dict.fromkeys(split["region"]):
            if region != "image":
                found[component, region] = {label: region_curve(split[split["method"] == label], component, region)
                                            for label in labels}
    return {place: {label: curve for label, curve in curves.items() if not curve.empty} for place, curves in found.items()}


def table_of(scene, curves):
    """(rows of the table, the budget of the pictures or None)."""
    if not curves["total", "image"]:
        return [], None
    budgets, common = budgets_of(curves["total", "image"])
    table = []
    for (component, region), of_place in curves.items():
        for seconds in budgets:
            for label, curve in of_place.items():
                row = {"scene": scene, "component": component, "region": region, "seconds": seconds, "method": label}
                found = at_budget(curve, seconds)
                if isinstance(found, str):
                    table.append({**row, "note": found})
                else:
                    table.append({**row, "pass": found[0], "mse": found[1], "rmse": records.root(found[1])})
    return table, common


def read_split(results, recorded):
    """Rows of decomposition.csv with the method that each point is; None where the file is not there."""
    if not files.is_there(results.folder / "decomposition.csv"):
        return None
    rows = bias_variance.read_decomposition(results)
    method_of = recorded.assign(point=recorded["run"].map(decomposition.point_of)).drop_duplicates("point").set_index("point")
    return rows.assign(method=rows["point"].map(method_of["method"]))


def regions_of(results, scene):
    """{name: (left, top, right, bottom)} of a scene's regions, from its ensembles; {} where there are none."""
    for folder in sorted((results.folder / "ensembles").glob("*/")):
        description = decomposition.read_description(results, folder)
        if description["scene"] == scene:
            return description["regions"]
    return {}


def place_of_inset(reference, is_light, side):
    """Top left corner (y, x) of the square of `side` pixels with the most contrast, without a light in it."""
    luminance = numpy.log1p(reference.mean(axis=2))
    best, corner = -1.0, (0, 0)
    for y in range(0, luminance.shape[0] - side + 1, max(1, side // 4)):
        for x in range(0, luminance.shape[1] - side + 1, max(1, side // 4)):
            spread = luminance[y:y + side, x:x + side].std()
            if spread > best and not is_light[y:y + side, x:x + side].any():
                best, corner = spread, (y, x)
    return corner


def nearest_snapshot(results, rows, seconds):
    """(image, text, file) of the recorded pass nearest to the budget, of the lowest seed."""
    of_seed = rows[(rows["seed"] == rows["seed"].min()) & (rows["component"] == "total")]
    run = of_seed["run"].iloc[0]
    times = of_seed.set_index("pass")["seconds"]
    by_pass = {number: file for number, file in results.run(run).snapshots.items() if times.get(number, 0) > 0}
    if not by_pass:
        return None
    number = min(by_pass, key=lambda number: abs(math.log(times[number] / seconds)))
    image = pictures.read_component(by_pass[number], "total")
    return image, f"pass {number}, {style.two_digits(times[number])} s", by_pass[number]


def insets_of(results, scene, reference, is_light):
    """{title: (left, top, right, bottom)}: the scene's regions, or the square with the most contrast."""
    height, width = reference.shape[:2]
    regions = {name: place for name, place in regions_of(results, scene).items() if place[2] <= width and place[3] <= height}
    if regions:
        return regions
    side = max(4, round(INSET * width))
    y, x = place_of_inset(reference, is_light, side)
    return {"": (x, y, x + side, y + side)}


def draw_scene(results, scene, rows, labels, table, seconds):
    """Pictures at the budget with insets; None without snapshots or a reference."""
    judge = records.reference_of(results, results.run(rows["run"].iloc[0]).description)
    halves = judge.halves if judge else []
    reference = pictures.read_reference(halves, "total", False)
    shown = [(label, nearest_snapshot(results, rows[rows["method"] == label], seconds)) for label in labels]
    shown = [(label, found) for label, found in shown if found]
    if reference is None or not shown:
        return None
    for _, (image, _, file) in shown:
        pictures.require_same_size(file, image, halves[0], reference)
    errors = {(row["region"], row["method"]): row["rmse"] for row in table
              if row["component"] == "total" and row["seconds"] == seconds and "rmse" in row}

    def error_text(region, label):
        return f"RMSE {style.two_digits(errors[region, label])}" if (region, label) in errors else ""

    emission = pictures.read_component(shown[0][1][2], "emission")
    is_light = numpy.zeros(reference.shape[:2], bool) if emission is None else emission.max(axis=2) > 0
    scale = pictures.exposure_for(reference * ~is_light[:, :, None])
    insets = insets_of(results, scene, reference, is_light)
    cells = [(label, image, f"{text}\nat {seconds:g} s: {error_text('image', label) or 'not resolved'}")
             for label, (image, text, _) in shown] + [("reference", reference, "")]
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    heights = [1.0, *((bottom - top) / (right - left) for left, top, right, bottom in insets.values())]
    figure, grid = style.pyplot.subplots(len(heights), len(cells), squeeze=False, layout="constrained",
                                         figsize=(CELL * len(cells), CELL * sum(heights) + 0.5 + 0.3 * len(heights)),
                                         height_ratios=heights)
    for column, (label, image, text) in enumerate(cells):
        picture = pictures.to_srgb(image, scale)
        grid[0][column].imshow(picture, interpolation="nearest")
        for row, (name, (left, top, right, bottom)) in enumerate(insets.items(), start=1):
            place = (slice(top, bottom), slice(left, right))
            own_scale = pictures.exposure_for((reference * ~is_light[:, :, None])[place])
            grid[row][column].imshow(pictures.to_srgb(image[place], own_scale), interpolation="nearest")
            grid[row][column].set_xlabel(error_text(name, label), fontsize=7.5)
            grid[row][0].set_ylabel(name, fontsize=8)
            grid[0][column].add_patch(patches.Rectangle((left - 0.5, top - 0.5), right - left, bottom - top, fill=False,
                                                        edgecolor="white", linewidth=0.8))
        for axes in grid[:, column]:
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(True)
        grid[0][column].set_title(label, fontsize=9)
        grid[0][column].set_xlabel(text, fontsize=7.5)
    figure.suptitle(f"{scene}: {seconds:g} s. {records.noise_note(rows)}", fontsize=9.5, x=0.01, ha="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/equal-time.csv and figures/equal-time-SCENE, .png and "
                                     ".pdf.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = records.read(parser.parse_args(arguments).results)
    recorded = results.rows
    labels = records.methods_in_order(recorded)
    split = read_split(results, recorded)
    table = []
    for scene, rows in recorded.groupby("scene", sort=False):
        own = [label for label in labels if label in set(rows["method"])]
        if rows["mse"].isna().all():
            print(f"{scene}: no errors were recorded (was there a reference?), so no comparison")
            continue
        curves = curves_of(rows, None if split is None else split[split["scene"] == scene], own)
        of_scene, seconds = table_of(scene, curves)
        table += of_scene
        if seconds is None:
            print(f"{scene}: no time that all methods reach, so no pictures")
            continue
        figure = draw_scene(results, scene, rows, own, of_scene, seconds)
        if figure is None:
            print(f"{scene}: no snapshots, so no pictures")
            continue
        for file in style.save(figure, results.folder, f"equal-time-{records.file_name(scene)}", results.hash):
            print(file)
    print(tables.write_derived(results, "equal-time.csv", COLUMNS, table))
    return 0


if __name__ == "__main__":
    files.run(main)
