#!/usr/bin/python3
"""compare.py A B: two results folders, which should be the same but for measured times and memory and for the number of
threads: rows of tables, pixels of images, bytes of sums over seeds; and nothing is left over in B. Exit code 1 where not."""

import csv
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "analysis"))
from photonlab.records import images

MEASURED = ("seconds", "rss", "threads", "bytes")    # in names of columns


def rows(folder, name):
    file = folder / name
    if not file.exists():
        return None
    with open(file, newline="") as stream:
        return [{key: value for key, value in row.items() if not any(word in key for word in MEASURED)}
                for row in csv.DictReader(stream)]


def differences(a, b):
    for name in ["iterations.csv", "probes.csv"]:
        if rows(a, name) != rows(b, name):
            yield f"{name}: other rows"
    files = [sorted(str(file.relative_to(folder)) for file in folder.rglob("*.exr")) for folder in (a, b)]
    if files[0] != files[1]:
        yield f"other images: {sorted(set(files[0]) ^ set(files[1]))[:5]}"
    for name in set(files[0]) & set(files[1]):
        if name.startswith("ensembles/"):
            is_same = (a / name).read_bytes() == (b / name).read_bytes()
        else:
            one, other = (images.read_image(folder / name)[1] for folder in (a, b))
            is_same = numpy.array_equal(one, other, equal_nan=True)
        if not is_same:
            yield f"{name}: other content"
    for file in b.rglob("*"):
        if file.name.endswith("lock") or ".partial" in file.name or file.name.startswith("checkpoint"):
            yield f"left over: {file}"


a, b = map(Path, sys.argv[1:3])
found = list(differences(a, b))
print("\n".join(found[:20]) or f"the same: {len(rows(a, 'iterations.csv'))} rows, {len(list(a.rglob('*.exr')))} images")
sys.exit(bool(found))
