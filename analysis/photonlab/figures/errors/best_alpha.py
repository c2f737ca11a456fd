"""Draws which alpha has the least MSE as the budget grows: a figure per scene, with a column for the whole image and for each
named region, and a row for each set of settings that the sweep of alphas was repeated with (an initial radius, say).

The line is the best alpha after each recorded pass, against the light paths emitted so far. The band holds the candidates: all
alphas that win at least 5% of the draws when groups of seeds are drawn anew (`photonlab analyse fits` writes best-alphas.csv, which is
read here). Where that is all of them, as after the first pass, when all alphas are the same image, the line has a gap.

Where the reference has it, gathered light is drawn; otherwise the whole picture.
"""

import math

import numpy
from matplotlib import lines, patches

from photonlab.command import Command, has
from photonlab.drawing import style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.records.columns import as_number
from photonlab.statistics import best_alphas

BAND = {"color": "#c9c9c9", "linewidth": 0}
LINE = {"color": "black", "marker": "o", "markeredgecolor": "white", "markeredgewidth": 0.5}


def families_of(rows, columns):
    """{label: rows} of the sweeps of one scene, named by the settings that differ among them."""
    differing = [name for name in best_alphas.family_of(columns) if rows[name].nunique() > 1]
    # What is text and follows from another that differs (auto, given) says nothing that is not said by that.
    differing = [name for name in differing if not (columns[name].type == "text" and set(columns[name].follows) & set(differing))]
    if not differing:
        return {"": rows}
    names = rows[differing].apply(lambda row: ", ".join(columns.setting_text(name, row[name]) for name in differing if row[name]),
                                  axis=1)
    labelled = {name: own for name, own in rows.groupby(names, sort=False)}
    return dict(sorted(labelled.items(), key=lambda item: [as_number(item[1][name].iloc[0]) or 0.0 for name in differing]))


def draw_panel(axes, rows, alphas):
    """One sweep in one region: a box of candidates about each pass, and the best alphas where it is not all of them."""
    rows = rows.sort_values("paths_emitted")
    paths = rows["paths_emitted"].to_numpy()
    steps = numpy.diff(numpy.log(paths)) / 2 if len(paths) > 1 else numpy.array([0.3])
    edges = numpy.exp(numpy.append(numpy.log(paths) - [*steps[:1], *steps][:len(paths)], math.log(paths[-1]) + steps[-1]))
    half = min(numpy.diff(alphas), default=0.1) / 2
    low, high = rows["candidates"].map(min).to_numpy() - half, rows["candidates"].map(max).to_numpy() + half
    axes.fill_between(numpy.repeat(edges, 2)[1:-1], numpy.repeat(low, 2), numpy.repeat(high, 2), **BAND)
    axes.plot(paths, rows["best_alpha"].where(rows["candidates"].map(len) < len(alphas)), **LINE)


@style.drawn
def draw(rows, columns):
    """The figure of one scene's rows of best-alphas.csv; None when no alpha has a probability, which takes three groups of seeds.
    `columns` are those of the records."""
    rows = rows[rows["component"] == ("gathered" if (rows["component"] == "gathered").any() else "total")]
    rows = rows[(rows["paths_emitted"] > 0) & (rows["candidates"].map(len) > 0)]
    if rows.empty:
        return None
    families, regions = families_of(rows, columns), list(dict.fromkeys(rows["region"]))
    component = rows["component"].iloc[0]
    handles = [lines.Line2D([], [], label="best alpha", **LINE),
               patches.Patch(label="candidates (5% and more)", **BAND)]
    figure, grid = panels_over_legend(
        len(families), len(regions), handles, f"{style.LIGHT_TITLES[component].capitalize()}: alpha of least mean squared "
        "error. Candidates win at least 5% of 2000 draws of groups of seeds, the same groups for all alphas.",
        panel_height=1.6 if len(families) < 3 else 1.15)
    low, high = rows["paths_emitted"].min(), rows["paths_emitted"].max()
    for (label, own), row in zip(families.items(), grid):
        alphas = sorted({*own["best_alpha"], *(alpha for listed in own["candidates"] for alpha in listed)})
        for axes, region in zip(row, regions):
            draw_panel(axes, own[own["region"] == region], alphas)
            style.logarithmic(axes.xaxis, low / 1.5, high * 1.5, most=4)
            set_titles(axes, rows["scene"].iloc[0] if axes is grid[0][0] else "", region)
        row[0].set_ylabel(f"{label}\nα" if label else "α")
    for axes in grid[-1]:
        axes.set_xlabel("light paths emitted")
    return figure


def make(results, options):
    by_scene = best_alphas.read_best(results).groupby("scene", sort=False)
    return drawn_of_scenes("best-alpha", ((scene, draw(rows, results.columns, **options.look)) for scene, rows in by_scene),
                       "no alpha has a probability, which takes three seeds, so there is nothing to draw")


COMMAND = Command(
    name="best_alpha", draws=True, summary="the figure of best-alphas.csv", about=__doc__,
    writes="figures/best-alpha-SCENE.png and .pdf",
    make=make, is_for=has(best_alphas.NAME))
