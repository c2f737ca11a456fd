"""The one command of docs/replications/README.md.

    /usr/bin/python3 experiments/replications/run                     # all rows, in a night: runs, numbers, verdicts
    /usr/bin/python3 experiments/replications/run 7 13                # these rows
    /usr/bin/python3 experiments/replications/run --list              # how long it will take
    /usr/bin/python3 experiments/replications/run --check             # in minutes: are the records those of the program?
    /usr/bin/python3 experiments/replications/run 2 7 --first-seed 501 --resolution 96    # does it hold elsewhere?

It can be stopped and called again. Exit code: 0 where all is as the page says, 1 where something is not, 2 for what cannot be used.
"""

import argparse
from dataclasses import replace
from pathlib import Path

from photonlab.command import whole_positive
from photonlab.command_line import answered, complain
from photonlab.records import records, tables
from photonlab.records.files import InputError
from photonlab.replications import checksums, claims, making, variants
from photonlab.replications.making import Workshop
from photonlab.replications.rows import PROGRAMS, ROWS
from photonlab.replications.values import Made

COLUMNS = ["row", "made", "name", "value", "error", "stated", "agreement", "verdict", "stated_verdict"]
NOT_MADE = "not made"
ROOT = Path(__file__).resolve().parents[3]    # of the repository, or of what is installed


def row_number(text):
    number = int(text) if text.isdecimal() else 0
    if number not in ROWS:
        raise argparse.ArgumentTypeError(f"{text} is the number of no row; expected one of {', '.join(map(str, ROWS))}")
    return number


def parser():
    made = argparse.ArgumentParser(prog="experiments/replications/run", description=__doc__.split("\n", maxsplit=1)[0],
                                   formatter_class=argparse.RawDescriptionHelpFormatter, epilog=__doc__.split("\n", maxsplit=2)[2])
    made.add_argument("rows", metavar="ROW", nargs="*", type=row_number, help="numbers of rows (default: all)")
    what = made.add_mutually_exclusive_group()
    what.add_argument("--list", action="store_true", help="how long each experiment will take, without references, and run nothing")
    what.add_argument("--check", action="store_true", help="run everything in small, and compare the checksums of its records")
    what.add_argument("--keep", action="store_true", help="the same, and keep the checksums beside the experiments")
    made.add_argument("-o", "--output", type=Path, default=Path("results/replications"), metavar="FOLDER", help="default: %(default)s")
    made.add_argument("--program", type=Path, metavar="FILE", help="photonlab (default: that of the build, or the installed one)")
    changed = made.add_argument_group("what is changed, to see whether verdicts stay")
    changed.add_argument("--first-seed", type=int, metavar="N", help="other seeds, from this one on")
    changed.add_argument("--seeds", type=whole_positive, metavar="N", help="at most so many")
    changed.add_argument("--resolution", type=whole_positive, metavar="SIDE", help="pixels a side; references are made")
    changed.add_argument("--samples", type=whole_positive, metavar="N", help="of those (default: 1024)")
    changed.add_argument("--passes", type=whole_positive, metavar="N", help="at most so many")
    return made


def workshop_of(options):
    variant = variants.Variant(options.first_seed, options.seeds, options.resolution, options.passes, options.samples or 1024)
    smoke = options.check or options.keep
    if smoke and variant.is_changed:
        raise InputError("--check: is of the experiments as they are written; expected no other seeds, resolution or passes")
    if options.samples and not options.resolution:
        raise InputError("--samples: of references that are made at another --resolution; expected that, too")
    place = options.output / ("check" if smoke else variant.name)
    return Workshop(making.found_program(options.program, ROOT), ROOT / "experiments", place, variant, smoke)


def experiments_of(rows):
    """{experiment: patterns of its runs} of what rows are made from."""
    return {source: patterns for source, patterns in making.sources_of(rows).items() if source not in PROGRAMS}


def list_times(workshop, rows):
    total = 0.0
    for source, patterns in experiments_of(rows).items():
        seconds = making.seconds_of(workshop, source, patterns)
        total += seconds
        print(f"{source:32} about {seconds / 60:6.1f} minutes", flush=True)
    print(f"{'in all':32} about {total / 3600:6.1f} hours")
    return 0


