"""What runs were judged by, found again from what run.json and ensemble.json name."""

from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files, images, kept_files
from photonlab.records.files import InputError

IS_ANOTHER = "is another one than the errors in the records are against"


@dataclass
class Reference:
    """What a run was judged by."""
    path: str
    halves: list    # the EXRs of two halves, or of one image; none where it cannot be used
    why_not: str    # it cannot be


def check_reference(file, description):
    """Throws InputError unless a description in JSON names its reference as reference_of() needs it."""
    reference = description.get("reference")
    if reference is not None and not (isinstance(reference, dict) and isinstance(reference.get("path"), str) and
                                      isinstance(reference.get("key", ""), str)):
        raise InputError(f"{file}: expected \"reference\" to be null or an object with \"path\"")
    if not isinstance(description.get("working_directory", ""), str):
        raise InputError(f"{file}: expected \"working_directory\" to be a path")


def reference_of(records, description):
    """What a run.json or ensemble.json names as its reference; None where it names none. A relative path is relative to the folder
    in which the run was started, which is named too; where that is not there any more (the results came from another machine), to
    the folder of this one."""
    named = description.get("reference")
    if named is None:
        return None
    path, key = named["path"], named.get("key")
    for start in [description.get("working_directory") or ".", ".", records.folder]:
        found = Path(start) / path
        halves = [found / "half_a.exr", found / "half_b.exr"]
        if all(files.is_there(half) for half in halves):
            return reference_of_halves(path, found, halves, key)
        if files.is_there(found) and not found.is_dir():
            with files.opened(found) as stream:
                is_same = key is None or kept_files.hash_of_stream(found, stream) == key
            return Reference(path, [found] if is_same else [], "" if is_same else IS_ANOTHER)
    return Reference(path, [], "is not there")


def read_reference_of(records, run, component="total", photons_carry_direct=False):
    """(what a run was judged by, its radiance of a component), each None where there is none."""
    judge = reference_of(records, run.description)
    return judge, images.read_reference(judge.halves, component, photons_carry_direct) if judge else None


def reference_of_halves(path, folder, halves, key):
    """The halves with the checksums in reference.json, if that is of the reference with this key, or it is not known which."""
    file = folder / "reference.json"
    if not files.is_there(file):
        return Reference(path, halves, "") if key is None else Reference(path, [], "has no reference.json")
    description = files.read_json(file)
    checksums = description.get("checksums") if isinstance(description, dict) else None
    if not isinstance(checksums, dict) or not all(isinstance(checksums.get(half.stem), str) for half in halves):
        raise InputError(f"{file}: expected \"checksums\" of half_a and half_b")
    if key is not None and f"{description.get('key')}-{description.get('samples_per_half')}" != key:
        return Reference(path, [], IS_ANOTHER)
    advice = "bring the reference back as it was, or make it anew"
    return Reference(path, [kept_files.KeptFile(half, None, checksums[half.stem], advice) for half in halves], "")
