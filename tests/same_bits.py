"""Does one build of the program make what another makes, to the bit?

Seven scenes by every method, one thread and two, each in small: references, images, snapshots and records of `render`; an
experiment of several scenes and seeds with everything that `run` writes; and renders of NEW that were stopped and
continued beside those that were not. Every layer of every image is compared as bits and every cell of every table as text,
but for times and memory. NEW may have layers and columns that OLD has not: they are named, and are no difference.

    /usr/bin/python3 tests/same_bits.py OLD NEW [--only TEXT]

Prints what differs. Exit code: 0 nothing, 1 something, 2 a program could not do its work.
"""

import argparse
import csv
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy
import OpenImageIO

SCENES = Path(__file__).resolve().parents[1] / "scenes"
NAMES = ["cornell-box", "cornell-spheres", "glass-sphere", "lamp", "mirror-sphere", "point-light-plane", "water"]
# In its second block, what the first leaves at its default: among it an inexact search, and one of many nearest photons.
METHODS = {
    "ppm hachisuka": {"integrator": "ppm", "schedule": "hachisuka"},
    "ppm knaus-zwicker": {"integrator": "ppm", "schedule": "knaus-zwicker"},
    "photonmapper radius": {"integrator": "photonmapper", "mode": "radius"},
    "photonmapper nearest": {"integrator": "photonmapper", "mode": "nearest", "k": 20, "caustic_k": 10},
    "path": {"integrator": "path"},

    "ppm with eps": {"integrator": "ppm", "alpha": 0.5, "footprints": 5, "kernel": "cone", "eps": 1.0, "direct": "photons"},
    "photonmapper radius with eps": {"integrator": "photonmapper", "mode": "radius", "footprints": 4,
                                     "kernel": "epanechnikov", "eps": 0.5, "branch_cutoff": 0.01},
    "photonmapper nearest with eps": {"integrator": "photonmapper", "mode": "nearest", "k": 300, "caustic_k": 300,
                                      "kernel": "biweight", "eps": 2.0, "direct_samples": 2},
}
for method in METHODS.values():
    if method["integrator"] != "path":
        method["area"] = "disc"
METHODS["ppm by the area that is there"] = {"integrator": "ppm", "area": "seen"}
WIDTH, HEIGHT = 32, 24
SIZE = ["--resolution", f"{WIDTH}x{HEIGHT}", "--samples-per-pixel", "4"]
PASSES, PHOTONS = 5, 3000
MEASURED = ("seconds", "bytes", "rss")    # in names of columns: what no two runs have in common


class Comparison:
    """Counts what was compared, and prints and counts what differs."""

    def __init__(self):
        self.images = self.tables = self.differences = 0
        self.only_in_new = set()

    def report(self, what):
        self.differences += 1
        print(f"differs: {what}", flush=True)

    def image(self, old, new, what):
        self.images += 1
        old_layers, new_layers = read_channels(old), read_channels(new)
        self.only_in_new |= {f"channel {name}" for name in new_layers.keys() - old_layers.keys()}
        for name, expected in old_layers.items():
            found = new_layers.get(name)
            if found is None:
                self.report(f"{what}: no channel {name}")
            elif found.shape != expected.shape:
                self.report(f"{what}: channel {name} has the shape {found.shape}, expected {expected.shape}")
            elif found.tobytes() != expected.tobytes():
                pixels = found.view(numpy.uint32) != expected.view(numpy.uint32)
                largest = numpy.abs(found.astype(float) - expected)[pixels].max()
                self.report(f"{what}: channel {name}, {pixels.sum()} of {pixels.size} pixels, by up to {largest:.3g}")

    def table(self, old, new, what):
        self.tables += 1
        old_rows, new_rows = read_rows(old), read_rows(new)
        if len(old_rows) != len(new_rows):
            return self.report(f"{what}: {len(new_rows)} rows, expected {len(old_rows)}")
        differing = {}
        for number, (expected, found) in enumerate(zip(old_rows, new_rows), 2):
            self.only_in_new |= {f"column {name}" for name in found.keys() - expected.keys()}
            for column, value in expected.items():
                if found.get(column) != value and not any(word in column for word in MEASURED):
                    differing.setdefault(column, []).append(f"line {number}: {found.get(column)}, expected {value}")
        for column, places in differing.items():
            self.report(f"{what}: column {column} in {len(places)} of {len(old_rows)} rows, {places[0]}")

    def folder(self, old, new, what):
        """All images and tables below a folder, by their names there."""
        for file in sorted([*old.rglob("*.exr"), *old.rglob("*.csv")]):
            name = file.relative_to(old)
            if not (new / name).exists():
                self.report(f"{what}: no {name}")
            else:
                (self.image if file.suffix == ".exr" else self.table)(file, new / name, f"{what}: {name}")


def read_channels(file):
    image = OpenImageIO.ImageInput.open(str(file))
    pixels = image and image.read_image(OpenImageIO.FLOAT)
    if pixels is None:
        sys.exit(f"{file}: cannot be read as an image: {OpenImageIO.geterror()}")
    return {name: numpy.ascontiguousarray(pixels[:, :, index]) for index, name in enumerate(image.spec().channelnames)}


