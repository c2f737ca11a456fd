"""A results folder that every command of the analysis can draw, and what each is called with."""

from pathlib import Path

import numpy
from photonlab.figures import deviations, probes, relaxation, scaling
from support import ensembles as made
from support import synthetic
from support.images import grey, write_runs

SEEDS = [1, 2, 3, 4]
PASSES = [0, 1, 4, 8, 16, 32]
POINTS = {"cornell-box_default": ("0.5", "2"), "cornell-box_b": ("0.5", "3"), "cornell-box_c": ("0.9", "2"),
          "cornell-box_d": ("0.9", "3")}    # alpha, footprints
UPDATE = "axis,value,update,radius,count,estimate\npasses,1,program,0,0,0\n"

# What is called after what: a command reads what those before it wrote.
COMMANDS = ["convergence", "strip", "gallery", "decomposition", "fits", "bias_variance", "memory", "best_alpha", "regions", "grid", "equal_time",
            "equal_error", "spectrum", "metrics", "answer", "time_to_error", "tradeoff", "probes", "scaling", "deviations", "relaxation", "report"]


def make(results):
    results = Path(results)
    random = numpy.random.default_rng(5)
    made.write_reference(results, 0.02, random)
    rows = []
    for point, (alpha, footprints) in POINTS.items():
        made.write_ensemble(results, point, SEEDS, lambda n: 0.05, lambda n: 0.1 / max(1, n) ** 0.5, random, passes=PASSES)
        of_point = synthetic.rows(lambda seed, number, component: 1e-3 * float(alpha) * (1 + 0.1 * seed) / max(1, number), seeds=SEEDS,
                                  passes=PASSES, alpha=alpha, footprints=footprints, width="32", height="24")
        for row in of_point:
            row.update(run=f"{point}_seed-{row['seed']}", paths_emitted=str(50000 * int(row["pass"])), relmse=row["mse"],
                       radius_mean=str((int(row["pass"]) + 1) ** -0.15), map_bytes="1e6", hit_point_bytes="1e5",
                       peak_rss_mib="50", cpu_seconds=row["seconds"])
        rows += of_point
        write_runs(results, [f"{point}_seed-{seed}" for seed in SEEDS], [1, 32], lambda _, number: made.channels_of({
            "emission": numpy.zeros_like(made.truth()), "direct": made.truth(),
            "gathered": made.truth() + 0.1 / number * random.standard_normal(made.truth().shape)}), "reference")
    synthetic.write_csv(results, rows)
    synthetic.write_rows(results / "probes.csv", probes.COLUMNS, [
        {"schema": 1, "experiment": "made-up", "run": "cornell-box_b_seed-1", "scene": "cornell-box", "seed": 1, "probe": "corner",
         "x": 3, "y": 4, "pass": number, "radius": 10 / number, "photons": 5 * number, "density": number ** 3, "radiance_r": 0.3,
         "radiance_g": 0.2, "radiance_b": 0.1} for number in PASSES[1:]])
    synthetic.write_rows(results / "scaling.csv", scaling.COLUMNS, [
        {**dict.fromkeys(scaling.COLUMNS, "1"), "axis": axis, "value": value, "integrator": integrator}
        for axis in ["photons", "hit_points", "passes"] for value in [1, 10] for integrator in scaling.PASSES_OF])
    synthetic.write_rows(results / "deviations.csv", deviations.COLUMNS, [
        {"deviation": name, "quantity": "radiance", "pass": number, "value": 1 + 0.1 / number, "value_error": 0.01, "right": 1,
         "right_error": 0.01} for name in deviations.PANELS for number in [1, 2, 4]])
    synthetic.write_rows(results / "relaxation.csv", relaxation.COLUMNS, [
        {"kind": kind, "stage": stage, "x": x, "y": 1 / x} for kind in ["photon", "edge", "counts"] for stage in relaxation.STAGES
        for x in [1, 2, 4]])


def make_extremes(results, rays):
    """The two folders that `analysis extremes` draws."""
    for folder, scene, integrators in [(results, "unit-1", ["ppm", "photonmapper"]), (rays, "index-1.5", ["path"])]:
        rows = []
        for integrator in integrators:
            settings = synthetic.PM_RADIUS if integrator == "photonmapper" else {"integrator": integrator}
            own = synthetic.rows(lambda *_: 1e-3, seeds=[1], passes=[8], scene=scene, **settings)
            rows += [{**row, "run": f"{scene}_{integrator}_seed-1"} for row in own]
        write_runs(folder, {row["run"] for row in rows}, [8], lambda *_: grey(1.0))
        synthetic.write_csv(folder, rows)
    (results / "update.csv").write_text(UPDATE)
