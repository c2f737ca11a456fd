"""What each setting buys and costs: an experiment with a method that is named `default` and others that change one setting of it
each is turned into a table, a list in words and a figure per scene. There may be several defaults (`default-nearest`, say): a
method is compared with the one that it differs least from.

The knobs are found from the records: they are the settings in which a method differs from its default, less what follows from
another one (hit points from samples a pixel, say). Error is the RMSE of the last pass, the root of the mean over seeds of the
unbiased MSE of the whole picture; time is the mean over seeds of its seconds, by wall clock or, with --clock cpu_seconds, of the
processor, which other programs of a busy machine disturb less. Ratios to the default are taken over the seeds that
both have, which are the same photons where the setting leaves them the same. Standard errors are those of the jackknife over
seeds, of ratios on logarithmic axes; intervals are 95% by Student's distribution. Of many intervals one in twenty misses.

The figure draws error against seconds. A method is on the Pareto front when none is both faster and more accurate; neighbours on
it may be so by chance, which their error bars tell.
"""

import numpy
from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.drawing.saving import RECORDS, drawn_of_scenes
from photonlab.records import tables
from photonlab.records.columns import as_number
from photonlab.statistics import errors
from photonlab.statistics.tradeoff import (CLOCKS, COLUMNS, DEFAULT, NAME, defaults_of, is_default, points_of, table_of, words)

BLACK = {"color": "black", "markersize": 8}
BLACK_MARKERS = [{"marker": "o"}, {"marker": "s"}, {"marker": "^"}]
FRONT = {"color": "#888888", "linewidth": 3, "alpha": 0.5, "zorder": 1}


@style.drawn
def draw(table, columns, clock, noise):
    """The figure of the table of one scene: error against seconds, a line a knob through the default, and the Pareto front under them.
    None when nothing is resolved. `columns` are those of the records."""
    table = [row for row in table if row["rmse"] > 0]
    if not table:
        return None
    defaults = {row["point"]: row for row in table if is_default(row)}
    knobs = list(dict.fromkeys((row["default"], row["knob"] or row["point"]) for row in table if not is_default(row)))
    looks = {knob: {"color": style.COLOURS[place % len(style.COLOURS)], "marker": style.MARKERS[place % len(style.MARKERS)],
                    "linestyle": "-" if knob[0] == DEFAULT else "--", "linewidth": 0.8} for place, knob in enumerate(knobs)}
    names = {knob: ", ".join(columns.name_of(name) for name in knob[1].split(", "))
             for knob in knobs}
    handles = [lines.Line2D([], [], label=names[knob] + (f" ({knob[0]})" if len(defaults) > 1 and knob[0] != DEFAULT else ""),
                            **looks[knob]) for knob in knobs]
    handles += [lines.Line2D([], [], label=name, linestyle="none", **BLACK, **BLACK_MARKERS[place % len(BLACK_MARKERS)])
                for place, name in enumerate(defaults)]
    handles.append(lines.Line2D([], [], label="Pareto front", **FRONT))
    figure, [[axes]] = panels_over_legend(1, 1, handles, "Bars: standard errors over seeds. A line joins the values of one "
                                          f"setting; the rest is as in its default. {noise}", panel_height=3.4)
    for knob in knobs:
        of_knob = [row for row in table if not is_default(row) and (row["default"], row["knob"] or row["point"]) == knob]
        line = sorted(of_knob + [defaults[name] for name in [knob[0]] if name in defaults],
                      key=lambda row: as_number(of_knob[0]["default_value"] if is_default(row) else row["value"]) or 0.0)
        axes.plot([row["seconds"] for row in line], [row["rmse"] for row in line],
                  **{**looks[knob], "marker": "none"})
        axes.errorbar([row["seconds"] for row in of_knob], [row["rmse"] for row in of_knob],
                      xerr=[numpy.nan_to_num(row["seconds_error"]) for row in of_knob],
                      yerr=[numpy.nan_to_num(row["rmse_error"]) for row in of_knob], **{**looks[knob], "linestyle": "none"})
        for row in of_knob:
            axes.annotate(row["shown"], (row["seconds"], row["rmse"]), (4, 4), textcoords="offset points", fontsize=7,
                          color=looks[knob]["color"])
    for place, row in enumerate(defaults.values()):
        axes.errorbar(row["seconds"], row["rmse"], xerr=numpy.nan_to_num(row["seconds_error"]),
                      yerr=numpy.nan_to_num(row["rmse_error"]), zorder=4, **BLACK, **BLACK_MARKERS[place % len(BLACK_MARKERS)])
    front = sorted((row for row in table if row["pareto"]), key=lambda row: row["seconds"])
    axes.plot([row["seconds"] for row in front], [row["rmse"] for row in front], **FRONT)
    for axis, column in [(axes.xaxis, "seconds"), (axes.yaxis, "rmse")]:
        low, high = min(row[column] for row in table), max(row[column] for row in table)
        margin = max((high / low) ** 0.08, 1.1)
        style.logarithmic(axis, low / margin, high * margin)
    axes.set_xlabel(f"time of all passes ({CLOCKS[clock]})")
    axes.set_ylabel("RMSE (radiance)")
    set_titles(axes, table[0]["scene"])
    return figure


def make(results, options):
    clock, scenes = options.clock, results.scenes()
    of_scenes = [table_of(scene, clock) for scene in scenes]
    yield tables.Derived(NAME, COLUMNS, [row for table in of_scenes for row in table])
    noise = errors.noise_note(results.rows[results.rows["component"] == "total"])
    text = f"{words(of_scenes, clock, noise)}\n<!-- {RECORDS} {results.hash} -->\n"
    yield tables.Words("tradeoff.md", text)
    figures = ((scene.scene, draw(table, results.columns, clock, noise, **options.look)) for scene, table in zip(scenes, of_scenes))
    yield from drawn_of_scenes("tradeoff", figures, "nothing is resolved, so there is nothing to draw")


def has_default(results):
    return all(defaults_of(points_of(scene)) for scene in results.scenes())


def add_options(parser):
    parser.add_argument("--clock", choices=CLOCKS, default="seconds", help="what time is taken from (default: seconds)")


COMMAND = Command(
    name="tradeoff", draws=True, summary="what each setting buys and costs beside a method named default", about=__doc__,
    writes="tradeoff.csv, tradeoff.md and figures/tradeoff-SCENE, .png and .pdf",
    make=make, is_for=has_default, add_options=add_options)
