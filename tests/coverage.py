#!/usr/bin/env python3
"""tests/coverage.py BUILD: which lines of src/ the tests of a coverage build ran, file by file, and which not.

Reads what GCC left beside the objects, through gcov. A line counts as run when any translation unit ran it.
"""

import collections
import json
import pathlib
import subprocess
import sys


def count_lines(build: pathlib.Path, source: pathlib.Path) -> dict[str, dict[int, int]]:
    """Of each file of src/, how often each line ran."""
    counts: dict[str, dict[int, int]] = collections.defaultdict(lambda: collections.defaultdict(int))
    for notes in sorted(build.glob("src/**/*.gcno")) + sorted(build.glob("tests/**/*.gcno")):
        if not notes.with_suffix(".gcda").exists():
            continue
        report = subprocess.run(
            ["gcov", "--json-format", "--stdout", notes], capture_output=True, check=True, text=True, cwd=build
        ).stdout
        for line in report.splitlines():
            for file in json.loads(line)["files"]:
                path = (build / file["file"]).resolve()
                if not path.is_relative_to(source / "src"):
                    continue
                for counted in file["lines"]:
                    counts[str(path.relative_to(source))][counted["line_number"]] += counted["count"]
    return counts


def ranges(numbers: list[int]) -> str:
    """3, 4, 5, 9 as "3-5, 9"."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    build = pathlib.Path(sys.argv[1]).resolve()
    counts = count_lines(build, pathlib.Path(__file__).resolve().parent.parent)
    if not counts:
        print(f"{build}: no lines were counted; expected a coverage build whose tests have run", file=sys.stderr)
        return 2
    ran_of_all = all_lines = 0
    for file, lines in sorted(counts.items()):
        ran = sum(count > 0 for count in lines.values())
        missed = sorted(number for number, count in lines.items() if count == 0)
        ran_of_all += ran
        all_lines += len(lines)
        if missed:
            print(f"{100 * ran / len(lines):5.1f}% of {len(lines):4d}  {file}: {ranges(missed)}")
    print(f"{100 * ran_of_all / all_lines:5.1f}% of {all_lines} lines of src/ ran")
    return 0


if __name__ == "__main__":
    sys.exit(main())
