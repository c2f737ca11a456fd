"""A figure or table as the command line offers it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files, records


def has(name):
    """True of records in whose folder there is a file or folder of this name."""
    return lambda results: files.is_there(results.folder / name)


def positive(text):
    """A number above 0 from the command line."""
    value = float(text)
    if not value > 0:
        raise ValueError(text)
    return value


def whole_positive(text):
    """A whole number above 0 from the command line."""
    value = int(text)
    if value < 1:
        raise ValueError(text)
    return value


@dataclass(frozen=True)
class Command:
    """`make` takes what `read` makes of the folder and the options, writes files, and yields what it has to say: their names, and
    what is left out."""
    name: str
    summary: str         # for lists of commands
    about: str           # the docstring of its file: a sentence or two, then what a reader of its figure needs
    writes: str          # what it writes in the folder
    make: Callable
    starts_from: str = "iterations.csv"    # what the folder must have
    read: Callable = records.read
    is_for: Callable = lambda results: True    # whether it is among what is drawn of a folder when all is
    add_options: Callable = lambda parser: None

    def can_start(self, folder):
        return files.is_there(Path(folder) / self.starts_from)
