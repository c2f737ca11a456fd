"""A grid of panels over a legend and a caption, which most figures are."""

import textwrap

from matplotlib import pyplot

from photonlab.drawing.style import FULL_WIDTH


def filled(grid, items):
    """Pairs of a panel of the grid and an item, in order; panels without an item are hidden."""
    for axes in grid.flat[len(items):]:
        axes.set_visible(False)
    return zip(grid.flat, items)


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
