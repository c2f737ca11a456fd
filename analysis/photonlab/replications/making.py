"""Makes what rows are made from: calls the program for experiments, and programs of the tests for their tables, into a folder each.

What is finished is not made again, since `photonlab run` goes on where it was; a table of a test's program is made where it is not
there.
"""

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files
from photonlab.records.files import InputError
from photonlab.replications import variants
from photonlab.replications.rows import PROGRAMS

REPLICATIONS = "replications"


@dataclass(frozen=True)
class Workshop:
    """Where things are."""
    program: Path
    experiments: Path     # the folder of experiment files
    output: Path
    variant: variants.Variant = variants.Variant()
    smoke: bool = False

    @property
    def build(self):
        """The folder of the build that the program is in, if it is in one."""
        return self.program.parents[2] if len(self.program.parents) > 2 else Path()

    def folder_of(self, source):
        return self.output / Path(source).name.removesuffix(".csv")

    def experiment_file(self, source):
        return self.experiments / f"{source}.toml"

    def checksum_file(self, source):
        """Beside the experiments of this folder, those of the others too."""
        return self.experiments / REPLICATIONS / f"{Path(source).name}.csv"


def found_program(named, root):
    """The program that is named, or that of the build, or the installed one."""
    built = root / "build/release/src/app/photonlab"
    found = named or (built if built.exists() else shutil.which("photonlab"))
    if not found or not Path(found).exists():
        raise InputError(f"{found or built}: is not there; expected the program: build it, or name it with --program")
    return Path(found).resolve()


def sources_of(rows):
    """{what rows are made from: patterns of runs, none where all are needed}."""
    found = {}
    for row in rows:
        for source, patterns in row.sources.items():
            before = found.get(source)
            found[source] = () if before == () or not patterns else tuple(dict.fromkeys([*(before or ()), *patterns]))
    return found


def call(arguments, quiet=False):
    """What the program prints. Its progress and its messages go where ours go."""
    done = subprocess.run([str(argument) for argument in arguments], stdout=subprocess.PIPE if quiet else None, check=False)
    if done.returncode:
        raise InputError(f"{' '.join(map(str, arguments))}: ended with exit code {done.returncode}")
    return done.stdout


def make_reference(workshop, reference):
    """Adds the samples that it lacks, as after a call that was stopped."""
    file = reference.folder / "reference.json"
    made = files.read_json(file).get("samples_per_half", 0) if files.is_there(file) else 0
    if made < reference.samples:
        call([workshop.program, "reference", reference.scene, "-o", reference.folder, "--samples", reference.samples - made,
              *reference.arguments])


def run_commands(workshop, source, patterns, is_judged=True):
    """(the calls of `photonlab run` that make the runs of an experiment, references that they need first, what is said of scenes that
    are left out). Where they are not judged they need none, and make what is nobody's."""
    file, folder, needed, said = workshop.experiment_file(source), workshop.folder_of(source), [], []
    if workshop.variant.is_changed:
        experiment, needed, said = variants.changed(variants.read(file), file.parent.resolve(), workshop.variant,
                                                    workshop.output / "references", patterns)
        place = workshop.output / "changed"
        if not is_judged:
            experiment["scenes"] = [{key: value for key, value in scene.items() if key != "reference"} for scene in experiment["scenes"]]
            place, folder, needed = workshop.output / "listed", workshop.output / "listed" / "nothing", []
        file = files.replace_file(place / Path(source).with_suffix(".toml").name, variants.written(experiment))
    command = [workshop.program, "run", file, "-o", folder, *(["--smoke"] if workshop.smoke else [])]
    return [[*command, "--only", f"{pattern}_seed-*"] for pattern in patterns] or [command], needed, said


def make(workshop, source, patterns):
    """Makes what rows are made from; returns what is left out."""
    if source in PROGRAMS:
        make_table(workshop, source)
        return []
    commands, needed, said = run_commands(workshop, source, patterns)
    for reference in needed:
        make_reference(workshop, reference)
    for command in commands:
        call(command)
    return said


def seconds_of(workshop, source, patterns):
    """How long the program thinks that what is not finished will take; of what is changed, all, without its references."""
    commands, _, _ = run_commands(workshop, source, patterns, is_judged=False)
    return sum(group["seconds"] for command in commands for group in json.loads(call([*command, "--list", "--json"], quiet=True))["groups"])


def make_table(workshop, name):
    file = workshop.folder_of(name) / name
    if not files.is_there(file):
        files.replace_file(file, call([test_program(workshop, PROGRAMS[name])], quiet=True))


def test_program(workshop, name):
    program = workshop.build / name
    if not program.exists():
        raise InputError(f"{program}: is not there; cmake --build --preset release --target {Path(name).name}")
    return program


def passes(workshop, test):
    """Whether the test that stands for a row passes."""
    name, *arguments = test.split()
    done = subprocess.run([str(test_program(workshop, name)), *arguments, "--gtest_brief=1"], stdout=subprocess.DEVNULL, check=False)
    return done.returncode == 0
