"""A grid of panels over a legend and a caption, which most figures are. Laid out in inches, so that nothing overlaps however many
entries there are and however long: labels are broken into lines, and a narrow figure has its panels below each other."""

import numpy
from matplotlib import pyplot

from photonlab.drawing import style, text

LEFT, RIGHT, TOP, AXIS_LABELS, GAP = 0.76, 0.1, 0.28, 0.48, 0.07    # inches
NARROW = 4.5          # inches: a narrower figure is for a column of text
HANDLE = 3.2          # length of a legend's line, in sizes of its text
SPACING = {"handle": 0.8, "column": 1.5, "label": 0.5}    # between the parts of a legend, likewise


def filled(grid, items):
    """Pairs of a panel of the grid and an item, in order; panels without an item are hidden."""
    for axes in grid.flat[len(items):]:
        axes.set_visible(False)
    return zip(grid.flat, items)


def panels_over_legend(rows, columns, handles, caption, panel_height=1.75, same_heights=True):
    """A figure and its grid of axes, with what all share below it: the legend, then the caption in small print. Panels of a row share
    their vertical axis, unless their heights mean different things. In a narrow figure the panels of a row stand below each other, and
    the grid is the same."""
    width = style.width()
    stacked = width < NARROW and columns > 1
    shape = (rows * columns, 1) if stacked else (rows, columns)
    margin = LEFT if width >= NARROW else 0.06    # of legend and caption
    legend, legend_columns = set_in_columns(handles, width - margin - RIGHT)
    small = style.size("small")
    caption_lines = text.wrapped(caption, width - margin - 0.06, small) if caption else []
    below = legend + text.height_of(caption_lines, small) + 0.12
    height = shape[0] * (TOP + panel_height + AXIS_LABELS) + below
    sharey = "row" if same_heights and not stacked else False
    figure, grid = pyplot.subplots(*shape, figsize=(width, height), sharey=sharey, squeeze=False)
    figure.subplots_adjust(left=LEFT / width, right=1 - RIGHT / width, top=1 - TOP / height, bottom=(below + AXIS_LABELS) / height,
                           hspace=(TOP + AXIS_LABELS) / panel_height,
                           wspace=GAP if same_heights else LEFT * columns / (width - LEFT - RIGHT - LEFT * (columns - 1)))
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(margin / width, below / height), ncol=legend_columns,
                  borderaxespad=0, borderpad=0, handlelength=HANDLE, handletextpad=SPACING["handle"],
                  columnspacing=SPACING["column"], labelspacing=SPACING["label"])
    style.add_caption(figure, caption_lines, margin, below - legend)
    return figure, grid.reshape(rows, columns)


def set_in_columns(handles, width):
    """(height of the legend, its columns): as many columns as fit, up to three. Labels that are too long even for one are broken."""
    size = style.size("legend")
    beside = size * (HANDLE + SPACING["handle"]) / 72
    between = size * SPACING["column"] / 72
    widest = beside + max(text.width_of(handle.get_label(), size) for handle in handles)
    columns = max(1, min(3, len(handles), int((width + between) / (widest + between))))
    lines = []
    for handle in handles:
        lines.append(text.wrapped(handle.get_label(), (width + between) / columns - between - beside, size))
        handle.set_label("\n".join(lines[-1]))
    heights = [sum((1 + SPACING["label"] + text.LINE_HEIGHT * (len(lines[place]) - 1)) * size / 72 for place in column)
               for column in numpy.array_split(range(len(lines)), columns)]    # as matplotlib deals entries to columns
    return max(heights) + 0.08, columns


def set_titles(axes, left="", right=""):
    """Titles at both ends of a panel, which never overprint: the left one has what the right one leaves it."""
    figure = axes.figure
    width = axes.get_position().width * figure.get_figwidth()
    size = style.size("title")
    for title, loc, room in [(right, "right", width), (left, "left", width - (text.width_of(right, size) + 0.1 if right else 0))]:
        if title:
            shown, fitting = text.fitted(title, max(room, 0.2), size)
            axes.set_title(shown, loc=loc, fontsize=fitting)


def name_row(panels, name):
    """Names the vertical axis of a row, at each panel that begins a line; smaller where it is longer than the panel."""
    for axes in panels:
        if axes.get_subplotspec().is_first_col():
            room = axes.get_position().height * axes.figure.get_figheight() + TOP
            shown, size = text.fitted(name, room, style.size("label"))
            axes.set_ylabel(shown, fontsize=size)
