"""How long methods take to a given error: seconds to a relMSE of 0.1, 0.01 and 0.001, by wall clock and by processor, for every
scene, component and method.

A seed's curve is followed from pass to pass, with straight lines on logarithmic axes, to where it first comes down to the
threshold. A seed that is there at its first pass already took "at most" that pass: it is given the first pass's time, and the
note says for how many. A method is given the mean over its seeds with its standard error, and none if a seed never got there:
"more than the budget", with the time that was spent as `budget`.

relMSE is taken with both halves of the reference, so that its noise is not in it (`relmse_unbiased`, docs/theory.md, section 3);
the column `error` says so. Where a reference has no halves, or records are older, it is taken against the mean: then no method comes
below the mean of that mean's variance / (r^2 + 0.01), which is at most `reference_floor` / 0.01 (that of a black picture). This is
the column `floor_bound`. Where it is a tenth of a threshold or more, times may be too long by the noise, and the note says so.
"""

from matplotlib import lines

from photonlab.command import Command, positive
from photonlab.drawing import style
from photonlab.drawing.panels import name_row, panels_over_legend, set_titles
from photonlab.drawing.saving import Drawn
from photonlab.figures.errors.convergence import COMPONENT_TITLES
from photonlab.records import records, tables
from photonlab.statistics.time_to_error import CLOCKS, COLUMNS, NAME, WITH_NOISE, table_of


@style.drawn
def draw(results, table, component="total"):
    """The figure of records and their times to thresholds: a row a scene and a column a clock, of one component; None when
    nothing was reached."""
    labels = results.labels
    chosen = [row for row in table if row["component"] == component]
    reached = [row for row in chosen if "time" in row]
    if not reached:
        return None
    scenes = list(dict.fromkeys(row["scene"] for row in chosen))
    styles = style.method_styles(results)
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels]
    noise = "holds" if WITH_NOISE in {row["error"] for row in chosen} else "without"
    figure, grid = panels_over_legend(
        len(scenes), len(CLOCKS), handles, f"{COMPONENT_TITLES[component].capitalize()}. Means over seeds with standard errors; arrows: "
        f"more than the budget, which is where they start. relMSE {noise} the reference's noise.")
    thresholds = [row["threshold"] for row in chosen]
    for scene, panels in zip(scenes, grid):
        of_scene = [row for row in chosen if row["scene"] == scene]
        times = [row.get("time", row["budget"]) for row in of_scene]
        for clock, axes in zip(CLOCKS, panels):
            for place, label in enumerate(labels):
                own = [row for row in of_scene if (row["method"], row["clock"]) == (label, clock)]
                shift = 1.03 ** (place - (len(labels) - 1) / 2)    # so that arrows do not hide each other
                there = [row for row in own if "time" in row]
                axes.errorbar([row["threshold"] * shift for row in there], [row["time"] for row in there],
                              yerr=[row["time_error"] or 0.0 for row in there], **styles[label])
                for row in own:
                    if "time" not in row:
                        axes.annotate("", (row["threshold"] * shift, row["budget"] * 1.5),
                                      (row["threshold"] * shift, row["budget"]),
                                      arrowprops={"arrowstyle": "->", "color": styles[label]["color"]})
            style.logarithmic(axes.yaxis, min(times) / 1.5, max(times) * 2)
            style.logarithmic(axes.xaxis, min(thresholds) / 2, max(thresholds) * 2)
            axes.set_xticks(sorted(set(thresholds)))
            axes.invert_xaxis()
            set_titles(axes, scene if axes is panels[0] else "", CLOCKS[clock])
            axes.set_xlabel("relMSE to be reached")
        name_row(panels, "time (s)")
    return figure


def make(results, options):
    table = table_of(results, sorted(set(options.thresholds), reverse=True))
    if not table:
        yield f"{results.folder}: no relmse was recorded (was there a reference?), so no times"
        return
    yield tables.Derived(NAME, COLUMNS, table)
    figure = draw(results, table, options.component, **options.look)
    if figure is None:
        yield f"{results.folder}: no method reached a threshold, so there is nothing to draw"
    else:
        yield Drawn("time-to-error", figure)


def add_options(parser):
    parser.add_argument("--thresholds", type=positive, nargs="+", default=[1e-1, 1e-2, 1e-3], metavar="RELMSE",
                        help="errors to be reached (default: 0.1 0.01 0.001)")
    parser.add_argument("--component", choices=records.COMPONENTS, default="total", help="which light is drawn (default: total)")


COMMAND = Command(
    name="time_to_error", draws=True, summary="seconds to a given relMSE, by wall clock and by processor", about=__doc__,
    writes="time-to-error.csv and figures/time-to-error, .png and .pdf",
    make=make, add_options=add_options)
