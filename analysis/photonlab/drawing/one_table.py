"""Figures of one table that a program has written, where there are no records of an experiment."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from photonlab.command import Command
from photonlab.drawing.saving import Drawn
from photonlab.records import kept_files


@dataclass
class Measured:
    """A folder with the table."""
    table: str    # its file's name
    folder: Path

    @property
    def hash(self):
        return kept_files.hash_of_file(self.folder / self.table)


def measured_in(table):
    """What a command of the table reads of a folder."""
    return partial(Measured, table)


def command_of(name, table, read, statements, draw, summary, about):
    """The command of a figure called `name`: what `read` makes of the table's file is told by `statements` and drawn by `draw`."""
    def make(results, options):
        rows = read(results.folder / table)
        yield from statements(rows)
        yield Drawn(name, draw(rows, **options.look))

    return Command(name=name, draws=True, summary=summary, about=about, writes=f"figures/{name}.png and .pdf", make=make,
                   starts_from=table, read=measured_in(table))
