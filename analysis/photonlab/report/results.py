"""What the page says of a scene's methods: errors and costs of their last passes, and what they were made with."""

import math
from html import escape

from photonlab.report.cells import NOTHING, least, number, table, three_digits, whole
from photonlab.statistics import errors

COMPONENT_NAMES = {"total": "whole image", "emission": "emission", "direct": "direct", "gathered": "gathered"}
COUNTERS = ["paths_emitted", "photons_stored", "photons_gathered"]
KEPT = ["map_bytes", "hit_point_bytes"]


def read_runs(results, missing):
    """{name: run} of the runs of the records that have a run.json."""
    names = results.rows["run"].unique()
    without = [name for name in names if not results.has_run(name)]
    if without:
        missing.append(f"No run.json, so neither settings nor images, of {len(without)} of {len(names)} "
                       f"runs: {', '.join(without[:3])}{', …' if len(without) > 3 else '.'}")
    return {name: results.run(name) for name in names if name not in without}


def found(run, *keys):
    """A value inside run.json as text; "" where there is none."""
    value = run.description
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return "" if value is None else str(value)


def found_number(run, key):
    """A whole number inside run.json; 0 where there is none."""
    value = run.description.get(key)
    return value if isinstance(value, int) else 0


def distinct(texts):
    return list(dict.fromkeys(filter(None, texts)))


def rmse_cell(rows):
    value = rows[errors.error_column(rows)].mean(skipna=False)
    if math.isnan(value):
        return number(value)
    root = errors.root(value)
    return (three_digits(root) if value > 0 else "below resolution", root if value > 0 else 0.0)


def process_cell(rows, runs):
    """The largest memory of the process, which is a run's own where it ran alone. `rows` are those of a method's last pass."""
    together = max((found_number(runs[run], "runs_together") for run in rows["run"] if run in runs), default=1)
    if together > 1:
        return (f"with {together - 1} other{'s' * (together > 2)}", math.nan)
    return number(rows["peak_rss_mib"].max())


def last_passes(scene):
    """[(label, {component: rows of the last pass})] of the methods that have a pass which all their seeds recorded."""
    found = []
    for label in scene.labels:
        components = {component: errors.last_pass(rows) for component, rows in
                      scene.of_method(label).groupby("component", sort=False)}
        components = {component: rows for component, rows in components.items() if not rows.empty}
        if components:
            found.append((label, components))
    return found


def error_table(scene):
    """A row a component and method, a column a metric: RMSE, then each that is described as one."""
    metrics = [column for column in scene.columns.metrics if column.name not in errors.SQUARED]
    methods, lines, lights = last_passes(scene), [], []
    for component, name in COMPONENT_NAMES.items():
        for label, components in methods:
            if component in components:
                lights.append(component)
                last = components[component]
                lines.append([label, name, whole(last["pass"].iloc[0]), number(last["seconds"].mean()), rmse_cell(last),
                              *(number(last[metric.name].mean(skipna=False)) for metric in metrics)])
    noise = "without" if errors.error_column(scene.rows) == "mse_unbiased" else "with"
    note = f"RMSE, {noise} the reference's noise; the other errors hold it; bold is the least of its light"
    if scene.rows["mse"].isna().all():
        note = "there is no reference, so there are none"
    columns = ["method", "light", "pass", "seconds", "RMSE", *(metric.label for metric in metrics)]
    return table(f"{scene.scene}: errors of the last pass", note, [], columns, lines, least(lines, lights, range(4, len(columns))))


def cost_table(scene, runs):
    lines = []
    for label, components in last_passes(scene):
        last = components.get("total", next(iter(components.values())))
        lines.append([label, whole(last["pass"].iloc[0]), number(last["seconds"].mean()), whole(last["seed"].nunique()),
                      *(whole(last[counter].mean()) for counter in COUNTERS),
                      *(number(last[column].max() / 2 ** 20) for column in KEPT), process_cell(last, runs)])
    return table(f"{scene.scene}: costs of a seed up to there", "", [("", 4), ("photons", 3), ("largest memory, MiB", 3)],
                 ["method", "pass", "seconds", "seeds", "paths emitted", "stored", "gathered", "photon map", "hit points", "process"],
                 lines)


def facts(rows, runs):
    """Who, when and with what, as a list of terms."""
    starts = sorted(distinct(found(run, "started") for run in runs.values()))
    days = distinct(start[:10] for start in ([starts[0], starts[-1]] if starts else []))

    def joined(separator, *places):
        return distinct(separator.join(filter(None, (found(run, *place) for place in places))) for run in runs.values())

    listed = [("Experiment", distinct(rows["experiment"])), ("Extent", [extent(rows)]), ("Date", [" to ".join(days)]),
              ("Program", joined(" ", ("program", "name"), ("program", "version"), ("program", "commit"))),
              ("Compiler", joined(" ", ("program", "compiler"), ("program", "compiler_flags"))),
              ("Processor", joined("", ("processor",))), ("Threads", distinct(rows["threads"]))]
    return "<dl>" + "".join(f"<dt>{escape(term)}</dt><dd>{'<br>'.join(map(escape, texts))}</dd>"
                            for term, texts in listed if any(texts)) + "</dl>"


def extent(rows):
    """ "1 scene · 5 methods · 4 seeds · 20 runs"."""
    return " · ".join(f"{count} {what}{'' if count == 1 else 's'}" for count, what in
                      [(rows["scene"].nunique(), "scene"), (rows["method"].nunique(), "method"),
                       (rows["seed"].nunique(), "seed"), (rows["run"].nunique(), "run")])


def scene_table(rows, runs):
    lines = []
    for scene, of_scene in rows.groupby("scene", sort=False):
        own = [runs[run] for run in of_scene["run"].unique() if run in runs]
        images = distinct(f"{row['width']} × {row['height']}, {row['samples_per_pixel']} a pixel"
                          for _, row in of_scene.drop_duplicates(["width", "height", "samples_per_pixel"]).iterrows())
        floor = of_scene[of_scene["component"] == "total"]["reference_floor"].max()
        lines.append([scene, "; ".join(distinct(found(run, "scene", "file") for run in own)) or NOTHING,
                      "; ".join(images), "; ".join(distinct(found(run, "reference", "path") for run in own)) or
                      NOTHING, number(errors.root(floor))])
    return table("Scenes", "the noise is the reference's own RMSE", [],
                 ["scene", "file", "image, samples", "reference", "its noise"], lines)
