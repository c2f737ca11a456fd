"""Draws what emission "adaptive" has learnt: how many times as many paths as by plain emission leave each light in each cell of its
square, a panel a light, the brightest first.

The square is that of the random numbers which tell a light's rays apart: of directions, where x goes with the angle to the light's
axis (for a point light from top to bottom) and y around it; of light from one direction, of the points where it enters. Dark cells
have half of plain emission's paths, the least there is. The run is that of the lowest seed.
"""

import textwrap

import numpy
import pandas
from matplotlib import colors

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import filled
from photonlab.drawing.saving import Drawn
from photonlab.records import files, kept_files, methods, tables

FILE = "emission.csv"
COLUMNS = ["light", "kind", "square", "row", "column", "plain", "probability", "paths", "acceptances"]
MOST_LIGHTS = 8
COLOURS = "viridis"


def maps_of(run):
    """[(title, times)] of the lights of a run: times is (row, column), probability over plain probability."""
    file = kept_files.kept_file(run.folder / FILE, run.description["files"][FILE], kept_files.RUN_AGAIN)
    with kept_files.opened(file) as stream:
        rows = pandas.read_csv(stream, dtype=str, keep_default_na=False)
    tables.require_columns(file, rows, COLUMNS, "expected those of the program")
    for column in ["light", "row", "column", "plain", "probability"]:
        rows[column] = tables.to_numbers(file, rows[column])
    found = []
    for light, own in rows.groupby("light"):
        side = int(own["row"].max()) + 1
        times = numpy.full((side, side), numpy.nan)
        times[own["row"].astype(int), own["column"].astype(int)] = own["probability"] / own["plain"]
        title = f"light {light:.0f} ({own['kind'].iloc[0]}): {100 * own['probability'].sum():.3g}% of paths, " \
                f"{100 * own['plain'].sum():.3g}% by plain emission"
        found.append((own["plain"].sum(), title, own["square"].iloc[0], times))
    found.sort(key=lambda light: -light[0])
    return [(title, square, times) for _, title, square, times in found[:MOST_LIGHTS]]


@style.drawn_of_pictures
def draw(title, lights):
    columns = min(2, len(lights))
    rows = -(-len(lights) // columns)
    figure, grid = style.pyplot.subplots(rows, columns, squeeze=False, layout="constrained", figsize=(2.7 * columns + 0.9, 2.9 * rows + 0.4))
    most = max(1.0, *(numpy.nanmax(times) for _, _, times in lights))
    scale = colors.LogNorm(0.5, most)
    for axes, (name, square, times) in filled(grid, lights):
        mapped = axes.imshow(times, cmap=COLOURS, norm=scale, origin="lower", extent=(0, 1, 0, 1))
        axes.set_title("\n".join(textwrap.wrap(name, 40)), fontsize=7)
        axes.set_xlabel(f"{square}, first number", fontsize=7)
        axes.set_ylabel("second number", fontsize=7)
        axes.tick_params(labelsize=7)
    bar = figure.colorbar(mapped, ax=grid, shrink=0.8)
    ticks = [times for times in 2.0 ** numpy.arange(-1, 10) if times <= most]
    bar.set_ticks(ticks, labels=[f"{times:g}" for times in ticks], fontsize=7)
    bar.ax.minorticks_off()
    bar.set_label("paths, times those of plain emission", fontsize=7)
    figure.suptitle("\n".join(textwrap.wrap(title, 40 * columns)), fontsize=8)
    return figure


def learnt_runs(scene):
    """(label, run) of the methods that learnt."""
    for label in scene.labels:
        name = methods.run_of(scene, label, None)["run"].iloc[0]
        run = scene.run(name) if scene.has_run(name) else None
        if run and FILE in (run.description.get("files") or {}):
            yield label, run


def make(results, options):
    for scene in results.scenes():
        for index, (label, run) in enumerate(learnt_runs(scene)):
            ending = f"-{index + 1}" if index else ""
            yield Drawn(f"emission-{files.as_file_name(scene.scene)}{ending}",
                        draw(f"{scene.scene}: {label}", maps_of(run), **options.look))


def learns(results):
    """True where some run learnt."""
    return "emission" in results.rows and (results.rows["emission"] == "adaptive").any()


COMMAND = Command(
    name="emission", draws=True, summary="what emission that learns has learnt, light by light", about=__doc__,
    writes="figures/emission-SCENE, .png and .pdf", make=make, is_for=learns)
