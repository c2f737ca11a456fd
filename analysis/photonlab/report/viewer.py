"""Images for the viewer of the page.

The viewer is given radiance, not pictures: its exposure acts before sRGB's transfer function. A pixel is three half
floats, scaled by a power of two such that white at the scene's usual exposure is near 1. They tell 2000 levels a stop
from 14 stops below white on, where a screen tells 90 at most, so that nothing bands. An image is all low bytes and then
all high bytes of its halves (these two compress apart better), by channel, deflated, in base64. What is given are the layers
emission, direct and gathered, each once however many images share it; the viewer adds them up to the picture. The picture itself
is given where a file has no layers, or where they are not its sum.
"""

import base64
import math
import zlib
from dataclasses import dataclass

import numpy

from photonlab.drawing import pictures
from photonlab.records import images, references

LARGEST_HALF = 65504.0


def encoded(image, scale):
    """Radiance as the viewer reads it; how is told at the top of this file."""
    scaled = image * scale
    halves = numpy.where(numpy.isinf(scaled), scaled, numpy.clip(scaled, -LARGEST_HALF, LARGEST_HALF))
    planes = halves.astype("<f2").transpose(2, 0, 1).copy().view(numpy.uint8).reshape(-1, 2)
    return base64.b64encode(zlib.compress(planes.T.tobytes(), 9)).decode()


@dataclass
class Shot:
    """An image of the viewer."""
    name: str
    group: str        # of names in the drop-down: a method, or the reference
    seed: int         # None of a reference
    layers: dict      # {layer: radiance} with the picture
    captions: dict    # by component
    file: object      # that it was read from


def snapshots(scene, name, runs, missing, seeds):
    """Shots of each method's lowest seeds that have snapshots."""
    shown, without = [], []
    for label in scene.labels:
        of_method = scene.of_method(label)
        own = []    # [(seed, its rows, files by pass)]
        for seed, of_run in sorted(of_method.groupby("seed"), key=lambda pair: pair[0]):
            run = of_run["run"].iloc[0]
            if run in runs and runs[run].snapshots:
                own.append((int(seed), of_run, runs[run].snapshots))
        if not own and any(run in runs for run in of_method["run"]):
            without.append(label)
        for number in dict.fromkeys(number for *_, by_pass in own[:seeds] for number in by_pass):
            for seed, of_run, by_pass in own[:seeds]:
                if number in by_pass:
                    shown.append(snapshot(label, number, seed, of_run[of_run["pass"] == number], by_pass[number]))
    if shown and without:    # an experiment that keeps no images misses none
        missing.append(f"{name}: no snapshots of {', '.join(without)}.")
    return shown


def snapshot(label, number, seed, rows, file):
    captions = {component: pictures.caption(own) for component, own in rows.groupby("component") if component != "emission"}
    return Shot(f"{label}, pass {number}", label, seed, images.read_layers([file]), captions, file)


def reference_shots(scene, name, runs, missing):
    """Shots of the references that the runs were judged by."""
    judges = {}
    for run in scene.rows["run"].unique():
        judge = references.reference_of(scene, runs[run].description) if run in runs else None
        if judge:
            judges.setdefault(judge.path, judge)
    missing += [f"{name}: the reference {path} {judge.why_not}." for path, judge in judges.items() if not judge.halves]
    found = [judge for judge in judges.values() if judge.halves]
    return [Shot("reference" if len(found) == 1 else f"reference {judge.path}", "reference", None, images.read_layers(judge.halves), {},
                 judge.halves[0]) for judge in found]


def given_layers(layers):
    """What the viewer needs of an image: its three layers where they add up to the picture, all where they do not."""
    picture = layers["picture"]
    parts = [layer for name, layer in layers.items() if name != "picture"]
    if parts and numpy.allclose(sum(parts), picture, rtol=1e-4, atol=1e-6 * numpy.nanmax(numpy.abs(picture), initial=0)):
        return {name: layer for name, layer in layers.items() if name != "picture"}
    return layers


def viewer_scene(scene, name, runs, missing, seeds):
    """A scene for the viewer, its images all of one size; None without images."""
    shots = snapshots(scene, name, runs, missing, seeds) + reference_shots(scene, name, runs, missing)
    if not shots:
        return None
    first, last = shots[0], shots[-1]
    for shot in shots:
        images.require_same_size(shot.file, shot.layers["picture"], first.file, first.layers["picture"])
    exposure = pictures.exposure_for(pictures.lit_by_scene(last.layers["picture"], first.file))
    scale = 2.0 ** round(math.log2(exposure))
    places, listed = {}, {}    # of encoded pixels; of images by name
    for shot in shots:
        image = listed.setdefault(shot.name, {"name": shot.name, "group": shot.group, "seeds": []})
        image["seeds"].append({"seed": shot.seed, "captions": shot.captions, "layers": {
            layer: places.setdefault(encoded(radiance, scale), len(places))
            for layer, radiance in given_layers(shot.layers).items()}})
    height, width = first.layers["picture"].shape[:2]
    return {"name": name, "width": width, "height": height, "scale": scale, "exposure": exposure, "pixels": list(places),
            "images": list(listed.values())}


def seeds_left_out(rows, runs, seeds):
    """What the viewer does not have though the folder does."""
    with_images = rows[rows["run"].map(lambda run: run in runs and bool(runs[run].snapshots))]
    most = int(with_images.groupby(["scene", "method"])["seed"].nunique().max())
    return f"Of up to {most} seeds of a method, those of the lowest {seeds} are here; --seeds gives more." if most > seeds else ""


def viewer_scenes(results, runs, missing, seeds):
    """Every scene's images. Only images of one size can be compared, so a scene of several sizes is several here."""
    scenes = []
    for scene in results.scenes():
        sizes = scene.rows.groupby(["width", "height"], sort=False)
        for (width, height), rows in sizes:
            name = scene.scene if sizes.ngroups == 1 else f"{scene.scene}, {width} × {height}"
            scenes.append(viewer_scene(scene.of_rows(rows), name, runs, missing, seeds))
    return [scene for scene in scenes if scene]
