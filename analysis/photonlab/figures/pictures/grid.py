"""Draws a sweep over two settings as a grid: the final error as a heat map, and the difference from the reference as
images, one a cell. Made for initial radius by alpha, but any two settings that an experiment sweeps will do.

The error is the root of the mean, over seeds, of the unbiased MSE at the last pass. Differences are those of the lowest
seed, mean of the channels: blue is too dark, red too bright, all on one scale.
"""

import numpy

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.saving import Drawn
from photonlab.records import files, images, references
from photonlab.records.columns import as_number
from photonlab.records.files import InputError
from photonlab.statistics import errors

CELL = 1.1    # inches


def values_by_setting(scene):
    """{setting: how many values it takes} of those that take several and do not follow from another that does."""
    counts = {name: scene.rows[name].nunique() for name in scene.columns.settings if scene.rows[name].nunique() > 1}
    return {name: count for name, count in counts.items() if not set(scene.columns[name].follows) & set(counts)}


def swept_settings(scene):
    """The two settings that are swept, the one with more values first."""
    counts = values_by_setting(scene)
    if len(counts) != 2:
        raise InputError(f"expected a sweep over two settings, found {', '.join(counts) or 'none'}")
    return sorted(counts, key=counts.get, reverse=True)


def values_of(rows, column):
    """The values of a setting as text, in order of their numbers."""
    return sorted(set(rows[column]), key=lambda text: (as_number(text) is None, as_number(text), text))


def final_errors(rows, across, down):
    """(values across, values down, RMSE[down][across]) of the whole image at the last pass; NaN below resolution."""
    last = rows[(rows["component"] == "total") & (rows["pass"] == rows["pass"].max())]
    column = errors.error_column(last)
    means = last.groupby([down, across])[column].mean()
    columns, lines = values_of(last, across), values_of(last, down)
    return columns, lines, numpy.array([[errors.root(means.get((line, value), numpy.nan)) for value in columns]
                                        for line in lines])


def short(text):
    number = as_number(text)
    return text if number is None else f"{number:.3g}"


@style.drawn_of_pictures
def draw_heat_map(scene, across, down):
    """The figure of errors of the records of one scene, over two of its settings."""
    columns, lines, found = final_errors(scene.rows, across, down)
    figure, axes = style.pyplot.subplots(figsize=(0.9 + 0.75 * len(columns), 0.9 + 0.45 * len(lines)),
                                         layout="constrained")
    axes.imshow(found, cmap="viridis_r", aspect="auto", norm="log")
    least = numpy.nanmin(found)
    middle = numpy.sqrt(least * numpy.nanmax(found))
    for i, line in enumerate(found):
        for j, error in enumerate(line):
            text = "below\nresolution" if numpy.isnan(error) else errors.two_digits(error) if error >= 1e-3 else f"{error:.1e}"
            axes.text(j, i, text, ha="center", va="center", fontsize=8, color="white" if error > middle else "black",
                      fontweight="bold" if error == least else "normal")
    axes.set_xticks(range(len(columns)), [short(value) for value in columns])
    axes.set_yticks(range(len(lines)), [short(value) for value in lines])
    axes.set_xlabel(scene.columns.axis_text(across))
    axes.set_ylabel(scene.columns.axis_text(down))
    axes.set_title(f"{scene.scene}: RMSE at pass {scene.rows['pass'].max():.0f} (radiance)", loc="left")
    figure.supxlabel(errors.noise_note(scene.rows[scene.rows["component"] == "total"]), fontsize=7, color="#333333", x=0.01, ha="left")
    return figure


def final_difference(scene, rows):
    """Last snapshot minus reference of the lowest seed of these rows; None without a snapshot or a reference."""
    of_seed = rows[rows["seed"] == rows["seed"].min()]
    run = of_seed["run"].iloc[0]
    by_pass = scene.run(run).snapshots
    judge, reference = references.read_reference_of(scene, scene.run(run))
    if not by_pass or reference is None:
        return None
    image = images.read_component(by_pass[max(by_pass)], "total")
    images.require_same_size(by_pass[max(by_pass)], image, judge.halves[0], reference)
    return (image - reference).mean(axis=2)


@style.drawn_of_pictures
def draw_differences(scene, across, down):
    """The figure of differences from the reference of the same; None without any."""
    rows = scene.rows
    columns, lines = values_of(rows, across), values_of(rows, down)
    differences = {(line, value): final_difference(scene, rows[(rows[down] == line) & (rows[across] == value)])
                   for line in lines for value in columns
                   if not rows[(rows[down] == line) & (rows[across] == value)].empty}
    shown = [difference for difference in differences.values() if difference is not None]
    if not shown:
        return None
    scale = numpy.nanpercentile(numpy.abs(shown), 99)
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
    figure.supylabel(scene.columns.axis_text(down), fontsize=9)
    figure.supxlabel(scene.columns.axis_text(across), fontsize=9)
    figure.colorbar(picture, ax=grid, shrink=0.6, label="radiance − reference")
    figure.suptitle(f"{scene.scene}: difference at pass {rows['pass'].max():.0f}", fontsize=9.5, x=0.01, ha="left")
    return figure


def make(results, options):
    for scene in results.scenes():
        if scene.rows["mse"].isna().all():
            yield f"{scene.scene}: no errors were recorded (was there a reference?), so no grid"
            continue
        down, across = swept_settings(scene)
        name = files.as_file_name(scene.scene)
        yield Drawn(f"grid-{name}", draw_heat_map(scene, across, down, **options.look))
        differences = draw_differences(scene, across, down, **options.look)
        if differences is None:
            yield f"{scene.scene}: no snapshots, so no differences"
        else:
            yield Drawn(f"differences-{name}", differences)


def is_sweep(results):
    return all(len(values_by_setting(scene)) == 2 for scene in results.scenes())


COMMAND = Command(
    name="grid", draws=True, summary="a sweep over two settings: heat map and difference images", about=__doc__,
    writes="figures/grid-SCENE and differences-SCENE, .png and .pdf",
    make=make, is_for=is_sweep)
