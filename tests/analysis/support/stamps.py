"""Makes a folder of made-up results one of a program that writes down what each file is (src/core/files/kept_files.h), from the
description of the format alone."""

import csv
import json
from pathlib import Path

import OpenImageIO
import xxhash


def hash_of(data):
    return xxhash.xxh3_128_hexdigest(data)


def stamp_of(file):
    return {"bytes": file.stat().st_size, "hash": hash_of(file.read_bytes())}


def write_with_checksum(file, value):
    text = json.dumps(value, indent=2)[:-2]    # without "\n}"
    file.write_text(f'{text},\n  "checksum": "{hash_of(text.encode())}"\n}}\n')


def change(file, **changed):
    """Writes a description again with other values, as if the program had."""
    description = {**json.loads(file.read_text()), **changed}
    description.pop("checksum")
    write_with_checksum(file, description)


def stamp(results):
    """All of a folder, as it is."""
    results = Path(results)
    header, *lines = (results / "iterations.csv").read_text().splitlines(keepends=True)
    for folder in sorted((results / "ensembles").glob("*")):
        description = json.loads((folder / "ensemble.json").read_text())
        write_with_checksum(folder / "ensemble.json", {**description, "key": f"key-of-{folder.name}"})
        for slot in sorted(folder.glob("slot-*.exr")):
            seal(slot, f"key-of-{folder.name}")
    runs = [row["run"] for row in csv.DictReader([header, *lines])]
    for run in dict.fromkeys(runs):
        folder = results / "runs" / run
        folder.mkdir(parents=True, exist_ok=True)
        own = [line for line, name in zip(lines, runs) if name == run]
        (folder / "iterations.csv").write_text("".join([header, *own]))
        point = run.rpartition("_seed-")[0]
        description = {"run": run, "snapshots": [], "reference": None}
        if (folder / "run.json").exists():
            description = json.loads((folder / "run.json").read_text())
        write_with_checksum(folder / "run.json", {
            **description, "files": {str(file.relative_to(folder)): stamp_of(file) for file in sorted(folder.rglob("*"))
                                     if file.is_file() and file.name != "run.json"},
            "ensemble": {"folder": f"ensembles/{point}", "key": f"key-of-{point}"}})
    write_merged(results)


def write_merged(results):
    write_with_checksum(results / "merged.json", {"schema": 1, "experiment": "made-up", "files": {
        name: [stamp_of(results / name)] for name in ["iterations.csv", "probes.csv"] if (results / name).exists()}})


def seal(file, key):
    """An EXR that knows its own checksum (src/image/exr.h)."""
    image = OpenImageIO.ImageInput.open(str(file))
    spec, pixels = image.spec(), image.read_image(OpenImageIO.FLOAT)
    image.close()
    for name, value in [("photonlab.key", key), ("photonlab.bytes", "0" * 20), ("photonlab.checksum", "0" * 32)]:
        spec.attribute(name, value)
    output = OpenImageIO.ImageOutput.create(str(file))
    assert output.open(str(file), spec) and output.write_image(pixels) and output.close()
    data = file.read_bytes()
    for name, digits in [("bytes", f"{len(data):020}"), ("checksum", None)]:
        place = data.index(f"photonlab.{name}\0string\0".encode()) + len(f"photonlab.{name}\0string\0") + 4
        digits = digits or hash_of(data)
        data = data[:place] + digits.encode() + data[place + len(digits):]
    file.write_bytes(data)
