"""Draws what methods keep in memory: bytes of photon map and hit points against the light paths emitted, a figure per scene.

PM keeps every photon until it gathers, PPM those of a pass. Photons with their index count at their largest so far, as the mean
over seeds; what the process needs besides is in the records' `peak_rss_mib`. Methods with the same bytes share a line.
"""

from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.drawing.places import AXES, MEBIBYTE
from photonlab.drawing.saving import drawn_of_scenes

MEASURED = ["paths_emitted", "map_bytes", "hit_point_bytes"]


def curve_of(rows):
    """Mean over seeds of the MiB after each pass, by light paths; empty for a method that emits none."""
    rows = rows[(rows["component"] == "total") & (rows["pass"] > 0)].dropna(subset=MEASURED)
    means = rows.groupby("pass")[MEASURED].mean()
    means = means[means["paths_emitted"] > 0]
    return means.set_index("paths_emitted").sum(axis=1) / MEBIBYTE


def lines_of(scene):
    """[(labels, curve)]: methods whose bytes are the same share one."""
    drawn = []
    for label in scene.labels:
        curve = curve_of(scene.of_method(label))
        if curve.empty:
            continue
        same = next((own for own, other in drawn if curve.equals(other)), None)
        if same is None:
            drawn.append(([label], curve))
        else:
            same.append(label)
    return drawn


def shared_name(labels):
    """What the labels of methods have in common: "PPM (3 settings)"; or the first, and how many more."""
    parts = [label.split(", ") for label in labels]
    common = [part for part in parts[0] if all(part in others for others in parts)]
    if len(labels) == 1:
        return labels[0]
    return f"{', '.join(common)} ({len(labels)} settings)" if common else f"{labels[0]} and {len(labels) - 1} more"


@style.drawn
def draw(scene):
    """The figure of the records of one scene; None when no method of it emits photons."""
    drawn = lines_of(scene)
    if not drawn:
        return None
    styles = style.method_styles(scene)
    looks = [{**styles[own[0]], "label": shared_name(own)} for own, _ in drawn]
    figure, [[axes]] = panels_over_legend(
        1, 1, [lines.Line2D([], [], **look) for look in looks], "Photons with their index, at their largest so far, and hit points "
        "with their statistics; means over seeds.", panel_height=2.4)
    for look, (_, curve) in zip(looks, drawn):
        axes.plot(curve.index, curve, markevery=style.marked_places(list(curve.index)), **look)
    for axis, values in [(axes.xaxis, [place for _, curve in drawn for place in curve.index]),
                         (axes.yaxis, [value for _, curve in drawn for value in curve if value > 0])]:
        style.logarithmic(axis, min(values) / 1.2, max(2 * min(values), *values) * 1.1)
    axes.set_xlabel(AXES["photons"].title)
    axes.set_ylabel(AXES["memory"].title)
    set_titles(axes, scene.scene)
    return figure


def make(results, options):
    return drawn_of_scenes("memory", ((scene.scene, draw(scene, **options.look)) for scene in results.scenes()),
                       "no method emits photons, so there is nothing to draw")


COMMAND = Command(
    name="memory", draws=True, summary="bytes of photons and hit points against light paths", about=__doc__,
    writes="figures/memory-SCENE.png and .pdf",
    make=make)
