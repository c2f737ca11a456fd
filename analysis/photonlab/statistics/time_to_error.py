"""How long methods take to a given error.

A seed's curve is followed from pass to pass, with straight lines on logarithmic axes, to where it first comes down to the threshold.
Errors are free of the reference's noise where a scene's records have that (`relmse_unbiased`), which can be 0 and less.
"""

import math

import numpy

NAME = "time-to-error.csv"
CLOCKS = {"seconds": "wall clock", "cpu_seconds": "processor"}
COLUMNS = ["scene", "component", "method", "threshold", "clock", "error", "seeds", "seeds_there", "time", "time_error", "budget",
           "floor_bound", "note"]
MORE = "more than the budget"
UNBIASED, WITH_NOISE = "relmse_unbiased", "relmse"
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
    x, y = numpy.log(times[last - 1:last + 1]), errors[last - 1:last + 1]
    if y[1] <= 0:    # has no logarithm
        share = (y[0] - threshold) / (y[0] - y[1])
    else:
        share = math.log(threshold / y[0]) / math.log(y[1] / y[0])
    return math.exp(x[0] + (x[1] - x[0]) * share), False


def error_of(rows):
    """The column by which methods of a scene are judged: free of the reference's noise, where its rows have that."""
    return UNBIASED if UNBIASED in rows and rows[UNBIASED].notna().any() else WITH_NOISE


def row_of(rows, error, threshold, clock):
    """What a method's seeds took: the columns from `seeds` on. `rows` are those of one scene, component and method, by pass."""
    found, budgets = [], []
    for _, seed in rows.groupby("seed"):
        times, errors = seed[clock].to_numpy(), seed[error].to_numpy()
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
    if error == WITH_NOISE and bound >= threshold / 10:
        notes.append("the reference's noise may be a tenth of the threshold or more")
    return {**row, "note": "; ".join(notes)}


def table_of(results, thresholds):
    """Rows of the table. Components that no method has an error in (emission) are left out."""
    recorded = results.rows
    recorded = recorded[(recorded["pass"] > 0) & (recorded["seconds"] > 0)]
    table = []
    for (scene, component), rows in recorded.groupby(["scene", "component"], sort=False):
        error = error_of(rows)
        rows = rows[rows[error].notna()]
        if (rows[error] == 0).all():    # of none as well
            continue
        for label in results.labels:
            own = rows[rows["method"] == label].sort_values("pass")
            for threshold in thresholds if not own.empty else []:
                for clock in CLOCKS:
                    table.append({"scene": scene, "component": component, "method": label, "threshold": threshold,
                                  "clock": clock, "error": error, **row_of(own, error, threshold, clock)})
    return table
