"""How every figure looks: made for the column of a paper, for readers who do not see all colours, and for a printer
that has none. So a method has a colour, a marker and a line of its own, and each alone nearly tells it.

Colours: Okabe and Ito 2008, "Color Universal Design", with a grey in place of the yellow, which a white page swallows.
"""

import itertools
import math

import matplotlib

from photonlab.records import methods

matplotlib.use("Agg")    # draws to files and never opens a window

import matplotlib.pyplot as pyplot
from matplotlib import ticker

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9", "#E69F00", "#8A8A8A"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "*", "p"]
# A row an integrator, in the order in which the program lists them; in it one pattern for each of its modes or schedules.
PATTERNS = [[(0, (5, 1.5)), (0, (5, 1.5, 1, 1.5)), (0, (5, 1.5, 1, 1.5, 1, 1.5))],
            ["solid", (0, (9, 1.2, 1.2, 1.2)), (0, (9, 1.2, 1.2, 1.2, 1.2, 1.2)), (0, (9, 1.2, 3, 1.2))],
            [(0, (1, 1.2)), (0, (1, 2.4))],
            [(0, (3, 1)), (0, (3, 1, 1, 1)), (0, (3, 1, 1, 1, 1, 1)), (0, (3, 1, 3, 3))]]

LIGHT_TITLES = {"gathered": "gathered light", "total": "whole picture"}    # what figures of bias and variance are of
BELOW_MARK = {"linestyle": "none", "marker": 7, "markersize": 4.5, "zorder": 5}    # of what is below resolution; 7: points down
DIFFERENCE_COLOURS = "PuOr_r"    # both ends dark, zero white: in grey the size of an error stays, its sign goes
FULL_WIDTH = 6.6    # inches; text of 9 points can still be read where the page shrinks it to a column


def use():
    pyplot.rcdefaults()
    pyplot.rcParams.update({
        "font.family": "sans-serif", "font.size": 9, "axes.titlesize": 9.5, "axes.labelsize": 9, "legend.fontsize": 8.5,
        "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "axes.linewidth": 0.7, "axes.spines.top": False,
        "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.5,
        "axes.axisbelow": True, "lines.linewidth": 1.4, "lines.markersize": 5, "legend.frameon": False,
        "savefig.dpi": 300, "pdf.fonttype": 42,
    })


def use_for_pictures():
    use()
    pyplot.rcParams["axes.grid"] = False


def pattern(kind, columns):
    """The line of a kind of method (methods.kind_of), by the places of its values in their lists: solid for PPM, dashed for PM."""
    first, *others = [place_of(value, columns[name]) for name, value in kind]
    row = PATTERNS[first % len(PATTERNS)]
    return row[sum(others) % len(row)]


def place_of(value, column):
    """Among the values that are listed; behind them what is not."""
    return list(column.values).index(value) if value in column.values else len(column.values)


def method_styles(records):
    """Line settings by label. Patterns go by kind of method, so that PM and PPM are told apart at a glance. A sweep,
    more than four methods of one kind, goes from dark to light in their order; all else has 8 colours. With 11 markers
    no pair comes again before the 89th method."""
    first_rows = records.rows.drop_duplicates("method").set_index("method")
    kinds = [methods.kind_of(first_rows.loc[label], records.columns) for label in records.labels]
    single_colours = itertools.cycle(COLOURS)
    sweep_colours = {kind: iter(pyplot.cm.viridis([0.88 * step / (kinds.count(kind) - 1)
                                                   for step in range(kinds.count(kind))]))
                     for kind in set(kinds) if kinds.count(kind) > 4}
    return {label: {"color": matplotlib.colors.to_hex(next(sweep_colours.get(kind, single_colours))), "marker": marker,
                    "linestyle": pattern(kind, records.columns), "markeredgecolor": "white", "markeredgewidth": 0.5}
            for label, kind, marker in zip(records.labels, kinds, itertools.cycle(MARKERS))}


def marked_places(places, most=9):
    """Indices of at most `most` of the sorted places, evenly spread on a logarithmic axis, with both ends."""
    if len(places) <= most:
        return list(range(len(places)))
    low, high = math.log(places[0]), math.log(places[-1])
    wanted = [low + (high - low) * step / (most - 1) for step in range(most)]
    return sorted({min(range(len(places)), key=lambda i: abs(math.log(places[i]) - target)) for target in wanted})


def logarithmic(axis, low, high, base_two=False, most=6):
    """Makes an axis logarithmic from low to high, with as many labels as have room (`most`, or 8 powers of two), all as
    plain numbers where they are short."""
    (axis.axes.set_xscale if axis.axis_name == "x" else axis.axes.set_yscale)("log")
    (axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim)(low, high)
    if base_two:
        powers = [2 ** power for power in range(64) if low <= 2 ** power <= high]
        ticks = every_nth(powers, most=8)
    else:
        finer = []
        for digits in [(1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)]:
            ticks = [digit * 10.0 ** power for power in range(-30, 31) for digit in digits
                     if low <= digit * 10.0 ** power <= high]
            if len(ticks) <= most:
                break
            finer = ticks
        ticks = every_nth(ticks if len(ticks) > 2 else finer or ticks, most)
    if len(ticks) < 3:    # a short way on a logarithmic axis is nearly a linear one
        ticks = [tick for tick in ticker.MaxNLocator(4).tick_values(low, high) if low <= tick <= high]
    axis.set_major_locator(ticker.FixedLocator(ticks))
    axis.set_minor_locator(ticker.NullLocator())
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: short_number(value)))


def every_nth(values, most):
    return values[::max(1, -(-len(values) // most))]


def short_number(value):
    """0.002, 30, 65536, 10⁻⁶."""
    if 1e-3 <= abs(value) < 1e5:
        return f"{value:.6g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if mantissa == "1" else f"${mantissa}\\cdot{power}$"
