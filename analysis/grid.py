"""Draws a sweep over two settings as a grid: the final error as a heat map, and the difference from the reference as
images, one a cell. Made for initial radius by alpha, but any two settings that an experiment sweeps will do.

The error is the root of the mean, over seeds, of the unbiased MSE at the last pass. Differences are those of the lowest
seed, mean of the channels: blue is too dark, red too bright, all on one scale.
"""

import argparse
import sys
from pathlib import Path

try:
    import files
    import numpy
    import pictures
    import records
    import style
    from files import InputError
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

CELL = 1.1    # inches


def swept_settings(rows):
    """The two settings that take several values among the methods of these rows, by the number of values."""
    counts = {column: rows[column].nunique() for column in records.SETTINGS if rows[column].nunique() > 1}
    counts.pop("radius_rule", None)
    if len(counts) != 2:
        raise InputError(f"expected a sweep over two settings, found {', '.join(counts) or 'none'}")
    return sorted(counts, key=counts.get, reverse=True)


def values_of(rows, column):
    """The values of a setting as text, in order of their numbers."""
    return sorted(set(rows[column]), key=lambda text: (records.as_number(text) is None, records.as_number(text), text))


def final_errors(rows, across, down):
    """(values across, values down, RMSE[down][across]) of the whole image at the last pass; NaN below resolution."""
    last = rows[(rows["component"] == "total") & (rows["pass"] == rows["pass"].max())]
    column = records.error_column(last)
    means = last.groupby([down, across])[column].mean()
    columns, lines = values_of(last, across), values_of(last, down)
    return columns, lines, numpy.array([[records.root(means.get((line, value), numpy.nan)) for value in columns]
                                        for line in lines])


def short(text):
    number = records.as_number(text)
    return text if number is None else f"{number:.3g}"


def draw_heat_map(scene, rows, across, down):
    columns, lines, errors = final_errors(rows, across, down)
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    figure, axes = style.pyplot.subplots(figsize=(0.9 + 0.75 * len(columns), 0.9 + 0.45 * len(lines)),
                                         layout="constrained")
    axes.imshow(errors, cmap="viridis_r", aspect="auto", norm="log")
    least = numpy.nanmin(errors)
    middle = numpy.sqrt(least * numpy.nanmax(errors))
    for i, line in enumerate(errors):
        for j, error in enumerate(line):
            text = "below\nresolution" if numpy.isnan(error) else style.two_digits(error) if error >= 1e-3 else f"{error:.1e}"
            axes.text(j, i, text, ha="center", va="center", fontsize=8, color="white" if error > middle else "black",
                      fontweight="bold" if error == least else "normal")
    axes.set_xticks(range(len(columns)), [short(value) for value in columns])
    axes.set_yticks(range(len(lines)), [short(value) for value in lines])
    axes.set_xlabel(records.axis_text(across))
    axes.set_ylabel(records.axis_text(down))
    axes.set_title(f"{scene}: RMSE at pass {rows['pass'].max():.0f} (radiance)", loc="left")
    figure.supxlabel(records.noise_note(rows[rows["component"] == "total"]), fontsize=7, color="#333333", x=0.01, ha="left")
    return figure


def final_difference(results, rows):
    """Last snapshot minus reference of the lowest seed of these rows; None without a snapshot or a reference."""
    of_seed = rows[rows["seed"] == rows["seed"].min()]
    run = of_seed["run"].iloc[0]
    by_pass = results.run(run).snapshots
    judge = records.reference_of(results, results.run(run).description)
    if not by_pass or not judge or not judge.halves:
        return None
    halves = judge.halves
    image, reference = pictures.read_component(by_pass[max(by_pass)], "total"), pictures.read_reference(halves, "total", False)
    pictures.require_same_size(by_pass[max(by_pass)], image, halves[0], reference)
    return (image - reference).mean(axis=2)


def draw_differences(scene, results, rows, across, down):
    columns, lines = values_of(rows, across), values_of(rows, down)
    differences = {(line, value): final_difference(results, rows[(rows[down] == line) & (rows[across] == value)])
                   for line in lines for value in columns
                   if not rows[(rows[down] == line) & (rows[across] == value)].empty}
    shown = [difference for difference in differences.values() if difference is not None]
    if not shown:
        return None
    scale = numpy.nanpercentile(numpy.abs(shown), 99)
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    figure, grid = style.pyplot.subplots(len(lines), len(columns), squeeze=False, layout="constrained",
                                         figsize=(0.5 + CELL * len(columns), 0.6 + CELL * len(lines)))
    for i, line in enumerate(lines):
        for j, value in enumerate(columns):
            axes = grid[i][j]
            axes.set(xticks=[], yticks=[])
            difference = differences.get((line, value))
            if difference is not None:
                picture = axes.imshow(difference, cmap="RdBu_r", vmin=-scale, vmax=scale)
            if i == len(lines) - 1:
                axes.set_xlabel(short(value))
            if j == 0:
                axes.set_ylabel(f"{short(line)}")
    figure.supylabel(records.axis_text(down), fontsize=9)
    figure.supxlabel(records.axis_text(across), fontsize=9)
    figure.colorbar(picture, ax=grid, shrink=0.6, label="radiance − reference")
    figure.suptitle(f"{scene}: difference at pass {rows['pass'].max():.0f}", fontsize=9.5, x=0.01, ha="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/grid-SCENE and differences-SCENE, .png and .pdf."
                                     "\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = records.read(parser.parse_args(arguments).results)
    recorded = results.rows
    for scene, rows in recorded.groupby("scene", sort=False):
        if rows["mse"].isna().all():
            print(f"{scene}: no errors were recorded (was there a reference?), so no grid")
            continue
        down, across = swept_settings(rows)
        for name, figure in [("grid", draw_heat_map(scene, rows, across, down)),
                             ("differences", draw_differences(scene, results, rows, across, down))]:
            if figure is None:
                print(f"{scene}: no snapshots, so no differences")
                continue
            for file in style.save(figure, results.folder, f"{name}-{records.file_name(scene)}", results.hash):
                print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
