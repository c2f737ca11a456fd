"""Draws how error falls: RMSE against passes and against seconds, for every scene of an experiment; or with --against against the
light paths emitted or the memory of photons and hit points.

A line is the root of the mean, over seeds, of the MSE: of the unbiased one where the reference has two halves, so
that the reference's own noise drops out (E[(x-A)(x-B)] is the true MSE). Its band goes from the least to the largest
seed. What comes out at 0 or below is less than the reference can resolve; a logarithmic axis has no place for it, so it
is marked at the bottom and not dropped. The upper row is the whole image; the lower one the gathered light alone, whose
slope the Monte Carlo noise of sampled direct light would otherwise hide.

With --metric a line is the mean over seeds of that column of iterations.csv as it is, with what it holds of the reference's noise.
"""

import math

from matplotlib import lines
from matplotlib.transforms import blended_transform_factory

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import name_row, panels_over_legend, set_titles
from photonlab.drawing.places import AXES
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.records import records
from photonlab.statistics import errors

COMPONENT_TITLES = {"total": "whole image", "emission": "emission alone", "direct": "direct light alone",
                    "gathered": "gathered light alone"}
COMPONENTS, AGAINST = ["total", "gathered"], ["passes", "seconds"]    # what is drawn unless something else is asked for
FLOOR_LINE = {"color": "#555555", "linewidth": 0.8, "linestyle": (0, (4, 3)), "zorder": 1}
FARTHEST_FLOOR = 30.0   # a floor that many times below the least error is told, not drawn: it would flatten the curves


def curves_of(scene, rows, column):
    """Curves by label, without pass 0 (emission and direct light alone: a logarithmic axis has no place for it)."""
    curves = {}
    for label in scene.labels:
        curve = errors.aggregate_over_seeds(rows[rows["method"] == label], column)
        curve = curve[(curve.index > 0) & curve["mean"].notna()]
        if not curve.empty:
            curves[label] = curve
    return curves


def vertical_range(curves, error, floor):
    """Limits of the axis of errors: all lines, and the floor where it is near. A band may leave at the bottom: its least
    seed can come out next to 0 by chance."""
    seen = [error.shown(value) for curve in curves.values() for column in ["mean", "largest"]
            for value in curve[column] if value > 0 and math.isfinite(value)]
    if floor and (not seen or floor > min(seen) / FARTHEST_FLOOR):
        seen.append(floor)
    if not seen:
        return None
    low, high = min(seen), max(seen)
    margin = max((high / low) ** 0.06, 1.1)
    return low / margin ** 1.5, high * margin


def draw_panel(axes, curves, styles, against, error, limits, floor):
    """One panel: the error against one of AXES."""
    bottom = limits[0]
    at_bottom = blended_transform_factory(axes.transData, axes.transAxes)
    places = []
    methods_below = 0    # each has a row of marks of its own
    for label, curve in curves.items():
        x = AXES[against].of(curve)
        x, curve = x[x > 0], curve[x > 0]
        if not len(x):    # path tracing emits no photons
            continue
        places += list(x)
        look = styles[label]
        if (curve["seeds"] > 1).any():
            low, high = [[value if value > bottom else bottom for value in map(error.shown, curve[column])]
                         for column in ["least", "largest"]]
            axes.fill_between(x, low, high, color=look["color"], alpha=0.2, linewidth=0)
        shown = curve["mean"].map(error.shown).where(curve["mean"] > 0)
        axes.plot(x, shown, label=label, markevery=style.marked_places(list(x)), **look)
        below = x[curve["mean"] <= 0]
        if len(below):
            marked = [below[i] for i in style.marked_places(list(below))]
            axes.plot(marked, [0.035 + 0.04 * methods_below] * len(marked), transform=at_bottom, color=look["color"],
                      **style.BELOW_MARK)
            methods_below += 1
    if floor and limits[0] <= floor <= limits[1]:
        axes.axhline(floor, **FLOOR_LINE)
    if places:
        low, high = min(places), max(places)
        margin = max((high / low) ** 0.04, 1.05)
        style.logarithmic(axes.xaxis, low / margin, high * margin, base_two=against == "passes")
    style.logarithmic(axes.yaxis, *limits)
    axes.set_xlabel(AXES[against].title)


