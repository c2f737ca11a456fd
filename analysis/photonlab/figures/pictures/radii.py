"""Draws which radius each method came to, pixel by pixel: a panel a kind of method, in one logarithmic scale of colours a scene.

Where radii adapt to the light, dark pixels are those where it changes: edges, shadows, caustics. A rule that is fooled shows
it here, by small radii where nothing is. Of each kind of method one is shown (--all: every one), from the initial radius that
most have, with its lowest seed and its last snapshot. Pixels that gather nothing are white.
"""

import textwrap

import numpy
from matplotlib import colors

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import filled
from photonlab.drawing.saving import Drawn
from photonlab.records import files, images, methods

COLUMNS = 4
COLOURS = "viridis"


def radius_of(file):
    """Radii (height, width) of a snapshot, NaN where there is none; None when it has no such channel."""
    radius = images.read_channels(file, ["radius"])
    if radius is None:
        return None
    return numpy.where(radius[:, :, 0] > 0, radius[:, :, 0], numpy.nan)


def shown_methods(scene, all_methods):
    """All; or of each kind the first that begins with the radius that most methods begin with, or with another."""
    if all_methods:
        return scene.labels
    footprints = scene.rows.drop_duplicates("method").set_index("method")["footprints"]
    common = footprints.value_counts().idxmax()
    shown = methods.best_of_each_kind(scene, scene.labels, lambda label: footprints[label] != common)
    return [label for label in scene.labels if label in shown]


def collect(scene, all_methods):
    """{label: radii} of the methods that have them."""
    found = {}
    for label in shown_methods(scene, all_methods):
        run = scene.run(methods.run_of(scene, label, None)["run"].iloc[0])
        radius = radius_of(run.snapshots[max(run.snapshots)]) if run and run.snapshots else None
        if radius is not None and numpy.isfinite(radius).any():
            found[label] = radius
    return found


def scale_of(radii):
    """Colours for all of them, from the smallest to the largest radius but for 1% of the pixels on either side."""
    known = numpy.concatenate([radius[numpy.isfinite(radius)] for radius in radii])
    low, high = numpy.percentile(known, [1, 99])
    return colors.LogNorm(low, high if high > low else 1.01 * low)


@style.drawn_of_pictures
def draw(title, found):
    columns = min(COLUMNS, len(found))
    rows = -(-len(found) // columns)
    height, width = next(iter(found.values())).shape
    cell = (style.FULL_WIDTH - 0.9) / COLUMNS
    figure, grid = style.pyplot.subplots(rows, columns, squeeze=False, layout="constrained",
                                         figsize=(columns * cell + 0.9, rows * (cell * height / width + 0.4) + 0.4))
    scale = scale_of(found.values())
    for axes, (label, radius) in filled(grid, list(found.items())):
        mapped = axes.imshow(radius, cmap=COLOURS, norm=scale)
        axes.set_axis_off()
        axes.set_title("\n".join(textwrap.wrap(label, 22)), fontsize=7)
    bar = figure.colorbar(mapped, ax=grid, extend="both", fraction=0.04)
    bar.set_label("radius (scene units)", fontsize=8)
    figure.suptitle(title, fontsize=9.5)
    return figure


def make(results, options):
    for scene in results.scenes():
        found = collect(scene, options.all)
        if not found:
            yield f"{scene.scene}: no snapshot that has radii"
            continue
        yield Drawn(f"radii-{files.as_file_name(scene.scene)}", draw(f"{scene.scene}: radius after the last pass", found, **options.look))


def adapt(results):
    """True where there are two rules for radii or more to compare."""
    return results.rows["schedule"].replace("", numpy.nan).nunique() > 1


def add_options(parser):
    parser.add_argument("--all", action="store_true", help="show every method, not the first one of each kind")


COMMAND = Command(
    name="radii", draws=True, summary="images of the radius that each method came to", about=__doc__,
    writes="figures/radii-SCENE, .png and .pdf", make=make, is_for=adapt, add_options=add_options)
