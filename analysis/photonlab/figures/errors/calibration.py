"""Is an error that is estimated without a reference right? The share of pixels whose true error lies within the bounds of 50% and
90%, against passes, a panel a scene. A method whose estimates are right follows the dotted lines; below them it says that it knows
more than it does.

Only pixels that photons reached count, from the second pass on. Lines are means over seeds, bands their smallest and largest.
"""

from matplotlib import lines

from photonlab.command import Command
from photonlab.drawing import style
from photonlab.drawing.panels import filled, name_row, panels_over_legend, set_titles
from photonlab.drawing.saving import Drawn

BOUNDS = {"within_50": 0.5, "within_90": 0.9}


def known_rows(results):
    """Rows of gathered light for which both shares are recorded."""
    rows = results.rows
    if not set(BOUNDS) <= set(rows.columns):
        return rows.iloc[:0]
    rows = rows[rows["component"] == "gathered"]
    return rows[(rows["within_50"].astype(str) != "") & rows["within_50"].notna()]


@style.drawn
def draw(results, rows):
    scenes = list(dict.fromkeys(rows["scene"]))
    labels = list(dict.fromkeys(rows["method"]))
    styles = style.method_styles(results)
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels]
    columns = min(3, len(scenes))
    figure, grid = panels_over_legend(-(-len(scenes) // columns), columns, handles,
                                      "Share of pixels whose true error lies within the bounds of 50% and 90% (dotted).")
    for axes, scene in filled(grid, scenes):
        for label in labels:
            own = rows[(rows["scene"] == scene) & (rows["method"] == label)]
            for column in BOUNDS:
                shares = own.assign(share=own[column].astype(float)).groupby("pass")["share"]
                passes = [int(number) for number in shares.mean().index]
                axes.fill_between(passes, shares.min(), shares.max(), color=styles[label]["color"], alpha=0.2, linewidth=0)
                axes.plot(passes, shares.mean(), markevery=style.marked_places(passes), **styles[label])
        for share in BOUNDS.values():
            axes.axhline(share, color="#555555", linestyle=":", linewidth=0.8)
        axes.set_xscale("log", base=2)
        axes.set_ylim(0, 1)
        set_titles(axes, scene)
        axes.set_xlabel("pass")
    for panels in grid:
        name_row(panels, "share of pixels")
    return figure


def make(results, options):
    rows = known_rows(results)
    yield Drawn("calibration", draw(results, rows, **options.look))


COMMAND = Command(
    name="calibration", draws=True, summary="whether errors that are estimated without a reference are right", about=__doc__,
    writes="figures/calibration, .png and .pdf", make=make, is_for=lambda results: not known_rows(results).empty)
