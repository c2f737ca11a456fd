"""What a run left beside its rows: run.json and snapshots, as they were written."""

from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files, kept_files, references
from photonlab.records.files import InputError


@dataclass
class Run:
    """What a run left beside its rows."""
    folder: Path
    description: dict    # run.json
    snapshots: dict      # {pass: file}


def read_run(records, name):
    """A run with what figures need checked."""
    folder = records.folder / "runs" / name
    file = folder / "run.json"
    advice = f"move {folder} away and run the experiment again, which makes this run alone anew"
    description = kept_files.read_json(file, advice, must_be_checked=records.has_stamps)
    snapshots = description.get("snapshots") if isinstance(description, dict) else None
    if not isinstance(snapshots, list) or not all(
            isinstance(snapshot, dict) and isinstance(snapshot.get("pass"), int) and
            isinstance(snapshot.get("file"), str) for snapshot in snapshots):
        raise InputError(f"{file}: expected \"snapshots\", a list of objects with \"pass\" and \"file\"")
    references.check_reference(file, description)
    by_pass = {snapshot["pass"]: snapshot["file"] for snapshot in snapshots}
    listed = description.get("files")
    if listed is None and not records.has_stamps:
        found = {number: folder / name for number, name in by_pass.items()}
        return Run(folder, description, {number: file for number, file in found.items() if files.is_there(file)})
    if not isinstance(listed, dict):
        raise InputError(f"{file}: expected \"files\", the bytes and hash of each file of the run")
    own_rows = kept_files.kept_file(folder / "iterations.csv", listed.get("iterations.csv"), advice)
    if records.rows_by_run[name] != own_rows.hash:
        raise InputError(f"{records.file}: the rows of {name} are of another making of this run than what is in {folder}; "
                         f"{kept_files.RUN_AGAIN}")
    return Run(folder, description, {number: kept_files.kept_file(folder / name, listed.get(name), advice)
                                     for number, name in by_pass.items()})
