"""Text that has to fit: measured in the font that it is drawn in, broken where it is too long for a line, or made smaller.

Sizes are in points, widths in inches.
"""

import functools
import re

from matplotlib import pyplot
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

SMALLEST = 0.75      # share of a title's size that can still be read
LINE_HEIGHT = 1.2    # of a line of text, in sizes
PIECES = re.compile(r"[^\s\-_,/=]*[\-_,/=]*\s*")    # where a line may end: behind a space, and behind what joins words


def width_of(text, size):
    return width_in(text, size, tuple(pyplot.rcParams["font.family"]))


@functools.lru_cache(maxsize=4096)
def width_in(text, size, family):
    return text_to_path.get_text_width_height_descent(text, FontProperties(family=list(family), size=size), False)[0] / 72


def wrapped(text, width, size):
    """Lines no wider than `width`; only a piece that has no place to break and is wider still is cut."""
    lines = [""]
    for piece in filter(None, PIECES.findall(text)):
        while width_of(piece.rstrip(), size) > width and len(piece) > 1:
            cut = next(end for end in range(len(piece) - 1, 0, -1) if end == 1 or width_of(piece[:end], size) <= width)
            lines += [piece[:cut]] if lines[-1] else []
            lines[-1] = lines[-1] or piece[:cut]
            lines.append("")
            piece = piece[cut:]
        if width_of((lines[-1] + piece).rstrip(), size) <= width or not lines[-1]:
            lines[-1] += piece
        else:
            lines.append(piece)
    return [line.rstrip() for line in lines if line.strip()] or [""]


def fitted(text, width, size):
    """(the text, its size): smaller where it is too wide, and shortened where that is not enough."""
    needed = width_of(text, size)
    if needed <= width:
        return text, size
    smaller = max(SMALLEST * size, size * width / needed)
    kept = len(text)
    while kept > 1 and width_of(text if kept == len(text) else f"{text[:kept]}…", smaller) > width:
        kept -= 1
    return (text if kept == len(text) else f"{text[:kept]}…"), smaller


def height_of(lines, size):
    return len(lines) * size * LINE_HEIGHT / 72
