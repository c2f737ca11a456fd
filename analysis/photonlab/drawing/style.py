"""How every figure looks: made for the column of a paper, for readers who do not see all colours, and for a printer
that has none. So a method has a colour, a marker and a line of its own, and each alone nearly tells it.

Colours: Okabe and Ito 2008, "Color Universal Design", with a grey in place of the yellow, which a white page swallows.
"""

import functools
import itertools
import math

import matplotlib
import matplotlib.pyplot as pyplot
from matplotlib import ticker
from matplotlib.font_manager import FontProperties

from photonlab.drawing import text
from photonlab.records import files, methods
from photonlab.records.files import InputError

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9", "#E69F00", "#8A8A8A"]
FILLED = {"markeredgecolor": "white", "markeredgewidth": 0.5}
HOLLOW = {"markerfacecolor": "white", "markeredgewidth": 1.0}    # every other method of a kind, so that grey tells neighbours apart
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "*", "p"]
# A row an integrator, in the order in which the program lists them; in it one pattern for each of its modes or schedules.
PATTERNS = [[(0, (5, 1.5)), (0, (5, 1.5, 1, 1.5)), (0, (5, 1.5, 1, 1.5, 1, 1.5))],
            ["solid", (0, (9, 1.2, 1.2, 1.2)), (0, (9, 1.2, 1.2, 1.2, 1.2, 1.2)), (0, (9, 1.2, 3, 1.2))],
            [(0, (1, 1.2)), (0, (1, 2.4))],
            [(0, (3, 1)), (0, (3, 1, 1, 1)), (0, (3, 1, 1, 1, 1, 1)), (0, (3, 1, 3, 3))]]

LIGHT_TITLES = {"gathered": "gathered light", "total": "whole picture", "direct": "direct light",
                "emission": "emission"}    # what figures of bias and variance are of
BELOW_MARK = {"linestyle": "none", "marker": 7, "markersize": 4.5, "zorder": 5}    # of what is below resolution; 7: points down
DIFFERENCE_COLOURS = "PuOr_r"    # both ends dark, zero white: in grey the size of an error stays, its sign goes
FULL_WIDTH = 6.6    # inches; text of 9 points can still be read where the page shrinks it to a column


SETTINGS = {
    "font.family": "sans-serif", "font.size": 9, "axes.titlesize": 9.5, "axes.labelsize": 9, "legend.fontsize": 8.5,
    "xtick.labelsize": 8.5, "ytick.labelsize": 8.5, "axes.linewidth": 0.7, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.5,
    "axes.axisbelow": True, "lines.linewidth": 1.4, "lines.markersize": 5, "legend.frameon": False,
    "savefig.dpi": 300, "pdf.fonttype": 42, "figure.figsize": (FULL_WIDTH, 4.0),
}
# Of a figure that is given its width: it is not shrunk any more, so its text is that of captions.
SETTINGS_AT_WIDTH = {"font.size": 7.5, "axes.titlesize": 8, "axes.labelsize": 7.5, "legend.fontsize": 7, "xtick.labelsize": 7,
                     "ytick.labelsize": 7, "lines.linewidth": 1.1, "lines.markersize": 4}
SMALL = 0.84          # of captions and of what stands under pictures, in sizes of text
CAPTION = "caption"   # by which a figure's caption is found again
MILLIMETRES = 25.4    # in an inch


def drawn(draw, grid=True):
    """Of a function that draws: its figure looks as here, and nothing else does, whatever the settings of matplotlib are around it.
    It can be asked for a width in millimetres, and for a matplotlib style file that has the last word."""
    @functools.wraps(draw)
    def drawn_in_style(*arguments, width=None, style=None, **options):
        with pyplot.rc_context():
            pyplot.rcdefaults()
            pyplot.rcParams.update({**SETTINGS, "axes.grid": grid})
            if width:
                pyplot.rcParams.update({**SETTINGS_AT_WIDTH, "figure.figsize": (width / MILLIMETRES, 4.0)})
            if style:
                pyplot.rcParams.update(settings_in(style))
            figure = draw(*arguments, **options)
            if figure is not None:
                figure.draw_without_rendering()    # makes ticks, which look up their settings when they are made
            return figure
    return drawn_in_style


def drawn_of_pictures(draw):
    """The same without the lines of a grid."""
    return drawn(draw, grid=False)


def settings_in(file):
    """A matplotlib style file, which has a line `name: value` a setting."""
    for number, line in enumerate(files.read_text(file).split("\n"), 1):    # matplotlib passes over what it does not know
        name = line.split("#")[0].split(":")[0].strip()
        if name and name not in matplotlib.rcParams:
            raise InputError(f"{file}:{number}: \"{name}\" is no setting of matplotlib; expected lines such as font.size: 8")
    try:
        return matplotlib.rc_params_from_file(file, fail_on_error=True, use_default_template=False)
    except (ValueError, KeyError) as error:
        raise InputError(f"{file}: is no style of matplotlib: {error}") from error


def width():
    """Of the figure that is being drawn, in inches."""
    return pyplot.rcParams["figure.figsize"][0]


def size(of):
    """Of text, in points: "title", "label", "legend" or "small"."""
    names = {"title": "axes.titlesize", "label": "axes.labelsize", "legend": "legend.fontsize"}
    return SMALL * pyplot.rcParams["font.size"] if of == "small" else FontProperties(size=pyplot.rcParams[names[of]]).get_size_in_points()


def add_caption(figure, lines, left, top):
    """Small print at the foot of a figure; `left` and `top` are inches from its lower left corner. Nothing may stand below it: it is
    cut off where the text of the page has it."""
    figure.text(left / figure.get_figwidth(), top / figure.get_figheight(), "\n".join(lines), fontsize=size("small"), color="#333333",
                va="top", linespacing=text.LINE_HEIGHT, gid=CAPTION)


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
    of_kind = [kinds[:place].count(kind) for place, kind in enumerate(kinds)]
    return {label: {"color": matplotlib.colors.to_hex(next(sweep_colours.get(kind, single_colours))), "marker": marker,
                    "linestyle": pattern(kind, records.columns), **(HOLLOW if before % 2 else FILLED)}
            for label, kind, marker, before in zip(records.labels, kinds, itertools.cycle(MARKERS), of_kind)}


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
