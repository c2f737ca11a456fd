"""A figure or table as the command line offers it."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files, records

FORMATS = ["png", "pdf", "pgf"]    # of figures
MILLIMETRES = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.27}    # pt: of TeX


def has(name):
    """True of records in whose folder there is a file or folder of this name."""
    return lambda results: files.is_there(results.folder / name)


def positive(text):
    """A number above 0 from the command line."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise ValueError(text)
    return value


def whole_positive(text):
    """A whole number above 0 from the command line."""
    value = int(text)
    if value < 1:
        raise ValueError(text)
    return value


def length(text):
    """A length from the command line, "84mm" or "3.3in", in millimetres."""
    number, unit = (text[:-2], text[-2:]) if text[-2:] in MILLIMETRES else (text, "mm")
    try:
        millimetres = positive(number) * MILLIMETRES[unit]
    except ValueError:
        millimetres = 0.0
    if not 20 <= millimetres <= 1000:
        raise argparse.ArgumentTypeError(f"\"{text}\": expected a length from 20mm to 1000mm, in {', '.join(MILLIMETRES)}")
    return millimetres


def rectangle(text):
    """(left, top, width, height) in pixels from the command line."""
    try:
        x, y, width, height = map(int, text.split(","))
    except ValueError:
        x = -1
    if x < 0 or y < 0 or width < 1 or height < 1:
        raise argparse.ArgumentTypeError(f"\"{text}\": expected x,y,w,h in pixels, such as 20,40,32,32")
    return x, y, width, height


def listed(text, known):
    """Names from the command line, separated by commas."""
    names = text.split(",")
    if not set(names) <= set(known):
        raise argparse.ArgumentTypeError(f"\"{text}\": expected some of {','.join(known)}")
    return names


@dataclass(frozen=True)
class Command:
    """`make` takes what `read` makes of the folder and the options, and yields what it has to say: names of files that it wrote,
    figures that are to be saved, and what is left out."""
    name: str
    summary: str         # for lists of commands
    about: str           # the docstring of its file: a sentence or two, then what a reader of its figure needs
    writes: str          # what it writes in the folder
    make: Callable
    starts_from: str = "iterations.csv"    # what the folder must have
    read: Callable = records.read
    is_for: Callable = lambda results: True    # whether it is among what is drawn of a folder when all is
    add_options: Callable = lambda parser: None
    draws: bool = False        # figures, which can be asked to look otherwise
    made_from: Callable = lambda results: results.hash    # what tells whether it is to be made again

    def can_start(self, folder):
        return files.is_there(Path(folder) / self.starts_from)

    @property
    def selects(self):
        """Whether it can be asked for some scenes and methods alone."""
        return self.read is records.read


def parser_of(command, program="analysis"):
    first, rest = command.about.split("\n\n", 1)
    parser = argparse.ArgumentParser(prog=f"{program} {command.name}", description=first,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=f"Writes {command.writes}.\n\n{rest}")
    parser.add_argument("results", metavar="RESULTS", type=Path, help="folder of an experiment's results")
    command.add_options(parser)
    if command.selects:
        chosen = parser.add_argument_group("what is looked at")
        chosen.add_argument("--scenes", nargs="+", metavar="NAME", help="these scenes alone; * stands for anything")
        chosen.add_argument("--methods", nargs="+", metavar="LABEL", help="these methods alone, as figures call them; likewise")
    if command.draws:
        looks = parser.add_argument_group("how figures look")
        looks.add_argument("--width", type=length, metavar="84mm", help="width of the figure, in mm, cm, in or pt; its text is then "
                           "of the size of a caption")
        looks.add_argument("--no-caption", action="store_true", help="leave the caption to the page, and print it")
        looks.add_argument("--format", type=lambda text: listed(text, FORMATS), default=["png", "pdf"], metavar="png,pdf,pgf",
                           help="which files (default: png,pdf)")
        looks.add_argument("--style", type=Path, metavar="FILE", help="a matplotlib style file, which has the last word")
        looks.add_argument("--output", type=Path, metavar="FOLDER", help="where figures go (default: RESULTS/figures; with any of "
                           "these options RESULTS/figures/chosen)")
    return parser


OF_LOOKS = ["scenes", "methods", "width", "no_caption", "format", "style"]    # options of figures for elsewhere


def options_of(command, arguments, program="analysis"):
    """The options of a command; `program` is what the user has typed before its name. `look` is what its figures are to look like, `is_asked` whether anything was asked for. Figures that
    are to look otherwise, or are of a part of the records, are not those of the folder: they go to a folder of their own."""
    parser = parser_of(command, program)
    options = parser.parse_args(arguments)
    asked = {name for name, value in vars(options).items() if value != parser.get_default(name)} - {"results", "rays"}
    options.look = {"width": options.width, "style": options.style} if command.draws else {}
    options.is_asked = bool(asked)
    if command.draws and options.output is None and asked & set(OF_LOOKS):
        options.output = options.results / "figures" / "chosen"
    return options
