"""What has been made of a folder of results: RESULTS/analysis.json names for each command which records it was made from, what it said
and which files it wrote, so that nothing is made twice. What was written by another version of this package, from other records, or
is not as it was written, is made again.
"""

import json
from pathlib import Path

from photonlab.records import files, kept_files
from photonlab.records.files import InputError

NAME = "analysis.json"
# What commands read beside the records, and what those name with checksums.
OTHER_INPUTS = ["probes.csv", "scaling.csv", "deviations.csv", "relaxation.csv"]


def version():
    """The hash of this package."""
    folder = Path(__file__).parent
    hashed = kept_files.running_hash(b"")
    for file in sorted(folder.rglob("*")):
        if file.suffix in [".py", ".json", ".html", ".css", ".js"]:
            hashed.update(f"{file.relative_to(folder)}\0".encode() + file.read_bytes())
    return hashed.hexdigest()


class Kept:
    """What analysis.json says. A file that is there and is none of ours is as good as none: it is replaced."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.inputs = [version(), *(kept_files.hash_of_file(self.folder / name)
                                    if files.is_there(self.folder / name) else "" for name in OTHER_INPUTS)]
        self.before, self.now = {}, {}
        try:
            found = files.read_json(self.folder / NAME) if files.is_there(self.folder / NAME) else {}
            self.before = found["commands"] if found.get("schema") == 1 else {}
        except (InputError, AttributeError, KeyError):
            pass

    def said(self, command, made_from):
        """What a command said when it made of the same what is still there; None where it is to be made."""
        entry = self.before.get(command) if isinstance(self.before, dict) else None
        try:
            if entry["made_from"] != [made_from, *self.inputs] or not all(
                    self.hash_of(name) == known for name, known in entry["files"].items()):
                return None
            self.now[command] = entry
            return entry["said"]
        except (TypeError, KeyError, AttributeError, InputError):
            return None

    def hash_of(self, name):
        return kept_files.hash_of_file(self.folder / name)

    def keep(self, command, made_from, said):
        """Keeps what a command has made: what it says by its name is a file of the folder."""
        written = [Path(text).relative_to(self.folder) for text in said if isinstance(text, Path)]
        self.now[command] = {"made_from": [made_from, *self.inputs], "said": [str(text) for text in said],
                             "files": {str(name): self.hash_of(name) for name in written}}

    def write(self):
        if self.now != self.before:
            files.replace_file(self.folder / NAME, json.dumps({"schema": 1, "commands": self.now}, indent=1) + "\n")
