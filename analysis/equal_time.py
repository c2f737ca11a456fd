"""Compares methods at the same seconds: a table of errors, and pictures with an inset at one budget.

Nothing is stopped by the clock: a method's error at a budget is interpolated between its recorded passes, on logarithmic
axes, where curves are nearly straight. Errors are means over seeds of the unbiased MSE, seconds the means of the
records, which hold passes alone. A budget before a method's first pass or after its last is left empty, not
extrapolated. The pictures are those of the recorded pass that is nearest to the budget, which is written under them.

Budgets are powers of two of a second, up to the last that all methods of a scene reach; the pictures are of that one.
"""

import argparse
import csv
import math
import sys
from pathlib import Path

try:
    import numpy
    import pictures
    import records
    import style
    from matplotlib import patches
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-pandas, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

COLUMNS = ["scene", "method", "component", "seconds", "pass", "mse", "rmse"]
INSET = 0.2    # of the picture's side
CELL = 1.9     # inches


def curve_of(rows, component):
    """A method's mean MSE by recorded pass, with its mean seconds, from the first pass on."""
    of_component = rows[rows["component"] == component]
    curve = records.aggregate_over_seeds(of_component, records.error_column(of_component))
    return curve[(curve.index > 0) & (curve["seconds"] > 0) & curve["mean"].notna()]


def at_budget(curve, seconds):
    """(pass, MSE) after `seconds`, both interpolated; None outside the records or where the error is not resolved."""
    if curve.empty or not curve["seconds"].iloc[0] <= seconds <= curve["seconds"].iloc[-1]:
        return None
    place = numpy.log(curve["seconds"])
    number = math.exp(numpy.interp(math.log(seconds), place, numpy.log(curve.index.astype(float))))
    around = curve["mean"].to_numpy()
    right = min(int(numpy.searchsorted(curve["seconds"], seconds)), len(around) - 1)
    if min(around[max(0, right - 1)], around[right]) <= 0:
        return None
    with numpy.errstate(invalid="ignore", divide="ignore"):
        return number, math.exp(numpy.interp(math.log(seconds), place, numpy.log(around)))


def budgets_of(curves):
    """Powers of two of a second that every method reaches, the last eight."""
    first = max(curve["seconds"].iloc[0] for curve in curves.values())
    last = min(curve["seconds"].iloc[-1] for curve in curves.values())
    if last < first:
        return []
    powers = range(math.ceil(math.log2(first)), math.floor(math.log2(last)) + 1)
    return [2.0 ** power for power in powers][-8:] or [math.sqrt(first * last)]


def table_of(scene, rows, labels):
    """Rows of the table, and the budgets."""
    table, budgets = [], []
    for component in ["total", "gathered"]:
        curves = {label: curve_of(rows[rows["method"] == label], component) for label in labels}
        curves = {label: curve for label, curve in curves.items() if not curve.empty}
        if not curves:
            continue
        if component == "total":
            budgets = budgets_of(curves)
        for seconds in budgets:
            for label, curve in curves.items():
                found = at_budget(curve, seconds)
                if found:
                    table.append({"scene": scene, "method": label, "component": component, "seconds": seconds,
                                  "pass": found[0], "mse": found[1], "rmse": records.root(found[1])})
    return table, budgets


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
    """(image, text) of the recorded pass nearest to the budget, of the lowest seed."""
    of_seed = rows[(rows["seed"] == rows["seed"].min()) & (rows["component"] == "total")]
    run = of_seed["run"].iloc[0]
    record = records.read_run(results, run)
    times = of_seed.set_index("pass")["seconds"]
    found = [(abs(math.log(times[snapshot["pass"]] / seconds)), snapshot) for snapshot in record["snapshots"]
             if times.get(snapshot["pass"], 0) > 0]
    if not found:
        return None
    snapshot = min(found, key=lambda pair: pair[0])[1]
    image = pictures.read_component(results / "runs" / run / snapshot["file"], "total")
    return image, f"pass {snapshot['pass']}, {style.two_digits(times[snapshot['pass']])} s"


def draw_scene(results, scene, rows, labels, table, seconds):
    """Pictures at the budget with insets; None without snapshots or a reference."""
    record = records.read_run(results, rows["run"].iloc[0])
    reference = pictures.read_reference(records.reference_files(results, record), "total", False)
    shown = [(label, nearest_snapshot(results, rows[rows["method"] == label], seconds)) for label in labels]
    shown = [(label, found) for label, found in shown if found]
    if reference is None or not shown:
        return None
    errors = {row["method"]: row["rmse"] for row in table if row["component"] == "total" and row["seconds"] == seconds}
    emission = pictures.read_component(results / "runs" / rows["run"].iloc[0] / record["snapshots"][0]["file"], "emission")
    is_light = numpy.zeros(reference.shape[:2], bool) if emission is None else emission.max(axis=2) > 0
    scale = pictures.exposure_for(reference * ~is_light[:, :, None])
    side = max(4, round(INSET * reference.shape[1]))
    y, x = place_of_inset(reference, is_light, side)
    cells = [(label, image, f"{text}\nRMSE at {seconds:g} s: {style.two_digits(errors[label]) if label in errors else '–'}")
             for label, (image, text) in shown] + [("reference", reference, "")]
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    figure, grid = style.pyplot.subplots(2, len(cells), squeeze=False, layout="constrained",
                                         figsize=(CELL * len(cells), 2 * CELL + 0.8))
    for column, (label, image, text) in enumerate(cells):
        shown_picture = pictures.to_srgb(image, scale)
        for axes, part in [(grid[0][column], shown_picture), (grid[1][column], shown_picture[y:y + side, x:x + side])]:
            axes.imshow(part, interpolation="nearest")
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(True)
        grid[0][column].add_patch(patches.Rectangle((x - 0.5, y - 0.5), side, side, fill=False, edgecolor="white",
                                                    linewidth=0.8))
        grid[0][column].set_title(label, fontsize=9)
        grid[0][column].set_xlabel(text, fontsize=7.5)
    figure.suptitle(f"{scene}: {seconds:g} s", fontsize=9.5, x=0.01, ha="left")
    return figure


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/equal-time.csv and figures/equal-time-SCENE, .png and "
                                     ".pdf.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = parser.parse_args(arguments).results
    try:
        recorded = records.read_records(results)
        labels = records.methods_in_order(recorded)
        table = []
        for scene, rows in recorded.groupby("scene", sort=False):
            own = [label for label in labels if label in set(rows["method"])]
            if rows["mse"].isna().all():
                print(f"{scene}: no errors were recorded (was there a reference?), so no comparison")
                continue
            of_scene, budgets = table_of(scene, rows, own)
            table += of_scene
            if not budgets:
                print(f"{scene}: no time that all methods reach")
                continue
            figure = draw_scene(results, scene, rows, own, of_scene, budgets[-1])
            if figure is None:
                print(f"{scene}: no snapshots, so no pictures")
                continue
            for file in style.save(figure, results, f"equal-time-{records.file_name(scene)}"):
                print(file)
        with open(results / "equal-time.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(table)
        print(results / "equal-time.csv")
    except (records.RecordError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
