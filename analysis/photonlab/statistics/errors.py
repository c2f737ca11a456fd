"""A method's error over its seeds.

Passes of one run are cumulative, so a method's spread is taken over its seeds, never over the passes of a run. Squared errors are
averaged and rooted last: the root of a mean is what theory predicts, and an unbiased MSE may be negative, where no root exists but a
mean does.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import pandas

from photonlab.records.files import InputError

PLACES = ["seconds", "cpu_seconds", "paths_emitted", "map_bytes", "hit_point_bytes"]    # of a point of a curve, as means over seeds
SQUARED = ["mse_unbiased", "mse", "rmse"]    # one quantity, which is shown as RMSE, without the reference's noise where it can be


def error_column(rows):
    """`mse_unbiased` where the reference has two halves, so that its own noise drops out; `mse` where it has not."""
    judged = rows["mse"].notna()
    return "mse_unbiased" if judged.any() and rows["mse_unbiased"][judged].notna().all() else "mse"


def error_name(column):
    """What the root of this column is called, where noise_note() stands beside it."""
    return "RMSE" if column == "mse_unbiased" else "RMSE with noise"


def noise_note(rows):
    """What an RMSE of these rows holds, as a sentence; "" where there is none."""
    judged = rows[rows["mse"].notna()]
    columns = {error_column(own) for _, own in judged.groupby(["scene", "component"])}
    return {frozenset(): "", frozenset(["mse_unbiased"]): "RMSE is without the reference's noise.",
            frozenset(["mse"]): "RMSE holds the reference's noise, since it has no second half.",
            }.get(frozenset(columns), "RMSE is without the reference's noise, or named with it: that reference has no second half.")


def aggregate_over_seeds(rows, column):
    """A method's curve: by pass, how many seeds recorded it, the means of PLACES, and the mean, least and largest
    of their `column`. `rows` are those of one scene, component and method. A pass that only some of the seeds
    recorded is left out: a mean over other seeds would be a step in the curve."""
    passes = rows.groupby("pass")
    curve = pandas.DataFrame({
        "seeds": passes.size(),
        **{name: passes[name].mean() for name in PLACES},
        # A NaN (no finite pixel was left) stays one: the mean of the other seeds would hide it.
        "mean": passes[column].agg(lambda values: values.mean(skipna=False)),
        "least": passes[column].agg(lambda values: values.min(skipna=False)),
        "largest": passes[column].agg(lambda values: values.max(skipna=False)),
    })
    return curve[curve["seeds"] == rows["seed"].nunique()]


def last_pass(rows):
    """The rows of the last pass that all of a method's seeds recorded; none where they have no pass in common. `rows`
    are those of one scene, method and component."""
    curve = aggregate_over_seeds(rows, "mse")
    return rows[rows["pass"] == curve.index.max()]


def root(mean_squared_error):
    """RMSE of an MSE; NaN for 0 and below, which is less than what the reference can resolve."""
    return math.sqrt(mean_squared_error) if mean_squared_error > 0 else math.nan


def two_digits(value):
    """0.0020, 0.13, 12, 113: what a comparison by eye needs of an error or a time."""
    return f"{value:.0f}" if value >= 100 else f"{value:#.2g}".rstrip(".")


@dataclass(frozen=True)
class Error:
    """An error as it is drawn and tabled: a column, and what its mean over seeds goes through."""
    column: str
    name: str                # in a sentence: "MSE"
    axis: str                # with its unit
    shown: Callable = root   # a mean over seeds as it is shown


def unchanged(value):
    return value


def rmse(rows):
    """The root of the mean squared error of these rows, the one that is drawn unless another is asked for."""
    column = error_column(rows)
    return Error(column, "unbiased MSE" if column == "mse_unbiased" else "MSE", "RMSE (radiance)")


def metric(column):
    """An error that is a column of its own."""
    return Error(column.name, column.label, column.label + (f" ({column.unit})" if column.unit else ""), unchanged)


def metric_named(columns, name):
    """The column of the metric that is asked for."""
    known = {column.name: column for column in columns.metrics}
    if name not in known:
        raise InputError(f"--metric {name}: expected one of {', '.join(known)}")
    return known[name]
