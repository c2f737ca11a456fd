"""What photon relaxation does to photons: where they lie at the edge of a pool of light before and after, how many are on either side of
an edge, and how the number in a disc varies.

    build/release/tests/integrators/relaxation_records > results/relaxation-photons/relaxation.csv
    /usr/bin/python3 analysis relaxation results/relaxation-photons

Photons are laid by hand (tests/integrators/relaxation_records.cpp). What pictures gain is in the records of
experiments/replications/relaxation.toml.
"""

from matplotlib import lines

from photonlab.drawing import one_table, style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.records import tables

NAME = "relaxation.csv"
COLUMNS = ["kind", "stage", "x", "y"]
STAGES = {"before": "as they came", "ignored": "after 10 steps", "protected": "after 10 steps, features protected"}
LOOKS = {stage: {"color": colour, "marker": marker, "label": label}
         for (stage, label), colour, marker in zip(STAGES.items(), style.COLOURS, style.MARKERS)}
EVEN = {"color": "#999999", "linestyle": (0, (1, 1.5)), "linewidth": 1, "zorder": 1}


def read(file):
    """The rows of relaxation.csv, numbers as numbers."""
    table = tables.read_table(file)
    tables.require_columns(file, table, COLUMNS, "make it anew with relaxation_records")
    for column in ["x", "y"]:
        table[column] = tables.to_numbers(file, table[column])
    return table


def points(table, kind, stage):
    """(x, y) of one curve or cloud."""
    rows = table[(table["kind"] == kind) & (table["stage"] == stage)]
    return rows["x"], rows["y"]


def statements(table):
    """What is beyond the edge, and how counts vary, a line each."""
    for stage in STAGES:
        beyond = dict(zip(*points(table, "edge", stage)))
        counts = dict(zip(*points(table, "counts", stage)))
        if beyond and counts:
            nearest = min(place for place in beyond if place > 0)
            yield (f"{stage:10} density beyond the edge {beyond[nearest]:.3g} of the bright side's; variance over mean of counts "
                   + ", ".join(f"{counts[size]:.2g} ({size:.0f})" for size in sorted(counts)))


@style.drawn
def draw(table):
    """The figure of relaxation.csv."""
    figure, grid = panels_over_legend(
        2, 3, [lines.Line2D([], [], **look) for look in LOOKS.values()],
        "Upper row: a window of a pool of light, nine times as bright as what is around it; the dotted line is its edge. Lower row: "
        "photons in strips beside a straight edge of that contrast, in shares of what the bright side should have; variance of the "
        "number of photons in a disc over its expectation, in even light.", panel_height=1.9, same_heights=False)
    for axes, (stage, title) in zip(grid[0], STAGES.items()):
        x, y = points(table, "photon", stage)
        axes.plot(x, y, linestyle="none", marker=".", markersize=1.6, color=LOOKS[stage]["color"])
        heights = [0.6 * step / 50 for step in range(-50, 51)]
        axes.plot([(1.5 ** 2 - height ** 2) ** 0.5 for height in heights], heights, **EVEN)
        axes.set_aspect("equal")
        axes.set_xticks([])
        axes.set_yticks([])
        set_titles(axes, title.removeprefix("after 10 steps, ").capitalize())
    for stage, look in LOOKS.items():
        grid[1][0].plot(*points(table, "edge", stage), **{**look, "markersize": 3})
        grid[1][1].plot(*points(table, "counts", stage), **look)
    grid[1][0].axvline(0, **EVEN)
    grid[1][0].set_xlabel("distance from the edge")
    grid[1][0].set_ylabel("photons")
    grid[1][1].set_ylim(0, None)
    grid[1][1].set_xscale("log")
    grid[1][1].set_xlabel("photons expected in the disc")
    grid[1][1].set_ylabel("variance / expectation")
    grid[1][2].set_visible(False)
    return figure


COMMAND = one_table.command_of("relaxation", NAME, read, statements, draw, about=__doc__,
                                summary="what relaxation does to photons")
