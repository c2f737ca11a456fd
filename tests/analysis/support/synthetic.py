"""A results folder made up from formulas, for testing what reads one: the errors of every row are known exactly."""

import csv
import json
from pathlib import Path

from photonlab.records import columns
from photonlab.records.records import COMPONENTS

COLUMNS = [column.name for column in columns.before_descriptions()]
BASE = {"schema": "1", "experiment": "made-up", "scene": "cornell-box", "integrator": "ppm", "mode": "",
        "schedule": "hachisuka", "alpha": "0.7", "k": "", "radius_rule": "auto", "footprints": "3",
        "radius_initial": "12.345678901", "max_radius": "", "caustic_k": "", "caustic_radius": "",
        "caustic_max_radius": "", "kernel": "disc", "eps": "0", "direct": "sampled", "direct_samples": "1",
        "max_depth": "-1", "branch_cutoff": "0.0001",
        "photons_per_pass": "50000", "width": "64", "height": "48", "samples_per_pixel": "1", "hit_points": "3072",
        "threads": "2", "nonfinite": "0"}
PM_RADIUS = {"integrator": "photonmapper", "mode": "radius", "schedule": "", "alpha": ""}
PM_NEAREST = {**PM_RADIUS, "mode": "nearest", "k": "50", "radius_rule": "", "radius_initial": "", "max_radius": "30"}


def rows(mse, seeds=(1, 2, 3, 4), passes=(0, 1, 2, 4, 8, 16, 32, 64), floor=1e-6, **settings):
    """Rows of one method. `mse(seed, pass, component)` is the unbiased MSE; the biased one is higher by `floor`."""
    made = []
    for seed in seeds:
        run = "-".join([settings.get("integrator", "ppm"), *map(str, settings.values()), f"seed-{seed}"])
        for number in passes:
            for component in COMPONENTS:
                unbiased = mse(seed, number, component)
                biased = max(unbiased, 0) + floor
                made.append({**BASE, **settings, "run": run.replace(" ", ""), "seed": str(seed), "pass": str(number),
                             "component": component, "seconds": str(0.01 + 0.25 * number), "mse": str(biased),
                             "mse_unbiased": str(unbiased), "rmse": str(biased ** 0.5),
                             "reference_floor": str(floor)})
    return made


def write_csv(results, made, columns=None):
    Path(results).mkdir(parents=True, exist_ok=True)
    write_rows(Path(results) / "iterations.csv", columns or COLUMNS, made)


def write_rows(file, columns, rows):
    """A table; what rows do not have is empty, and what else they have is left out."""
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns, restval="", lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def write_run(results, run, snapshots, reference, working_directory="/nowhere"):
    folder = Path(results) / "runs" / run
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "run.json").write_text(json.dumps({
        "run": run, "scene": {"name": "cornell-box"}, "seed": 1, "working_directory": working_directory,
        "reference": reference and {"path": reference},
        "snapshots": [{"pass": number, "file": f"snapshots/pass-{number:06}.exr"} for number in snapshots]}))
    return folder
