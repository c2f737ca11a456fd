"""How every figure looks: made for the column of a paper, for readers who do not see all colours, and for a printer
that has none. So a method has a colour, a marker and a line of its own, and each alone nearly tells it.

Colours: Okabe and Ito 2008, "Color Universal Design", with a grey in place of the yellow, which a white page swallows.
"""

import io
import itertools
import math
import struct
import textwrap

import files
import matplotlib

matplotlib.use("Agg")    # draws to files and never opens a window

import matplotlib.pyplot as pyplot
from matplotlib import ticker

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9", "#E69F00", "#8A8A8A"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "*", "p"]
LINES = {"photonmapper radius": (0, (5, 1.5)), "photonmapper nearest": (0, (5, 1.5, 1, 1.5)), "path": (0, (1, 1.2)),
         "ppm hachisuka": "solid", "ppm knaus-zwicker": (0, (9, 1.2, 1.2, 1.2))}

RECORDS = "photonlab.records"    # what a figure's metadata has the hash of its records under
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
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


def kind(row):
    """ "photonmapper radius", "ppm hachisuka": what has a line pattern of its own."""
    return " ".join(filter(None, [row["integrator"], row["mode"], row["schedule"]]))


def method_styles(records, labels):
    """Line settings by label. Patterns go by kind of method, so that PM and PPM are told apart at a glance. A sweep,
    more than four methods of one kind, goes from dark to light in their order; all else has 8 colours. With 11 markers
    no pair comes again before the 89th method."""
    first_rows = records.drop_duplicates("method").set_index("method")
    kinds = [kind(first_rows.loc[label]) for label in labels]
    single_colours = itertools.cycle(COLOURS)
    sweep_colours = {name: iter(pyplot.cm.viridis([0.88 * step / (kinds.count(name) - 1)
                                                   for step in range(kinds.count(name))]))
                     for name in set(kinds) if kinds.count(name) > 4}
    return {label: {"color": matplotlib.colors.to_hex(next(sweep_colours.get(name, single_colours))), "marker": marker,
                    "linestyle": LINES.get(name, "solid"), "markeredgecolor": "white", "markeredgewidth": 0.5}
            for label, name, marker in zip(labels, kinds, itertools.cycle(MARKERS))}


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


def panels_over_legend(rows, columns, handles, caption, panel_height=1.75):
    """A grid of panels with what all share below it: the legend, then the caption in small print. Laid out in inches,
    so that nothing overlaps however many entries there are. Returns the figure and its grid of axes."""
    legend_columns = 2 if max(len(handle.get_label()) for handle in handles) > 28 else 3
    caption_lines = textwrap.wrap(caption, 104)
    legend = 0.19 * -(-len(handles) // legend_columns) + 0.06
    below = legend + 0.15 * len(caption_lines) + 0.1
    left, right, top, axis_labels = 0.76, 0.1, 0.28, 0.48
    height = rows * (top + panel_height + axis_labels) + below
    figure, grid = pyplot.subplots(rows, columns, figsize=(FULL_WIDTH, height), sharey="row", squeeze=False)
    figure.subplots_adjust(left=left / FULL_WIDTH, right=1 - right / FULL_WIDTH, top=1 - top / height,
                           bottom=(below + axis_labels) / height, hspace=(top + axis_labels) / panel_height,
                           wspace=0.07)
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(left / FULL_WIDTH, below / height),
                  ncol=legend_columns, borderaxespad=0, borderpad=0, handlelength=3.2, columnspacing=1.5)
    figure.text(left / FULL_WIDTH, (below - legend) / height, "\n".join(caption_lines), fontsize=7.5, color="#333333",
                va="top", linespacing=1.25)
    return figure, grid


def positive(text):
    """A number above 0 from the command line."""
    value = float(text)
    if not value > 0:
        raise ValueError(text)
    return value


def two_digits(value):
    """0.0020, 0.13, 12, 113: what a comparison by eye needs of an error or a time."""
    return f"{value:.0f}" if value >= 100 else f"{value:#.2g}".rstrip(".")


def save(figure, folder, name, records):
    """Writes FOLDER/figures/NAME.png and .pdf; returns both names. Both say the hash of the records that they were made from. The
    same records give the same bytes: no date."""
    drawn = {"png": io.BytesIO(), "pdf": io.BytesIO()}
    figure.savefig(drawn["png"], format="png", metadata={"Software": None, RECORDS: records})
    figure.savefig(drawn["pdf"], format="pdf", metadata={"CreationDate": None, "Creator": None, "Producer": None,
                                                         "Keywords": f"{RECORDS} {records}"})
    pyplot.close(figure)
    return [files.replace_file(folder / "figures" / f"{name}.{kind}", data.getvalue()) for kind, data in drawn.items()]


def records_of_png(data):
    """The hash of the records that a figure says it was made from; None where it says nothing."""
    place = len(PNG_SIGNATURE)
    while data.startswith(PNG_SIGNATURE) and place + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        keyword, _, text = data[place + 8:place + 8 + length].partition(b"\0")
        if kind == b"tEXt" and keyword == RECORDS.encode():
            return text.decode("latin-1")
        place += length + 12    # with the checksum behind it
    return None
