"""Errors of methods at the same seconds.

Nothing is stopped by the clock: a method's error at a budget is interpolated between its recorded passes, on logarithmic axes, where
curves are nearly straight. Nothing is extrapolated. Budgets are powers of two of a second that at least one method reaches.
"""

import math

import numpy

from photonlab.records import ensembles, files, methods
from photonlab.statistics import decomposition
from photonlab.statistics.errors import aggregate_over_seeds, error_column, root

NAME = "equal-time.csv"
COLUMNS = ["scene", "component", "region", "seconds", "method", "pass", "mse", "rmse", "note"]
BUDGETS = 10   # at most


def curve_of(rows, component):
    """A method's mean MSE by recorded pass, with its mean seconds, from the first pass on."""
    of_component = rows[rows["component"] == component]
    curve = aggregate_over_seeds(of_component, error_column(of_component))
    return curve[(curve.index > 0) & (curve["seconds"] > 0) & curve["mean"].notna()]


def region_curve(rows, component, region):
    """The same of a named region, from a method's rows of decomposition.csv."""
    own = rows[(rows["component"] == component) & (rows["region"] == region) & rows["mse"].notna()]
    curve = own.set_index("pass")[["seconds", "mse"]].rename(columns={"mse": "mean"}).sort_index()
    return curve[(curve.index > 0) & (curve["seconds"] > 0)]


def at_budget(curve, seconds):
    """(pass, MSE) after `seconds`, both interpolated, or why there is none."""
    if seconds < curve["seconds"].iloc[0]:
        return "less than one pass"
    if seconds > curve["seconds"].iloc[-1]:
        return "more than recorded"
    place = numpy.log(curve["seconds"])
    number = math.exp(numpy.interp(math.log(seconds), place, numpy.log(curve.index.astype(float))))
    around = curve["mean"].to_numpy()
    right = min(int(numpy.searchsorted(curve["seconds"], seconds)), len(around) - 1)
    if min(around[max(0, right - 1)], around[right]) <= 0:
        return "not resolved"
    with numpy.errstate(invalid="ignore", divide="ignore"):
        return number, math.exp(numpy.interp(math.log(seconds), place, numpy.log(around)))


def budgets_of(curves):
    """(powers of two of a second that some method reaches, the last that all reach or None)."""
    first = min(curve["seconds"].iloc[0] for curve in curves.values())
    last = max(curve["seconds"].iloc[-1] for curve in curves.values())
    powers = range(math.ceil(math.log2(first)), math.floor(math.log2(last)) + 1)
    budgets = [2.0 ** power for power in powers][-BUDGETS:]
    common = [seconds for seconds in budgets
              if all(curve["seconds"].iloc[0] <= seconds <= curve["seconds"].iloc[-1] for curve in curves.values())]
    return budgets, common[-1] if common else None


def curves_of(scene, split):
    """{(component, region): {label: curve}}. `split` are the scene's rows of decomposition.csv, with methods, or None."""
    found, labels = {}, scene.labels
    for component in ["total", "gathered"]:
        found[component, "image"] = {label: curve_of(scene.of_method(label), component) for label in labels}
        for region in [] if split is None else dict.fromkeys(split["region"]):
            if region != "image":
                found[component, region] = {label: region_curve(split[split["method"] == label], component, region)
                                            for label in labels}
    return {place: {label: curve for label, curve in curves.items() if not curve.empty} for place, curves in found.items()}


def table_of(scene, curves):
    """(rows of the table, the budget of the pictures or None)."""
    if not curves["total", "image"]:
        return [], None
    budgets, common = budgets_of(curves["total", "image"])
    table = []
    for (component, region), of_place in curves.items():
        for seconds in budgets:
            for label, curve in of_place.items():
                row = {"scene": scene, "component": component, "region": region, "seconds": seconds, "method": label}
                found = at_budget(curve, seconds)
                if isinstance(found, str):
                    table.append({**row, "note": found})
                else:
                    table.append({**row, "pass": found[0], "mse": found[1], "rmse": root(found[1])})
    return table, common


def read_split(results):
    """Rows of decomposition.csv with the method that each point is; None where the file is not there."""
    if not files.is_there(results.folder / decomposition.NAME):
        return None
    rows = decomposition.read_decomposition(results)
    method_of = dict(zip(results.rows["run"].map(methods.point_of), results.rows["method"]))
    return rows.assign(method=rows["point"].map(method_of))


def regions_of(results, scene):
    """{name: (left, top, right, bottom)} of a scene's regions, from its ensembles; {} where there are none."""
    for folder in sorted((results.folder / "ensembles").glob("*/")):
        description = ensembles.read_description(results, folder)
        if description["scene"] == scene:
            return description["regions"]
    return {}
