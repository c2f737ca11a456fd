"""An experiment with other seeds, at another resolution or with fewer passes: its file, read and written again with what is changed.

Regions and probes keep their place in the picture. A reference is one of a resolution, so that at another one each is made, as the one
that the experiment names was: by path tracing over the same positions, with as many samples as are asked for. What cannot be had like
that (a reference by ppm) leaves its scene out.
"""

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

from photonlab.records import files
from photonlab.records.files import InputError


@dataclass(frozen=True)
class Variant:
    """What is changed; None where it is not."""
    first_seed: int = None
    seeds: int = None         # how many
    resolution: int = None    # pixels a side
    passes: int = None        # at most
    samples: int = 1024       # of references that are made

    @property
    def is_changed(self):
        return (self.first_seed, self.seeds, self.resolution, self.passes) != (None,) * 4

    @property
    def name(self):
        """As part of a folder's name."""
        parts = [("from", self.first_seed), ("seeds", self.seeds), ("side", self.resolution), ("passes", self.passes)]
        return "_".join(f"{name}-{value}" for name, value in parts if value is not None) or "as-written"


@dataclass(frozen=True)
class NeededReference:
    scene: Path
    folder: Path
    samples: int       # a half
    arguments: list    # the others of `photonlab reference`, after the scene and the folder


def read(file):
    try:
        return tomllib.loads(files.read_text(file))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{file}: {error}") from error


def changed(experiment, folder, variant, references, patterns=()):
    """(the experiment, references that it needs, scenes that are left out). `folder` is that of its file; new references stand in
    `references`. Scenes of which no run matches the patterns are not in it."""
    experiment = dict(experiment)
    experiment["seeds"] = seeds_of(experiment.get("seeds", 1), variant)
    if variant.passes:
        limit_passes(experiment, variant.passes)
    scenes, needed, left_out = [], [], []
    for scene in experiment["scenes"]:
        scene = {"path": scene} if isinstance(scene, str) else dict(scene)
        if not is_needed(name_of(scene), patterns):
            continue
        scene["path"] = str((folder / scene["path"]).resolve())
        if "reference" in scene:
            scene["reference"] = str((folder / scene["reference"]).resolve())
        if variant.resolution:
            made = at_resolution(scene, experiment, variant, references)
            if isinstance(made, str):
                left_out.append(made)
                continue
            needed += made
        scenes.append(scene)
    experiment["scenes"] = scenes
    if variant.resolution:
        experiment.pop("resolution", None)
    return experiment, needed, left_out


def name_of(scene):
    """What the program calls it."""
    path = Path(scene["path"])
    return scene.get("name") or (path.parent.name if path.name == "scene.xml" else path.stem)


def is_needed(scene, patterns):
    """Whether a run of the scene may match: a pattern begins with the name of its scene, or with a *."""
    return not patterns or any(pattern.startswith(("*", f"{scene}_")) for pattern in patterns)


def seeds_of(written, variant):
    listed = list(range(1, written + 1)) if isinstance(written, int) else written
    count = min(variant.seeds or len(listed), len(listed))
    return listed[:count] if variant.first_seed is None else list(range(variant.first_seed, variant.first_seed + count))


def limit_passes(experiment, most):
    """At most so many passes; methods with more photons or other passes a pass keep the proportion."""
    factor = min(1.0, most / experiment["passes"])
    experiment["method"] = [dict(method) for method in experiment["method"]]
    for table in [experiment, *experiment["method"]]:
        if "passes" in table:
            table["passes"] = max(1, round(table["passes"] * factor))
    for name in ["record", "snapshots"]:
        if isinstance(experiment.get(name), list):
            experiment[name] = sorted({min(number, experiment["passes"]) for number in experiment[name]})


def at_resolution(scene, experiment, variant, references):
    """Changes the scene to the resolution: the references that it then needs, or why it is left out."""
    name = name_of(scene)
    side, needed = variant.resolution, []
    width, height = scene.get("resolution") or experiment.get("resolution") or [None, None]
    if "reference" in scene:
        file = Path(scene["reference"]) / "reference.json"
        description = files.read_json(file)
        if description.get("integrator") != "path":
            return f"{name}: its reference is by {description.get('integrator')}, and is made at no other resolution here"
        width, height = description["width"], description["height"]
        arguments = ["--resolution", f"{side}x{side}", "--samples-per-pixel", str(description["samples_per_pixel"])]
        if description.get("positions", "grid") != "grid":
            arguments += ["--positions", description["positions"]]
        folder = references / f"{Path(scene['reference']).name}-{side}"
        needed.append(NeededReference(Path(scene["path"]), folder, variant.samples, arguments))
        scene["reference"] = str(folder)
    if (width is None and ("regions" in scene or "probes" in scene)) or (width is not None and width != height):
        return f"{name}: its pictures are {width}x{height}, expected a square of a known side"
    for kind in ["regions", "probes"]:
        if kind in scene:
            scene[kind] = {key: [round(place * side / width) for place in pixels] for key, pixels in scene[kind].items()}
    scene["resolution"] = [side, side]
    return needed


def written(experiment):
    """The experiment as TOML."""
    lines = [f"{name} = {value_text(value)}" for name, value in experiment.items() if name != "method"]
    for method in experiment["method"]:
        lines += ["", "[[method]]", *(f"{name} = {value_text(value)}" for name, value in method.items())]
    return "\n".join(lines) + "\n"


def value_text(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(name)} = {value_text(own)}" for name, own in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    return repr(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)
