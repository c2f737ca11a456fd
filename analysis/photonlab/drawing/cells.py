"""Pictures side by side, in the manner of papers: a cell a method, with its name above, pictures in rows below each other, and what is
to be said of them underneath. As many cells as have room stand in a line. Laid out in inches from the upper left corner."""

from dataclasses import dataclass, field

import numpy
from matplotlib import patches, pyplot

from photonlab.drawing import style, text

SMALLEST, SMALLEST_AT_WIDTH, LARGEST = 1.1, 0.76, 2.6    # inches; the second of a figure that is for a column of text
NARROW = 4.5
MARGIN, GAP, ROW_GAP, LINE_GAP = 0.08, 0.07, 0.05, 0.04
# Frames of the first inset, the second, ...: told by their colour, and in grey by their line.
FRAMES = [{"edgecolor": "#E69F00", "linestyle": "solid"}, {"edgecolor": "#56B4E9", "linestyle": (0, (3, 1))},
          {"edgecolor": "#CC79A7", "linestyle": (0, (1, 1))}, {"edgecolor": "#009E73", "linestyle": (0, (4, 1, 1, 1))}]


@dataclass
class Tile:
    """A picture."""
    pixels: numpy.ndarray                         # display values (height, width, 3), or numbers for a map of colours
    options: dict = field(default_factory=dict)   # of imshow
    frame: dict = None                            # one of FRAMES
    marked: list = field(default_factory=list)    # [((left, top, right, bottom), frame)] drawn over it

    @property
    def aspect(self):
        return self.pixels.shape[0] / self.pixels.shape[1]


@dataclass
class Cell:
    title: str
    rows: list             # of tiles, which share the width of the cell
    below: list = field(default_factory=list)    # lines of text
    bold: bool = False


def heights_of(cells, width):
    """Of each row of tiles, the highest of all cells."""
    rows = max(len(cell.rows) for cell in cells)
    return [max(max(tile.aspect for tile in cell.rows[row]) * tile_width(cell.rows[row], width)
                for cell in cells if row < len(cell.rows)) for row in range(rows)]


def tile_width(row, width):
    return (width - ROW_GAP * (len(row) - 1)) / len(row)


def draw_cells(cells, title, note):
    """The figure, and for each cell the axes of its tiles, row by row, with the place (x, y, width, height) in fractions of the figure of
    each row that it does not have."""
    width, size, small = style.width(), style.size("legend"), style.size("small")
    smallest = SMALLEST if width >= NARROW else SMALLEST_AT_WIDTH
    columns = min(len(cells), max(1, int((width - 2 * MARGIN + GAP) / (smallest + GAP))))
    columns = -(-len(cells) // -(-len(cells) // columns))
    cell_width = min((width - 2 * MARGIN - GAP * (columns - 1)) / columns, LARGEST)
    titles = [text.wrapped(cell.title, cell_width, size) for cell in cells]
    texts = [[line for part in cell.below for line in text.wrapped(part, cell_width, small)] for cell in cells]
    note_lines = text.wrapped(note, width - 2 * MARGIN, small) if note else []
    heights = heights_of(cells, cell_width)
    of_pictures = sum(heights) + ROW_GAP * (len(heights) - 1)
    lines = [range(start, min(start + columns, len(cells))) for start in range(0, len(cells), columns)]
    above = [max(text.height_of(titles[place], size) for place in line) + 0.05 for line in lines]
    under = [max(text.height_of(texts[place], small) for place in line) + 0.05 for line in lines]
    heading = text.height_of([title], style.size("title")) + 0.06 if title else 0.03
    foot = text.height_of(note_lines, small) + 0.08 if note_lines else 0.02
    height = heading + sum(above) + sum(under) + len(lines) * of_pictures + LINE_GAP * (len(lines) - 1) + foot

    figure = pyplot.figure(figsize=(width, height))
    if title:
        shown, fitting = text.fitted(title, width - 2 * MARGIN, style.size("title"))
        figure.text(MARGIN / width, 1 - 0.04 / height, shown, va="top", fontsize=fitting)
    found, y = [], heading
    for line, over, below in zip(lines, above, under):
        for column, place in enumerate(line):
            x = MARGIN + column * (cell_width + GAP)
            figure.text((x + cell_width / 2) / width, 1 - (y + over - 0.03) / height, "\n".join(titles[place]), ha="center", va="bottom",
                        fontsize=size, linespacing=text.LINE_HEIGHT)
            found.append(add_rows(figure, cells[place], x, y + over, cell_width, heights))
            figure.text((x + cell_width / 2) / width, 1 - (y + over + of_pictures + 0.03) / height, "\n".join(texts[place]), ha="center",
                        va="top", fontsize=small, linespacing=text.LINE_HEIGHT, fontweight="bold" if cells[place].bold else "normal")
        y += over + of_pictures + below + LINE_GAP
    style.add_caption(figure, note_lines, MARGIN, foot - 0.03)
    return figure, found


def add_rows(figure, cell, x, y, width, heights):
    """Adds the tiles of a cell; a list of their axes a row."""
    found = []
    for row, height in enumerate(heights):
        if row < len(cell.rows):
            each = tile_width(cell.rows[row], width)
            found.append([add_tile(figure, tile, x + place * (each + ROW_GAP), y, each) for place, tile in enumerate(cell.rows[row])])
        else:
            found.append(place_in(figure, x, y, width, height))
        y += height + ROW_GAP
    return found


def place_in(figure, x, y, width, height):
    whole_width, whole_height = figure.get_size_inches()
    return x / whole_width, 1 - (y + height) / whole_height, width / whole_width, height / whole_height


def add_tile(figure, tile, x, y, width):
    axes = figure.add_axes(place_in(figure, x, y, width, width * tile.aspect))
    axes.imshow(tile.pixels, interpolation="nearest", aspect="auto", **tile.options)
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(True)
    for spine in axes.spines.values() if tile.frame else []:
        spine.set(edgecolor=tile.frame["edgecolor"], linestyle=tile.frame["linestyle"], linewidth=1.3, capstyle="butt")
    for (left, top, right, bottom), frame in tile.marked:
        for colour, line in [("black", {"linewidth": 1.8}), (frame["edgecolor"], {"linewidth": 1.0, "linestyle": frame["linestyle"]})]:
            axes.add_patch(patches.Rectangle((left - 0.5, top - 0.5), right - left, bottom - top, fill=False, edgecolor=colour, **line))
    return axes
