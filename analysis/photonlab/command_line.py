"""The command line of the analysis, and how it ends: with exit code 2 and one line for what the user can mend."""

import argparse
import contextlib
import os
import signal
import sys
import warnings
from pathlib import Path

import matplotlib

from photonlab import analysed, answering, measuring, tabling
from photonlab.command import options_of
from photonlab.drawing import saving
from photonlab.figures import MODULES
from photonlab.records import tables
from photonlab.records.files import InputError, reason
from photonlab.report import page
from photonlab.statistics import decomposition, fits

# In this order all are made of a folder: a command reads what those before it wrote.
COMMANDS = [decomposition.COMMAND, fits.COMMAND, *(module.COMMAND for module in MODULES), measuring.COMMAND, tabling.COMMAND,
            answering.COMMAND, page.COMMAND]
ALL = "analyse"          # the command that makes them
FIGURE = "figure"        # may stand before the name of one: `photonlab figure convergence RESULTS`


def main(arguments):
    """Does what the arguments say; returns the exit code."""
    first, rest = arguments[:1], arguments[1:]
    program = f"photonlab {first[0]}" if first in [[FIGURE], [ALL]] else "analysis"    # as it was called
    kinds = [command.name for command in COMMANDS if command.draws]
    if first == [FIGURE] and rest[:1] not in [[kind] for kind in kinds]:
        return complain(f"{FIGURE}: expected a kind, one of {', '.join(kinds)}")
    if program != "analysis":
        arguments = rest
    if arguments and arguments[0] in [command.name for command in COMMANDS]:
        return answered(lambda: make(arguments, program))
    return answered(lambda: make_all(folder_in(arguments, program)))


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


def make(arguments, program):
    """One command."""
    command = next(command for command in COMMANDS if command.name == arguments[0])
    options = options_of(command, arguments[1:], program)
    results = command.read(options.results)
    if command.selects:
        results = results.only(options.scenes, options.methods)
    for said in said_by(command, results, options):
        print(said, flush=True)


def said_by(command, results, options):
    """What a command says. Its figures and tables are written, and their names are said."""
    for said in command.make(results, options):
        if isinstance(said, saving.Drawn):
            yield from saving.save(said, results, options.output, options.format, not options.no_caption)
        elif isinstance(said, (tables.Derived, tables.Words)):
            yield tables.write_derived(results, said)
        else:
            yield said


def make_all(folder):
    """All that a folder has, but what is there already; and the answers last, where they are seen."""
    commands = [command for command in COMMANDS if command.can_start(folder)]
    kept = analysed.Kept(folder)
    read = {}    # what each way of reading made of the folder
    answer = []
    for command in commands or COMMANDS[:1]:    # which says what is not there
        if command.read not in read:
            read[command.read] = command.read(folder)
        results = read[command.read]
        if not command.is_for(results):
            continue
        made_from = command.made_from(results)
        said = kept.said(command.name, made_from)
        is_new = said is None
        if is_new:
            said = list(said_by(command, results, options_of(command, [str(folder)])))
            kept.keep(command.name, made_from, said)
        if command is answering.COMMAND:
            answer = said
        elif is_new:
            print(*said, sep="\n", flush=True)
    kept.write()
    print(*answer, sep="\n", flush=True)


def folder_in(arguments, program):
    names = "\n".join(f"  {command.name:16}{command.summary}" for command in COMMANDS)
    parser = argparse.ArgumentParser(
        prog=program, usage=f"{program} RESULTS\n       {program} COMMAND RESULTS [options]",
        description="Draws all that a folder of results has and says which method is best, or with a COMMAND makes one figure or "
                    "table. What is there already and of the same records is not made again.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=f"commands:\n{names}\n\n`{program} COMMAND --help` says what it writes and how to read it.")
    parser.add_argument("results", metavar="RESULTS", type=Path, help="folder of an experiment's results")
    return parser.parse_args(arguments).results


def complain(message):
    with contextlib.suppress(OSError):
        print(" ".join(message.split("\n")), file=sys.stderr)
    return 2


def end_by_signal(number, _):
    raise SystemExit(128 + number)    # so that what is half written is removed


def run(work=lambda: main(sys.argv[1:])):
    """Does what the command line says, and ends with its exit code."""
    matplotlib.use("Agg")    # draws to files and never opens a window
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
