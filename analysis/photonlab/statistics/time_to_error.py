"""How long methods take to a given error.

A seed's curve is followed from pass to pass, with straight lines on logarithmic axes, to where it first comes down to the threshold.
"""

import math

import numpy

NAME = "time-to-error.csv"
CLOCKS = {"seconds": "wall clock", "cpu_seconds": "processor"}
COLUMNS = ["scene", "component", "method", "threshold", "clock", "seeds", "seeds_there", "time", "time_error", "budget",
           "floor_bound", "note"]
MORE = "more than the budget"
RELMSE_OFFSET = 0.01    # of relMSE = mean of (x - r)^2 / (r^2 + 0.01)


def time_to(times, errors, threshold):
    """(time at which the curve first comes down to the threshold, whether it was there at its first point); None when it never
    does. Both arrays are in the order of the passes."""
    there = numpy.flatnonzero(errors <= threshold)
    if not len(there):
        return None
    last = there[0]
    if last == 0:
        return times[0], True
    x, y = numpy.log(times[last - 1:last + 1]), numpy.log(numpy.maximum(errors[last - 1:last + 1], 1e-300))
    return math.exp(x[0] + (x[1] - x[0]) * (math.log(threshold) - y[0]) / (y[1] - y[0])), False


def row_of(rows, threshold, clock):
    """What a method's seeds took: the columns from `seeds` on. `rows` are those of one scene, component and method, by pass."""
    found, budgets = [], []
    for _, seed in rows.groupby("seed"):
        times, errors = seed[clock].to_numpy(), seed["relmse"].to_numpy()
        found.append(time_to(times, errors, threshold))
        budgets.append(times[-1])
    there = [one for one in found if one is not None]
    bound = rows["reference_floor"].max() / RELMSE_OFFSET
    notes = []
    row = {"seeds": len(found), "seeds_there": len(there), "budget": float(numpy.mean(budgets)),
           "floor_bound": "" if math.isnan(bound) else float(bound)}
    if len(there) < len(found):
        notes.append(MORE + (f" for {len(found) - len(there)} of {len(found)} seeds" if there else ""))
    else:
        times = numpy.array([time for time, _ in there])
        row["time"] = float(times.mean())
        row["time_error"] = float(times.std(ddof=1) / math.sqrt(len(times))) if len(times) > 1 else ""
        early = sum(at_first for _, at_first in there)
        if early:
            notes.append(f"at most, for {early} of {len(there)} seeds: there at the first recorded pass")
    if bound >= threshold / 10:
        notes.append("the reference's noise may be a tenth of the threshold or more")
    return {**row, "note": "; ".join(notes)}


def table_of(results, thresholds):
    """Rows of the table. Components that no method has an error in (emission) are left out."""
    recorded = results.rows
    judged = recorded[(recorded["pass"] > 0) & recorded["relmse"].notna() & (recorded["seconds"] > 0)]
    table = []
    for (scene, component), rows in judged.groupby(["scene", "component"], sort=False):
        if (rows["relmse"] == 0).all():
            continue
        for label in results.labels:
            own = rows[rows["method"] == label].sort_values("pass")
            for threshold in thresholds if not own.empty else []:
                for clock in CLOCKS:
                    table.append({"scene": scene, "component": component, "method": label, "threshold": threshold,
                                  "clock": clock, **row_of(own, threshold, clock)})
    return table
