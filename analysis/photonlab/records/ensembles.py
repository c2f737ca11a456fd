"""Sums of images over independent seeds, which `photonlab run` keeps in RESULTS/ensembles for an experiment with
`decomposition = true`, in up to 16 groups of seeds for each point of the experiment."""

from dataclasses import dataclass
from pathlib import Path

import numpy

from photonlab.records import images, kept_files, methods, references
from photonlab.records.files import InputError

WHOLE = "image"    # the region of all pixels


@dataclass
class Ensemble:
    """The sums of one point of an experiment: a method with its settings, on a scene."""
    folder: Path
    description: dict    # ensemble.json
    seeds: list          # a list a group
    layers: list         # {layer: array (height, width, 3)} a group: means over its seeds
    judged: dict         # what names its reference: ensemble.json, or better run.json, which says which one it was then

    @property
    def point(self):
        return self.description["point"]

    @property
    def counts(self):
        """Seeds in each group."""
        return numpy.array([len(group) for group in self.seeds], dtype=float)

    def component(self, group, number, component):
        """A group's mean image of a component after pass `number`."""
        layers = self.layers[group]
        parts = {"emission": ["emission"], "direct": [f"pass-{number:06}-direct"],
                 "gathered": [f"pass-{number:06}-gathered"],
                 "total": ["emission", f"pass-{number:06}-direct", f"pass-{number:06}-gathered"]}[component]
        return sum(layers[part] for part in parts)


REST = "-rest"    # of a layer: what the nearest float leaves of its sum


def read_slot(file, key):
    """(seeds, {layer: mean over them}) of one file of sums. `key` is that of the sums beside it, if they have checksums; None where
    they have none."""
    advice = "remove it and run the experiment again, which makes the runs of its seeds anew"
    spec, pixels = images.read_image(file, lambda stream: key and kept_files.require_seal(file, stream, advice))
    if key and str(spec.getattribute("photonlab.key")) != key:
        raise InputError(f"{file}: its sums are of other settings than ensemble.json beside it; run the experiment again")
    seeds = str(spec.getattribute("photonlab.seeds") or "").split()
    if not seeds or not all(seed.isdecimal() and len(seed) < 21 for seed in seeds):
        raise InputError(f"{file}: expected sums of images with the attribute photonlab.seeds")
    places = {}
    for index, name in enumerate(spec.channelnames):
        layer, _, channel = name.rpartition(".")
        if layer:
            places.setdefault(layer, {})[channel] = index
    if not all(set(channels) == set("RGB") for channels in places.values()):
        raise InputError(f"{file}: expected the channels R, G and B of each layer")
    sums = {layer: pixels[:, :, [channels[channel] for channel in "RGB"]].astype(numpy.float64)
            for layer, channels in places.items()}
    rests = {layer.removesuffix(REST): sums.pop(layer) for layer in list(sums) if layer.endswith(REST)}
    if not rests.keys() <= sums.keys():
        raise InputError(f"{file}: expected with each layer of rests that of its sums")
    return [int(seed) for seed in seeds], {
        layer: (pixels_of_layer + rests.get(layer, 0.0)) / len(seeds) for layer, pixels_of_layer in sums.items()}


def are_whole(numbers):
    return isinstance(numbers, list) and all(type(number) is int and number >= 0 for number in numbers)


# What ensemble.json has, and what each must be.
DESCRIPTION = {
    "point": (lambda value: isinstance(value, str), "a name"),
    "scene": (lambda value: isinstance(value, str), "a name"),
    "passes": (lambda value: are_whole(value) and value and len(set(value)) == len(value), "different passes"),
    "regions": (lambda value: isinstance(value, dict) and WHOLE not in value and
                all(are_whole(region) and len(region) == 4 for region in value.values()),
                f"left, top, right, bottom by name, which is not {WHOLE}"),
    "reference": (lambda value: value is None or (isinstance(value, dict) and isinstance(value.get("path"), str)), "a path, or null"),
    "photons_carry_direct": (lambda value: isinstance(value, bool), "true or false"),
}


def read_description(results, folder):
    """ensemble.json, checked."""
    file = folder / "ensemble.json"
    description = kept_files.read_json(file, "run the experiment again, which writes it anew", must_be_checked=results.has_stamps)
    if not isinstance(description, dict):
        raise InputError(f"{file}: is not the description of an ensemble")
    for key, (is_sound, expected) in DESCRIPTION.items():
        if key not in description or not is_sound(description[key]):
            raise InputError(f"{file}: {key}: expected {expected}")
    references.check_reference(file, description)
    if description["point"] != folder.name:
        raise InputError(f"{file}: point: expected the name of its folder")
    return description


