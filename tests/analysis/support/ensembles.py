"""Ensembles made up from known bias and noise: every pixel of every seed is truth + bias + normal noise, so variance and
squared bias are known exactly, in the image and in each region."""

import json
from pathlib import Path

import numpy

from support import synthetic
from support.images import write_exr

HEIGHT, WIDTH = 24, 32
REGIONS = {"smooth": [0, 0, 16, 12], "edge": [16, 12, 32, 24]}
PASSES = [0, 1, 2, 4, 8, 16, 32, 64, 128]


def write_layers(file, layers, seeds=()):
    """An image with these layers and their sum; a sum over seeds where there are some."""
    write_exr(file, channels_of(layers), attributes=[("photonlab.seeds", " ".join(map(str, seeds)))] if seeds else [])


def channels_of(layers):
    named = {**{f"{name}.": layer for name, layer in layers.items()}, "": sum(layers.values())}
    return {f"{prefix}{channel}": layer[:, :, place] for prefix, layer in named.items() for place, channel in enumerate("RGB")}


def truth():
    """Smooth, different in each channel."""
    ramp = 1 + numpy.arange(WIDTH) / WIDTH
    return numpy.ones((HEIGHT, 1, 1)) * ramp[None, :, None] * numpy.array([1.0, 0.5, 0.25])


def write_reference(results, noise, random):
    """Two halves whose mean has the variance noise^2 / 2 in the gathered layer."""
    for half in ["half_a", "half_b"]:
        write_layers(Path(results) / "reference" / f"{half}.exr", {
            "emission": numpy.zeros((HEIGHT, WIDTH, 3)), "direct": truth(),
            "gathered": truth() + noise * random.standard_normal((HEIGHT, WIDTH, 3))})


def write_ensemble(results, point, seeds, bias, deviation, random, slots=16, passes=PASSES, common=None,
                   direct_deviation=lambda number: 0.0):
    """`bias(pass)` and `deviation(pass)` are numbers or arrays that go with an image; gathered light has both. `common`,
    {seed: array}, is the noise that points share, as methods over the same photons do."""
    groups = [seeds[slot::slots] for slot in range(slots) if seeds[slot::slots]]
    folder = Path(results) / "ensembles" / point
    for slot, group in enumerate(groups):
        layers = {"emission": numpy.zeros((HEIGHT, WIDTH, 3))}
        for number in passes:
            layers[f"pass-{number:06}-direct"] = sum(
                truth() + direct_deviation(number) * random.standard_normal((HEIGHT, WIDTH, 3)) for _ in group)
            layers[f"pass-{number:06}-gathered"] = sum(
                truth() + bias(number) + deviation(number) *
                (common[seed, number] if common else random.standard_normal((HEIGHT, WIDTH, 3))) for seed in group)
        write_layers(folder / f"slot-{slot:02}.exr", layers, group)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "ensemble.json").write_text(json.dumps({
        "schema": 1, "key": "k", "experiment": "made-up", "point": point, "scene": "cornell-box", "method": "ppm",
        "photons_carry_direct": False, "reference": {"path": "reference"}, "working_directory": str(results),
        "regions": REGIONS, "slots": slots, "passes": passes}))


def write_records(results, points, seeds, passes=PASSES):
    """iterations.csv of points: {point: settings}."""
    made = []
    for point, settings in points.items():
        rows = synthetic.rows(lambda seed, number, component: 1e-4, seeds=seeds, passes=passes, **settings)
        for row in rows:
            row["run"] = f"{point}_seed-{row['seed']}"
            row["paths_emitted"] = str(50000 * int(row["pass"]))
            row["radius_mean"] = str((int(row["pass"]) + 1) ** -0.15)    # of the next pass
        made += rows
    synthetic.write_csv(results, made)
