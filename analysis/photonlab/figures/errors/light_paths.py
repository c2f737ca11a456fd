"""Draws what light paths cost and bring, for methods that choose them: error of the gathered light against the paths that were
traced and against processor time, the share of paths that are seen, and the share of mutations that were accepted, against passes.

A path that is seen costs up to two that are traced, beside those that were tried before the first of a pass, and each is looked up
among the hit points: so paths emitted are no measure of it. RMSE is the root of the mean over seeds, without the reference's noise
where it has two halves; its bar is one standard error of that mean. Shares are those of the last pass, means over seeds: with emission
"adaptive" the paths seen are of those emitted, which learning raises; with visible paths of the uniform ones.
"""

import numpy
from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.statistics import errors

COSTS = {"paths_traced": "light paths traced", "cpu_seconds": "processor time (s)"}
SHARES = {"paths_seen": "share of paths seen", "mutations_accepted": "share of mutations accepted"}


def error_curve(rows, column):
    """By pass: mean costs, and mean squared error with its standard error over seeds."""
    passes = rows[rows["pass"] > 0].groupby("pass")
    curve = passes[list(COSTS)].mean()
    curve["mean"] = passes[column].mean()
    curve["deviation"] = passes[column].std() / numpy.sqrt(passes.size())
    return curve[curve["mean"] > 0]


def draw_errors(panels, scene, styles):
    """The upper row; the limits of its errors."""
    gathered = scene.rows[scene.rows["component"] == "gathered"]
    column = errors.error_column(gathered)
    seen = []
    for label in scene.labels:
        curve = error_curve(gathered[gathered["method"] == label], column)
        middle = numpy.sqrt(curve["mean"])
        bars = (curve["deviation"] / (2 * middle)).fillna(0)    # of a root
        seen += list(middle)
        for axes, cost in zip(panels, COSTS):
            shown = curve[cost] > 0
            axes.errorbar(curve[cost][shown], middle[shown], bars[shown], elinewidth=0.8,
                          markevery=style.marked_places(list(curve[cost][shown])), **styles[label])
    for axes, (cost, title) in zip(panels, COSTS.items()):
        costs = gathered[cost][(gathered["pass"] > 0) & (gathered[cost] > 0)]
        if not costs.empty:
            style.logarithmic(axes.xaxis, costs.min() / 1.15, costs.max() * 1.15)
        axes.set_xlabel(title)
    if seen:
        style.logarithmic(panels[0].yaxis, min(seen) / 1.2, max(seen) * 1.2)
    panels[0].set_ylabel(errors.rmse(gathered).axis)
    set_titles(panels[0], f"{scene.scene}: gathered light")


def draw_shares(panels, scene, styles):
    """The lower row."""
    total = scene.rows[(scene.rows["component"] == "total") & (scene.rows["pass"] > 0)]
    seen = []
    for axes, (share, title) in zip(panels, SHARES.items()):
        for label in scene.labels:
            curve = total[total["method"] == label].groupby("pass")[share].mean().dropna()
            curve = curve[curve > 0]
            seen += list(curve)
            axes.plot(curve.index, curve, markevery=style.marked_places(list(curve.index)), **styles[label])
        style.logarithmic(axes.xaxis, 1 / 1.1, max(2, total["pass"].max()) * 1.1, base_two=True)
        axes.set_xlabel("pass")
        set_titles(axes, title)
    if seen:
        style.logarithmic(panels[0].yaxis, min(seen) / 1.3, max(seen) * 1.3)
    panels[0].set_ylabel("share")


@style.drawn
def draw(scene):
    """The figure of the records of one scene; None where nothing of it was judged."""
    if scene.rows["mse"].isna().all():
        return None
    styles = style.method_styles(scene)
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in scene.labels]
    seeds = scene.rows.groupby("method")["seed"].nunique().min()
    figure, grid = panels_over_legend(2, 2, handles,
                                      f"Means over {seeds} seeds; bars: one standard error. {errors.noise_note(scene.rows)} "
                                      "Shares are of the last pass.")
    draw_errors(grid[0], scene, styles)
    draw_shares(grid[1], scene, styles)
    return figure


def make(results, options):
    return drawn_of_scenes("light-paths", ((scene.scene, draw(scene, **options.look)) for scene in results.scenes()),
                           "no errors were recorded (was there a reference?), so there is nothing to draw")


def chooses_paths(results):
    """True where some method says which share of its paths is seen."""
    return "paths_seen" in results.rows and results.rows["paths_seen"].notna().any()


COMMAND = Command(
    name="light_paths", draws=True, summary="error against light paths traced, and the shares of paths that are seen", about=__doc__,
    writes="figures/light-paths-SCENE, .png and .pdf", make=make, is_for=chooses_paths)