def read_ensemble(results, folder):
    description = read_description(results, folder)
    key = description.get("key") if results.has_stamps else None
    seeds, layers = [], []
    for slot in sorted(folder.glob("slot-*.exr")):
        own_seeds, own_layers = read_slot(slot, key)
        expected = {"emission", *(f"pass-{number:06}-{layer}" for number in description["passes"]
                                  for layer in ["direct", "gathered"])}
        if set(own_layers) != expected:
            raise InputError(f"{slot}: expected the layers of the passes in ensemble.json")
        if layers and own_layers["emission"].shape != layers[0]["emission"].shape:
            raise InputError(f"{slot}: is of another size than the sums beside it")
        seeds.append(own_seeds)
        layers.append(own_layers)
    if len(seeds) < 2:
        raise InputError(f"{folder}: expected at least two seeds, found {len(seeds)}")
    all_seeds = [seed for group in seeds for seed in group]
    if len(set(all_seeds)) < len(all_seeds):
        raise InputError(f"{folder}: expected each seed in one slot; move the folder away and run the experiment again, which makes "
                         "its seeds anew")
    return Ensemble(folder, description, seeds, layers, description)


def read_ensembles(results):
    """Ensembles of a results folder, one after another: only one is in memory at a time."""
    folders = sorted((results.folder / "ensembles").glob("*/"))
    if not folders:
        raise InputError(f"{results.folder}: has no ensembles; expected an experiment with decomposition = true")
    for folder in folders:
        yield read_ensemble(results, folder)


def read_halves(ensemble, results, component):
    """[A, B] or [image] of the reference's component; empty where it does not have it or there is no reference."""
    carried = ensemble.description["photons_carry_direct"]
    judge = references.reference_of(results, ensemble.judged)
    if judge is None:
        return []
    if not judge.halves:
        raise InputError(f"{ensemble.folder}: its reference {judge.path} {judge.why_not}; bring it back, or run the experiment again")
    halves = [images.read_component(file, component, carried) for file in judge.halves]
    for file, half in zip(judge.halves, halves):
        if half is not None and half.shape != ensemble.layers[0]["emission"].shape:
            raise InputError(f"{ensemble.folder}: its reference is of another size than its images: {file}")
    return halves if all(half is not None for half in halves) else []


def regions_of(ensemble, shape):
    """{name: (slice of rows, slice of columns)}, the whole image first."""
    regions = {WHOLE: (slice(0, shape[0]), slice(0, shape[1]))}
    for name, (left, top, right, bottom) in ensemble.description["regions"].items():
        if not (left < right <= shape[1] and top < bottom <= shape[0]):
            raise InputError(f"{ensemble.folder}: expected the region {name} inside {shape[1]}x{shape[0]} pixels, and not "
                                      "empty")
        regions[name] = (slice(top, bottom), slice(left, right))
    return regions


def read_points(results, left_out):
    """(ensemble, records of its runs), one after another; what has no runs is told to `left_out`."""
    for ensemble in read_ensembles(results):
        own = rows_of(ensemble, results)
        if own is None:
            left_out.append(f"{ensemble.folder}: has no runs in iterations.csv; left out")
        else:
            yield ensemble, own


def rows_of(ensemble, results):
    """The records of a point's runs; None for a point that the experiment does not have any more."""
    rows = results.rows[results.rows["run"].map(methods.point_of) == ensemble.point]
    if rows.empty:
        return None
    summed = {seed for group in ensemble.seeds for seed in group}
    if not set(rows["seed"].astype(int)) <= summed:
        raise InputError(f"{ensemble.folder}: lacks seeds that iterations.csv has; run the experiment again")
    for run in rows["run"].unique():
        if not results.has_stamps and not results.has_run(run):
            continue
        ensemble.judged = results.run(run).description
        named = ensemble.judged.get("ensemble")
        if results.has_stamps and not (isinstance(named, dict) and named.get("key") == ensemble.description.get("key")):
            raise InputError(f"{ensemble.folder}: holds sums of other settings than run {run}; run the experiment again")
    return rows
