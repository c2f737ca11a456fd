"""Draws the error of every method in each named region of a scene: at the same pass, and at the same processor time.

MSE is that of decomposition.csv, of the whole light, free of the noise of seeds and reference; bars are 1.96 standard errors. The pass is
the last that all methods have. The time is the least that a method's last pass took; between recorded passes MSE is taken as a power of
the time. A method with a later first pass than that time is left out there.
"""

import numpy
from matplotlib import lines

from photonlab.command import Command, has
from photonlab.drawing import style
from photonlab.drawing.panels import filled, panels_over_legend, set_titles
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.records import methods
from photonlab.statistics import decomposition

WHOLE = "image"


def curves_of(results, scene):
    """A row a method, region and pass of one scene, with its mean processor time."""
    rows = decomposition.read_decomposition(results)
    rows = rows[(rows["scene"] == scene.scene) & (rows["component"] == "total") & (rows["region"] != WHOLE) & (rows["pass"] > 0)].copy()
    total = scene.rows[scene.rows["component"] == "total"]
    seconds = total.assign(point=total["run"].map(methods.point_of)).groupby(["point", "pass"])["cpu_seconds"].mean()
    rows["cpu_seconds"] = [seconds.get((row["point"], row["pass"]), numpy.nan) for _, row in rows.iterrows()]
    return rows


def at_pass(rows):
    """(the last pass that all methods have, {method: {region: (MSE, error)}})."""
    last = max(set.intersection(*(set(own["pass"]) for _, own in rows.groupby("method"))))
    found = rows[rows["pass"] == last]
    return last, {method: {row["region"]: (row["mse"], row["mse_error"]) for _, row in own.iterrows()}
                  for method, own in found.groupby("method")}


def at_seconds(rows):
    """(the least time of a last pass, {method: {region: (MSE, error)}}); errors are those of the recorded pass before. None and {}
    where no processor times were recorded."""
    rows = rows.dropna(subset=["cpu_seconds"])
    if rows.empty:
        return None, {}
    budget = rows.groupby("method")["cpu_seconds"].max().min()
    found = {}
    for (method, region), own in rows.groupby(["method", "region"]):
        own = own.sort_values("cpu_seconds")
        own = own[own["mse"] > 0]
        if own.empty or own["cpu_seconds"].iloc[0] > budget:
            continue
        mse = numpy.exp(numpy.interp(numpy.log(budget), numpy.log(own["cpu_seconds"]), numpy.log(own["mse"])))
        before = own[own["cpu_seconds"] <= budget].iloc[-1]
        found.setdefault(method, {})[region] = (mse, mse * before["mse_error"] / before["mse"])
    return budget, found


def draw_panel(axes, found, regions, labels, styles):
    places = numpy.arange(len(regions))
    for label in labels:
        of_method = found.get(label, {})
        mse = numpy.array([of_method.get(region, (numpy.nan, 0))[0] for region in regions], float)
        error = numpy.array([of_method.get(region, (0, numpy.nan))[1] for region in regions], float)
        shown = mse > 0
        axes.errorbar(places[shown], mse[shown], 1.96 * error[shown], elinewidth=0.8, **styles[label])
    axes.set_xticks(places, regions)
    axes.set_xlim(-0.4, len(regions) - 0.6)
    axes.set_yscale("log")


@style.drawn
def draw(scene, rows):
    """The figure of one scene and its curves_of(); None without regions."""
    if rows.empty:
        return None
    regions = list(dict.fromkeys(rows["region"]))
    styles = style.method_styles(scene)
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in scene.labels]
    last, of_pass = at_pass(rows)
    budget, of_time = at_seconds(rows)
    seeds = int(rows["seeds"].min())
    figure, grid = panels_over_legend(1, 2, handles, f"{scene.scene}: emission, direct and gathered light, {seeds} seeds, without the "
                                                     "reference's noise where it has two halves; bars: 1.96 standard errors.")
    panels = [(of_pass, f"after {int(last)} passes")] + ([(of_time, f"after {budget:.2g} s of a processor")] if of_time else [])
    for axes, (found, title) in filled(grid, panels):
        draw_panel(axes, found, regions, scene.labels, styles)
        set_titles(axes, title)
        axes.set_xlabel("region")
    grid[0][0].set_ylabel("MSE (radiance²)")
    return figure


def make(results, options):
    return drawn_of_scenes("regions", ((scene.scene, draw(scene, curves_of(results, scene), **options.look))
                                       for scene in results.scenes()),
                           "no regions are named, so there is nothing to draw by them")


COMMAND = Command(
    name="regions", draws=True, summary="error of every method by region, at the same pass and the same time", about=__doc__,
    writes="figures/regions-SCENE, .png and .pdf", make=make, is_for=has(decomposition.NAME))