def read_rows(file):
    with open(file, newline="", encoding="utf-8") as table:
        return list(csv.DictReader(table))


def call(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        print(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stderr}", file=sys.stderr)
        sys.exit(2)


def arguments_of(method):
    return [part for name, value in method.items() for part in (f"--{name.replace('_', '-')}", value)]


def render_command(program, scene, method, threads, folder, passes=PASSES):
    photons = [] if method["integrator"] == "path" else ["--photons", PHOTONS]
    folder.mkdir(parents=True)
    return [program, "render", SCENES / scene / "scene.xml", "-o", folder / "image.exr", *SIZE, "--passes", passes, *photons,
            "--threads", threads, "--csv", folder / "records.csv", *arguments_of(method)]


def compare_renders(programs, folder, scene, comparison):
    for program, place in zip(programs, ("old", "new")):
        call(program, "reference", SCENES / scene / "scene.xml", "-o", folder / place / "references" / scene, *SIZE,
             "--samples", 8, "--threads", 2)
    comparison.folder(folder / "old/references" / scene, folder / "new/references" / scene, f"reference of {scene}")
    for name, method in METHODS.items():
        for threads in (1, 2):
            what = f"{scene}, {name}, {threads} thread(s)"
            for program, place in zip(programs, ("old", "new")):
                call(*render_command(program, scene, method, threads, folder / place / what),
                     "--reference", folder / place / "references" / scene, "--snapshots", "0,1,3")
            comparison.folder(folder / "old" / what, folder / "new" / what, what)


def compare_experiments(programs, folder, scenes, comparison):
    """Methods side by side on the same photons, bias and variance, probes."""
    tables = [
        f"""[[scenes]]
path = "{SCENES / scene / 'scene.xml'}"
reference = "references/{scene}"
resolution = [{WIDTH}, {HEIGHT}]
regions = {{ left = [0, 0, {WIDTH // 2}, {HEIGHT}] }}
probes = {{ middle = [{WIDTH // 2}, {HEIGHT // 2}] }}
""" for scene in scenes]
    for name, method in METHODS.items():
        settings = "".join(f"{key} = {value!r}\n" for key, value in method.items())
        tables.append(f"[[method]]\nname = '{name.replace(' ', '-')}'\n{settings}")
    for threads in (1, 2):
        for program, place in zip(programs, ("old", "new")):
            experiment = folder / place / f"experiment-{threads}.toml"
            experiment.write_text(f"title = 'The same?'\nseeds = 2\npasses = {PASSES}\nrecord = 'all'\nsnapshots = [0, 2]\n"
                                  f"photons_per_pass = {PHOTONS}\nsamples_per_pixel = 4\nthreads = {threads}\n"
                                  f"decomposition = true\n\n" + "\n".join(tables), encoding="utf-8")
            call(program, "run", experiment, "-o", folder / place / f"results-{threads}")
        comparison.folder(folder / f"old/results-{threads}", folder / f"new/results-{threads}",
                          f"experiment, {threads} thread(s)")


def compare_continuations(program, folder, scene, comparison, passes=150):
    """Stopped after a pass, and continued from the checkpoint: what an uninterrupted render is."""
    for name, method in METHODS.items():
        what = f"{scene}, {name}, continued"
        call(*render_command(program, scene, method, 2, folder / "uninterrupted" / name, passes))
        checkpoint = folder / f"{name}.checkpoint"
        command = [str(part) for part in [*render_command(program, scene, method, 2, folder / "continued" / name, passes),
                                          "--checkpoint", checkpoint, "--checkpoint-seconds", "0.001", "--resume"]]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            while process.poll() is None and not checkpoint.exists():
                time.sleep(0.001)
            process.send_signal(signal.SIGTERM)
        if process.returncode != 3:
            print(f"{what}: expected to be stopped (exit code 3), got {process.returncode}", file=sys.stderr)
            sys.exit(2)
        call(*command)
        comparison.folder(folder / "uninterrupted" / name, folder / "continued" / name, what)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("old", metavar="OLD", type=Path, help="photonlab as it was")
    parser.add_argument("new", metavar="NEW", type=Path, help="photonlab as it is")
    parser.add_argument("--only", metavar="TEXT", default="", help="scenes whose names contain TEXT")
    arguments = parser.parse_args()
    scenes = [name for name in NAMES if arguments.only in name]
    if not scenes:
        parser.error(f"--only {arguments.only}: expected part of one of: {', '.join(NAMES)}")
    programs = (arguments.old.resolve(), arguments.new.resolve())
    comparison = Comparison()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for scene in scenes:
            compare_renders(programs, folder, scene, comparison)
        compare_experiments(programs, folder, scenes, comparison)
        compare_continuations(programs[1], folder, scenes[0], comparison)
    for name in sorted(comparison.only_in_new):
        print(f"only in NEW: {name}")
    print(f"{comparison.images} images and {comparison.tables} tables compared: {comparison.differences} differences")
    return 1 if comparison.differences else 0


if __name__ == "__main__":
    sys.exit(main())