def notes(rows, error, floors):
    """What a reader has to know to read the figure, in one paragraph."""
    seeds = rows.groupby("method")["seed"].nunique()
    count = f"{seeds.min()}" if seeds.min() == seeds.max() else f"{seeds.min()} to {seeds.max()}"
    is_root = error.shown is errors.root
    text = []
    if seeds.max() > 1:
        text.append(f"Line: {'root of the ' if is_root else ''}mean {error.name} over {count} seeds; band: least to largest seed.")
    else:
        text.append(f"Line: {'root of the ' if is_root else ''}{error.name} of one seed.")
    if is_root:
        text.append(errors.noise_note(rows))
    if floors:
        hidden = [f"{errors.two_digits(floor)} ({COMPONENT_TITLES[component]})" for component, floor in floors.items()]
        text.append(f"Floor of the reference, below the axis: RMSE {', '.join(hidden)}.")
    if (rows["direct"] == "photons").any():
        text.append("Where photons carry direct light, gathered light is judged against direct + gathered.")
    nonfinite = rows[(rows["component"] == "total") & (rows["nonfinite"] > 0)]
    if not nonfinite.empty:
        text.append(f"Up to {nonfinite['nonfinite'].max():.0f} pixels that are not finite are left out.")
    return " ".join(filter(None, text))


def panels_of(scene, metric, components):
    """[(component, error, floor, curves, limits)] of what can be drawn of a scene, a row each."""
    panels = []
    for component in components:
        rows = scene.rows[(scene.rows["component"] == component) & (scene.rows["pass"] > 0)]
        error = errors.metric(metric) if metric else errors.rmse(rows)
        # The floor is that of a mean squared error.
        floor = math.nan if metric else errors.root(rows["reference_floor"].max())
        curves = curves_of(scene, rows, error.column)
        limits = vertical_range(curves, error, 0.0 if math.isnan(floor) else floor)
        if curves and limits:
            panels.append((component, error, floor, curves, limits))
    return panels


@style.drawn
def draw(scene, metric=None, components=COMPONENTS, against=AGAINST):
    """The figure of the records of one scene, a row a component and a column an axis; None when nothing in it can be drawn. `metric`
    is the name of one, if it is not RMSE that is to be drawn."""
    metric = errors.metric_named(scene.columns, metric) if metric else None
    styles, panels = style.method_styles(scene), panels_of(scene, metric, components)
    if not panels:
        return None
    drawn = [label for label in scene.labels if any(label in curves for *_, curves, _ in panels)]
    hidden_floors = {component: floor for component, _, floor, _, (low, _) in panels if 0 < floor < low}
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in drawn]
    if any(low <= floor <= high for *_, floor, _, (low, high) in panels):
        handles.append(lines.Line2D([], [], label="floor of the reference", **FLOOR_LINE))
    if any((curve["mean"] <= 0).any() for *_, curves, _ in panels for curve in curves.values()):
        handles.append(lines.Line2D([], [], label="below resolution (≤ 0)", color="#555555", **style.BELOW_MARK))
    caption = notes(scene.rows[scene.rows["pass"] > 0], panels[0][1], hidden_floors)

    figure, grid = panels_over_legend(len(panels), len(against), handles, caption)
    for (component, error, floor, curves, limits), row in zip(panels, grid):
        for axes, horizontal in zip(row, against):
            draw_panel(axes, curves, styles, horizontal, error, limits, floor)
        name_row(row, error.axis)
        set_titles(row[0], f"{scene.scene}: {COMPONENT_TITLES[component]}")
    return figure


def make(results, options):
    nothing = "no errors were recorded (was there a reference?), so no convergence plot"
    figures = ((scene.scene, draw(scene, options.metric, options.components, options.against, **options.look))
               for scene in results.scenes())
    return drawn_of_scenes("convergence", figures, nothing, f"-{options.metric}" if options.metric else "")


def add_options(parser):
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=COMPONENTS, help="which light, a row each "
                        "(default: total gathered)")
    parser.add_argument("--against", choices=AXES, nargs="+", default=AGAINST, help="horizontal axes, a column each (default: passes "
                        "seconds)")
    parser.add_argument("--metric", metavar="COLUMN", help="a metric of iterations.csv, relmse for instance (default: RMSE)")


COMMAND = Command(
    name="convergence", draws=True, about=__doc__,
    summary="RMSE against passes and against seconds, for every scene; --metric draws another error",
    writes="figures/convergence-SCENE.png and .pdf (convergence-SCENE-METRIC for another metric)",
    make=make, add_options=add_options)
