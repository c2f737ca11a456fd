"""The command line of the analysis, and how it ends: with exit code 2 and one line for what the user can mend."""

import argparse
import contextlib
import os
import signal
import sys
import warnings
from pathlib import Path

from photonlab.figures import (best_alpha, bias_variance, calibration, convergence, equal_time, extremes, gallery, grid, memory,
                              methods, probes, radii, scaling, strip, time_to_error, tradeoff)
from photonlab.records.files import InputError, reason
from photonlab.report import page
from photonlab.statistics import decomposition, fits

# In this order all are made of a folder: a command reads what those before it wrote.
COMMANDS = [convergence.COMMAND, strip.COMMAND, gallery.COMMAND, decomposition.COMMAND, fits.COMMAND, bias_variance.COMMAND,
            memory.COMMAND, best_alpha.COMMAND, methods.COMMAND, radii.COMMAND, calibration.COMMAND, grid.COMMAND, equal_time.COMMAND,
            time_to_error.COMMAND, tradeoff.COMMAND, probes.COMMAND, scaling.COMMAND, extremes.COMMAND, page.COMMAND]


def main(arguments):
    """Does what the arguments say; returns the exit code."""
    if arguments and arguments[0] in [command.name for command in COMMANDS]:
        return answered(lambda: make(arguments))
    return answered(lambda: make_all(folder_in(arguments)))


def answered(work):
    """Does the work; returns the exit code, and says in one line what the user can mend."""
    try:
        work()
        return 0
    except InputError as error:
        return complain(str(error))
    except OSError as error:
        if error.filename is None:
            raise
        return complain(f"{os.fsdecode(error.filename)}: {reason(error)}")
    except MemoryError:
        return complain("what is to be drawn does not fit into memory")


def make(arguments):
    """One command."""
    command = next(command for command in COMMANDS if command.name == arguments[0])
    options = parser_of(command).parse_args(arguments[1:])
    for said in command.make(command.read(options.results), options):
        print(said, flush=True)


def make_all(folder):
    """All that a folder has."""
    read = {}    # what each way of reading made of the folder
    commands = [command for command in COMMANDS if command.can_start(folder)]
    for command in commands or COMMANDS[:1]:    # which says what is not there
        if command.read not in read:
            read[command.read] = command.read(folder)
        if command.is_for(read[command.read]):
            for said in command.make(read[command.read], parser_of(command).parse_args([str(folder)])):
                print(said, flush=True)


def folder_in(arguments):
    listed = "\n".join(f"  {command.name:16}{command.summary}" for command in COMMANDS)
    parser = argparse.ArgumentParser(
        prog="analysis", usage="analysis RESULTS\n       analysis COMMAND RESULTS [options]",
        description="Draws all that a folder of results has, or with a COMMAND one figure or table.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=f"commands:\n{listed}\n\n`analysis COMMAND --help` says what it writes and how to read it.")
    parser.add_argument("results", metavar="RESULTS", type=Path, help="folder of an experiment's results")
    return parser.parse_args(arguments).results


def parser_of(command):
    first, rest = command.about.split("\n\n", 1)
    parser = argparse.ArgumentParser(prog=f"analysis {command.name}", description=first,
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=f"Writes {command.writes}.\n\n{rest}")
    parser.add_argument("results", metavar="RESULTS", type=Path, help="folder of an experiment's results")
    command.add_options(parser)
    return parser


def complain(message):
    with contextlib.suppress(OSError):
        print(" ".join(message.split("\n")), file=sys.stderr)
    return 2


def end_by_signal(number, _):
    raise SystemExit(128 + number)    # so that what is half written is removed


def run(work=lambda: main(sys.argv[1:])):
    """Does what the command line says, and ends with its exit code."""
    for stream in filter(None, [sys.stdout, sys.stderr]):
        stream.reconfigure(errors="backslashreplace")    # names that are not UTF-8, and terminals that are not
    for number in [signal.SIGTERM, signal.SIGHUP, signal.SIGINT]:
        signal.signal(number, end_by_signal)
    warnings.filterwarnings("ignore", "Glyph .* missing")    # a box is drawn for it
    try:
        code = work()
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        # Of the standard output: files have their own messages. A reader that has enough is no mistake.
        code = 0 if isinstance(error, BrokenPipeError) else complain(f"the standard output cannot be written: {reason(error)}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)    # for what is left of it
    sys.exit(code)
