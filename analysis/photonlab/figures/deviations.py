"""What other programs do differently, re-created on purpose beside the right update: six curves against passes.

    build/release/tests/statistical/deviation_curves > results/deviations/deviations.csv
    /usr/bin/python3 analysis deviations results/deviations

The scene is a furnace cut by a thin slab, whose answer is exact (tests/statistical/radii/deviations.h); docs/replications/deviations.md says
where each deviation is or was. Bars are one standard error over seeds, where they are larger than the mark.
"""

from matplotlib import lines

from photonlab.drawing import one_table, style
from photonlab.drawing.panels import panels_over_legend, set_titles
from photonlab.records import tables
from photonlab.records.files import InputError

NAME = "deviations.csv"
NUMBERS = ["pass", "value", "value_error", "right", "right_error"]
COLUMNS = ["deviation", "quantity", *NUMBERS]
# deviation: its panel's title, and whether what is shown goes over decades
PANELS = {"emission": ("emission shrinks with the flux", False), "cosine": ("one cosine too many", False),
          "k-th photon": ("the k-th photon counted", False), "wrong side": ("photons of the wrong side counted", True),
          "factorial": ("radius by a factorial", True), "reciprocal": ("radius as one over the pass", True)}
LOOKS = {"right": {"color": style.COLOURS[0], "marker": style.MARKERS[0], "label": "the right update"},
         "value": {"color": style.COLOURS[1], "marker": style.MARKERS[1], "label": "the deviation"}}


def read(file):
    """The rows of deviations.csv, numbers as numbers."""
    table = tables.read_table(file)
    tables.require_columns(file, table, COLUMNS, "make it anew with deviation_curves")
    for column in NUMBERS:
        table[column] = tables.to_numbers(file, table[column])
    unknown = set(table["deviation"]) - set(PANELS)
    if unknown:
        raise InputError(f"{file}: {min(unknown)}: expected one of {', '.join(PANELS)}")
    return table


def statements(table):
    """What each curve ends with, a line each."""
    for deviation, rows in table.groupby("deviation", sort=False):
        last = rows.sort_values("pass").iloc[-1]
        yield (f"{deviation:12} {last['quantity']} after {last['pass']:.0f} passes: {last['value']:.4g} ± {last['value_error']:.2g}, "
               f"right {last['right']:.4g} ± {last['right_error']:.2g}")


@style.drawn
def draw(table):
    """The figure of deviations.csv."""
    figure, grid = panels_over_legend(
        3, 2, [lines.Line2D([], [], **look) for look in LOOKS.values()],
        "A furnace cut by a thin slab, photons and map of the program; in shares of the right answer, squared radii in shares of the "
        "first. Mean over seeds and points, with one standard error over seeds.", panel_height=1.5, same_heights=False)
    for axes, (deviation, (title, over_decades)) in zip(grid.flat, PANELS.items()):
        rows = table[table["deviation"] == deviation].sort_values("pass")
        if rows.empty:
            axes.set_visible(False)
            continue
        for column, look in LOOKS.items():
            axes.errorbar(rows["pass"], rows[column], rows[f"{column}_error"], **look)
        style.logarithmic(axes.xaxis, 1 / 1.3, rows["pass"].max() * 1.3)
        values = [*rows["value"], *rows["right"]]
        if over_decades:
            style.logarithmic(axes.yaxis, min(values) / 1.5, max(values) * 1.5)
        set_titles(axes, title)
        axes.set_xlabel("passes")
        axes.set_ylabel(rows["quantity"].iloc[0])
    return figure


COMMAND = one_table.command_of("deviations", NAME, read, statements, draw, about=__doc__,
                                summary="what other programs do differently, beside the right update")
