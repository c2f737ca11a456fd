"""Compares methods at the same seconds: a table of errors, and pictures with insets at one budget.

Nothing is stopped by the clock: a method's error at a budget is interpolated between its recorded passes, on logarithmic
axes, where curves are nearly straight. Errors are means over seeds of the unbiased MSE, seconds the means of the
records, which hold passes alone. Nothing is extrapolated: a budget before a method's first pass or after its last has no error,
and the table says which ("less than one pass", "more than recorded"). "not resolved" is an error that came out at 0 or below.

The table has the whole image, and where decomposition.csv is there (`analysis decomposition`) also the experiment's named regions. The
pictures are those of the recorded pass that is nearest to the budget, which is written under them; below them stand the regions,
or without any the square with the most contrast, each exposed for itself.

Budgets are powers of two of a second that at least one method reaches; the pictures are of the last that all reach.
"""

import math
from dataclasses import dataclass

import numpy
from matplotlib import patches

from photonlab.command import Command
from photonlab.drawing import pictures, style
from photonlab.drawing.saving import save
from photonlab.records import files, images, references, tables
from photonlab.statistics import errors
from photonlab.statistics.equal_time import COLUMNS, NAME, curves_of, read_split, regions_of, table_of

INSET = 0.2    # of the picture's side
CELL = 1.9     # inches


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


def nearest_snapshot(scene, rows, seconds):
    """(image, text, file) of the recorded pass nearest to the budget, of the lowest seed."""
    of_seed = rows[(rows["seed"] == rows["seed"].min()) & (rows["component"] == "total")]
    run = of_seed["run"].iloc[0]
    times = of_seed.set_index("pass")["seconds"]
    by_pass = {number: file for number, file in scene.run(run).snapshots.items() if times.get(number, 0) > 0}
    if not by_pass:
        return None
    number = min(by_pass, key=lambda number: abs(math.log(times[number] / seconds)))
    image = images.read_component(by_pass[number], "total")
    return image, f"pass {number}, {errors.two_digits(times[number])} s", by_pass[number]


def insets_of(scene, reference, is_light):
    """{title: (left, top, right, bottom)}: the scene's regions, or the square with the most contrast."""
    height, width = reference.shape[:2]
    regions = {name: place for name, place in regions_of(scene, scene.scene).items() if place[2] <= width and place[3] <= height}
    if regions:
        return regions
    side = max(4, round(INSET * width))
    y, x = place_of_inset(reference, is_light, side)
    return {"": (x, y, x + side, y + side)}


@dataclass
class Cell:
    """A column of pictures: an image and its insets."""
    label: str
    image: numpy.ndarray
    below: str


def errors_at(table, seconds):
    """{(region, label): "RMSE 0.012"} of the whole picture at a budget, from the table."""
    return {(row["region"], row["method"]): f"RMSE {errors.two_digits(row['rmse'])}" for row in table
            if row["component"] == "total" and row["seconds"] == seconds and "rmse" in row}


def cells_of(scene, found, seconds):
    """(a cell a method with a snapshot, whether each pixel is a light, the reference); None without snapshots or a reference.
    `found` are the errors at the budget."""
    if not all(map(scene.has_run, scene.rows["run"].unique())):
        return None
    judge, reference = references.read_reference_of(scene, scene.run(scene.rows["run"].iloc[0]))
    shown = {label: nearest_snapshot(scene, scene.of_method(label), seconds) for label in scene.labels}
    shown = {label: snapshot for label, snapshot in shown.items() if snapshot}
    if reference is None or not shown:
        return None
    for image, _, file in shown.values():
        images.require_same_size(file, image, judge.halves[0], reference)
    _, _, first_file = next(iter(shown.values()))
    emission = images.read_component(first_file, "emission")
    is_light = numpy.zeros(reference.shape[:2], bool) if emission is None else emission.max(axis=2) > 0
    cells = [Cell(label, image, f"{text}\nat {seconds:g} s: {found.get(('image', label), 'not resolved')}")
             for label, (image, text, _) in shown.items()]
    return [*cells, Cell("reference", reference, "")], is_light, reference


def draw(scene, table, seconds):
    """The figure of the records of one scene: pictures at the budget with insets; None without snapshots or a reference. `table` has
    its errors."""
    found = errors_at(table, seconds)
    drawn = cells_of(scene, found, seconds)
    if drawn is None:
        return None
    cells, is_light, reference = drawn
    lit = reference * ~is_light[:, :, None]
    scale, insets = pictures.exposure_for(lit), insets_of(scene, reference, is_light)
    style.use_for_pictures()
    heights = [1.0, *((bottom - top) / (right - left) for left, top, right, bottom in insets.values())]
    figure, grid = style.pyplot.subplots(len(heights), len(cells), squeeze=False, layout="constrained",
                                         figsize=(CELL * len(cells), CELL * sum(heights) + 0.5 + 0.3 * len(heights)),
                                         height_ratios=heights)
    for cell, column in zip(cells, grid.T):
        column[0].imshow(pictures.to_srgb(cell.image, scale), interpolation="nearest")
        for axes, (name, (left, top, right, bottom)) in zip(column[1:], insets.items()):
            place = (slice(top, bottom), slice(left, right))
            axes.imshow(pictures.to_srgb(cell.image[place], pictures.exposure_for(lit[place])), interpolation="nearest")
            axes.set_xlabel(found.get((name, cell.label), ""), fontsize=7.5)
            column[0].add_patch(patches.Rectangle((left - 0.5, top - 0.5), right - left, bottom - top, fill=False,
                                                  edgecolor="white", linewidth=0.8))
        for axes in column:
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(True)
        column[0].set_title(cell.label, fontsize=9)
        column[0].set_xlabel(cell.below, fontsize=7.5)
    for axes, name in zip(grid[1:, 0], insets):
        axes.set_ylabel(name, fontsize=8)
    figure.suptitle(f"{scene.scene}: {seconds:g} s. {errors.noise_note(scene.rows)}", fontsize=9.5, x=0.01, ha="left")
    return figure


def make(results, _):
    split, table = read_split(results), []
    for scene in results.scenes():
        name = scene.scene
        if scene.rows["mse"].isna().all():
            yield f"{name}: no errors were recorded (was there a reference?), so no comparison"
            continue
        of_scene, seconds = table_of(name, curves_of(scene, None if split is None else split[split["scene"] == name]))
        table += of_scene
        if seconds is None:
            yield f"{name}: no time that all methods reach, so no pictures"
            continue
        figure = draw(scene, of_scene, seconds)
        if figure is None:
            yield f"{name}: no snapshots, so no pictures"
        else:
            yield from save(figure, results, f"equal-time-{files.as_file_name(name)}")
    yield tables.write_derived(results, NAME, COLUMNS, table)


COMMAND = Command(
    name="equal_time", summary="errors at the same seconds, with pictures and insets", about=__doc__,
    writes="equal-time.csv and figures/equal-time-SCENE, .png and .pdf",
    make=make)