def check(workshop, rows, keep):
    """Runs all experiments in small, and compares the checksums of their records with those that are kept, or keeps them."""
    code, of_all = 0, experiments_of(ROWS.values())    # runs that other rows need are in the checksums, too
    for source in experiments_of(rows):
        making.make(workshop, source, of_all[source])
        now = checksums.table_of(records.read(workshop.folder_of(source)))
        file = workshop.checksum_file(source)
        if keep:
            checksums.write(file, now)
            said = f"kept in {file}"
        else:
            found = checksums.compared(checksums.read(file), now)
            code = max(code, found.state == checksums.OTHER)
            said = str(found)
        numbers = ", ".join(str(row.number) for row in rows if source in row.sources)
        print(f"{source} (row{'s' if ',' in numbers else ''} {numbers}): {said}", flush=True)
    return code


def values_of(workshop, row):
    """({name: Value}, {name: why there is none}) of a row's numbers."""
    found, missing, made = {}, {}, {}
    for name, number in (row.numbers or {}).items():
        source = number.made or row.made
        made.setdefault(source, Made(workshop.folder_of(source)))
        try:
            found[name] = number.take(made[source])
        except InputError as error:
            missing[name] = str(error)
    return found, missing


def judged(workshop, row, found, missing):
    """The verdict of a row."""
    try:
        if row.test and not making.passes(workshop, row.test):
            return f"{row.test} fails"
    except InputError as error:    # there is no such program
        complain(f"row {row.number}: {error}")
        return NOT_MADE
    if row.claims is None:
        return row.verdict
    if missing:
        return NOT_MADE
    return row.claims(found)


def answer(workshop, row):
    """Prints what came out of a row; its lines for the table."""
    found, missing = values_of(workshop, row)
    verdict = judged(workshop, row, found, missing)
    beside = "as the page says" if verdict == row.verdict else f"the page says {row.verdict}"
    print(f"row {row.number}, {row.made or row.test}: {verdict}, {beside}")
    lines = []
    for name, number in (row.numbers or {}).items():
        value = found.get(name)
        line = {"row": row.number, "made": number.made or row.made, "name": name, "stated": number.stated, "verdict": verdict,
                "stated_verdict": row.verdict}
        if value is None:
            line["agreement"] = missing[name]
        else:
            line |= {"value": value.value, "error": value.error, "agreement": claims.agreement(value, number.stated, number.unit)}
        stated = f" ({number.stated}: {line['agreement']})" if value is not None and number.stated else ""
        print(f"    {name}: {value if value is not None else missing[name]}{stated}")
        lines.append(line)
    return lines or [{"row": row.number, "made": row.test, "verdict": verdict, "stated_verdict": row.verdict}]


def run(workshop, rows):
    """Makes everything, and says what came of it. What cannot be made does not keep the rest from it."""
    is_lacking = False
    for source, patterns in making.sources_of(rows).items():
        try:
            for said in making.make(workshop, source, patterns):
                print(f"{source}: left out: {said}", flush=True)
        except InputError as error:
            is_lacking = True
            complain(f"{source}: {error}")
    lines = [line for row in rows for line in answer(workshop, row)]
    print(tables.write_table(workshop.output / "replications.csv", COLUMNS, lines))
    is_lacking = is_lacking or any(line["verdict"] == NOT_MADE for line in lines)
    is_off = any(line["verdict"] != line["stated_verdict"] for line in lines)
    if not workshop.variant.is_changed:    # whose numbers are others
        is_off = is_off or any(line.get("agreement") == claims.OFF for line in lines)
    return 2 if is_lacking else int(is_off)


def main(arguments):
    options = parser().parse_args(arguments)
    outcome = [2]

    def work():
        workshop = workshop_of(options)
        workshop = replace(workshop, output=workshop.output.resolve())
        rows = [ROWS[number] for number in dict.fromkeys(options.rows or ROWS)]
        outcome[0] = (list_times(workshop, rows) if options.list else
                      check(workshop, rows, options.keep) if workshop.smoke else run(workshop, rows))
    return max(answered(work), outcome[0])
