"""Numbers of rows, taken from a folder of results. Each function here returns one that takes `Made`, and gives a Value; a number that
the folder has not (a smaller run has fewer passes) is an InputError that says so.

A method is named by its point without the scene: `ppm_alpha-0.7`. Components and regions are those of the records.
"""

import math
from functools import cache, cached_property

import numpy
from scipy import stats

from photonlab import command_line
from photonlab.command import options_of
from photonlab.figures import probes, relaxation, spectrum
from photonlab.records import ensembles, methods, records, tables
from photonlab.records.files import InputError
from photonlab.replications.claims import Value
from photonlab.statistics import best_alphas, decomposition, equal_time, fits
from photonlab.statistics.jackknife import over_seeds
from photonlab.statistics.moments import error_of_ratio, of_pass

SLOTS = 16    # groups of seeds, of which intervals are


class Made:
    """What was made for a row, read when it is asked for: the records of an experiment, or the table of a program."""

    def __init__(self, folder):
        self.folder = folder

    @cached_property
    def records(self):
        return records.read(self.folder)

    @cached_property
    def rows(self):
        """The records, with `point`: the name of each run without its scene and seed."""
        rows = self.records.rows
        return rows.assign(point=[methods.point_of(run).removeprefix(f"{scene}_") for run, scene in zip(rows["run"], rows["scene"])])

    def derived(self, command, read):
        """A table that a command makes of the records, made where it is not there or of others."""
        try:
            return read(self.records)
        except InputError:
            for _ in command_line.said_by(command, self.records, options_of(command, [str(self.folder)])):
                pass
            return read(self.records)

    @cached_property
    def decomposition(self):
        return self.derived(decomposition.COMMAND, decomposition.read_decomposition)

    @cached_property
    def fits(self):
        rows = self.derived(fits.COMMAND, lambda results: tables.read_derived(results, fits.NAME, ["point", "slope"], "fits"))
        for column in ["slope", "low", "high", "predicted", "predicted_edge", "seeds"]:
            rows[column] = tables.to_numbers(self.folder / fits.NAME, rows[column])
        return rows

    @cached_property
    def best_alphas(self):
        self.fits    # which makes it
        return best_alphas.read_best(self.records)

    def table(self, name):
        return tables.read_table(self.folder / name)

    def missing(self, what):
        return InputError(f"{self.folder}: has no {what}")

    def of(self, scene, method, component, at):
        """The rows of a method after a pass (None: the last that all its seeds have), by seed."""
        rows = self.rows[(self.rows["scene"] == scene) & (self.rows["point"] == method) & (self.rows["component"] == component)]
        seeds = rows.groupby("pass").size()
        if not rows.empty and at is None:
            at = seeds.index[seeds == seeds.max()].max()
        rows = rows[rows["pass"] == at]
        if rows.empty:
            raise self.missing(f"{component} of {scene}_{method}" + ("" if at is None else f" after pass {at}"))
        return rows.set_index("seed").sort_index()

    def decomposed(self, scene, method, component, region, at):
        rows = self.decomposition
        rows = rows[(rows["point"] == f"{scene}_{method}") & (rows["component"] == component) & (rows["region"] == region)]
        rows = rows[rows["pass"] == (rows["pass"].max() if at is None else at)]
        if rows.empty:
            raise self.missing(f"decomposition of {scene}_{method}, {component}, {region}, {at or 'last pass'}")
        return rows.iloc[0]

    @cache
    def moments(self, scene, method, component, at):
        """Of all regions, from the sums over seeds."""
        ensemble = ensembles.read_ensemble(self.records, self.folder / "ensembles" / f"{scene}_{method}")
        ensembles.rows_of(ensemble, self.records)    # says which reference judged its runs
        return of_pass(ensemble, self.records, component, at)


def mean(scene, method, column, component="total", at=None, square_root=False):
    """The mean over seeds of a column; its root where that is asked for."""
    def take(made):
        values = made.of(scene, method, component, at)[column].to_numpy(dtype=float)
        return Value(*over_seeds(lambda sample: math.sqrt(sample.mean()) if square_root else sample.mean(), values))
    return take


def paired_ratio(scene, method, other, column="mse_unbiased", component="total", at=None, other_at=None, power=1.0):
    """The ratio of the means of two methods over the seeds that both have, to a power; `other_at` is the other's pass."""
    def take(made):
        first, second = made.of(scene, method, component, at), made.of(scene, other, component, other_at or at)
        seeds = first.index.intersection(second.index)
        found = over_seeds(lambda own, others: (own.mean() / others.mean()) ** power,
                           *(rows.loc[seeds, column].to_numpy(dtype=float) for rows in [first, second]))
        return Value(*found)
    return take


def decomposed(scene, method, quantity="mse", component="gathered", region="image", at=None):
    """Variance, squared bias or MSE from the sums over seeds."""
    def take(made):
        row = made.decomposed(scene, method, component, region, at)
        return Value(float(row[quantity]), float(row[f"{quantity}_error"]))
    return take


def relative(scene, method, other, quantity="mse", component="gathered", region="image", at=None):
    """The ratio of two of these. Its error leaves out what both share, where they have the same seeds."""
    def take(made):
        first, second = (made.decomposed(scene, name, component, region, at) for name in [method, other])
        error = error_of_ratio(*(made.moments(scene, name, component, int(first["pass"])) for name in [method, other]), region, quantity)
        return Value(float(first[quantity] / second[quantity]),
                     float(decomposition.error_of_independent_ratio(first, second, quantity) if error is None else error))
    return take


def fit(made, scene, method, quantity, component, region):
    rows = made.fits
    rows = rows[(rows["point"] == f"{scene}_{method}") & (rows["quantity"] == quantity) & (rows["component"] == component) &
                (rows["region"] == region)]
    if rows.empty:
        raise made.missing(f"slope of {quantity} of {scene}_{method}, {component}, {region}")
    return rows.iloc[0]


def slope(scene, method, quantity, component="gathered", region="image"):
    """How fast a quantity falls with the passes."""
    def take(made):
        row = fit(made, scene, method, quantity, component, region)
        wide = stats.t.ppf(0.975, max(1, min(SLOTS, row["seeds"]) - 1))
        return Value(float(row["slope"]), float((row["high"] - row["low"]) / 2 / wide))
    return take


def predicted(scene, method, quantity, component="gathered", region="image", column="predicted"):
    """The slope of the exact sums for the same passes, where light is smooth; `predicted_edge`, at a straight edge."""
    return lambda made: Value(float(fit(made, scene, method, quantity, component, region)[column]))


def farthest_from_prediction(scene, chosen, quantity, component="gathered"):
    """The largest difference of a slope from its prediction over these methods, with the error of that slope."""
    def take(made):
        found = []
        for method in chosen:
            own = slope(scene, method, quantity, component)(made)
            found.append(Value(abs(own.value - predicted(scene, method, quantity, component)(made).value), own.error))
        return max(found, key=lambda value: value.value)
    return take


def best_alpha(scene, component="gathered", region="image", at=128):
    """The alpha of least MSE."""
    def take(made):
        rows = made.best_alphas
        rows = rows[(rows["scene"] == scene) & (rows["component"] == component) & (rows["region"] == region) &
                    (rows["pass"].astype(int) == at)]
        if rows.empty:
            raise made.missing(f"best alpha of {scene}, {component}, {region}, pass {at}")
        return Value(float(rows.iloc[0]["best_alpha"]))
    return take


def at_seconds(scene, method, seconds, component="total"):
    """RMSE after so many seconds."""
    def take(made):
        rows = made.rows[(made.rows["scene"] == scene) & (made.rows["point"] == method)]
        curve = equal_time.curve_of(rows, component)
        found = equal_time.at_budget(curve, seconds) if len(curve) else "no errors"
        if isinstance(found, str):
            raise made.missing(f"error of {scene}_{method} after {seconds} s: {found}")
        return Value(math.sqrt(found[1]))
    return take


def at_same_cost(scene, method, other, cost, component="gathered"):
    """MSE of a method over the other's after as much of a cost (paths traced, seconds of the processor): as much as both have
    recorded, between passes interpolated on logarithmic axes along the means over seeds."""
    def curve(rows, seeds):
        rows = rows[rows["seed"].isin(seeds)].groupby("pass")[[cost, "mse_unbiased"]].mean()
        return numpy.log(rows[rows.index > 0].to_numpy(dtype=float).T)

    def take(made):
        own, others = (made.rows[(made.rows["scene"] == scene) & (made.rows["point"] == name) & (made.rows["component"] == component)]
                       for name in [method, other])
        seeds = numpy.intersect1d(own["seed"], others["seed"])
        if not len(seeds):
            raise made.missing(f"{scene}_{method} beside {scene}_{other}")

        def ratio(chosen):
            first, second = curve(own, chosen), curve(others, chosen)
            budget = min(first[0, -1], second[0, -1])
            return math.exp(numpy.interp(budget, *first) - numpy.interp(budget, *second))
        return Value(*over_seeds(ratio, seeds))
    return take


def probed(scene, method, probe, quantity, last=True):
    """What a probe recorded in its first pass or its last, of the first seed."""
    def take(made):
        rows = probes.read_probes(made.records)
        rows = rows[rows["run"].str.startswith(f"{scene}_{method}_seed-") & (rows["probe"] == probe) & (rows["pass"] > 0)]
        if rows.empty:
            raise made.missing(f"probe {probe} of {scene}_{method}")
        rows = rows[rows["seed"] == rows["seed"].min()].sort_values("pass")
        return Value(float(rows.iloc[-1 if last else 0][quantity]))
    return take


def power_of_blotches(scene, label, rmse, longest=4):
    """Power of the error from one cycle an image to `longest`, of a method's pictures whose RMSE is nearest to this one."""
    def take(made):
        own = made.records.scene_named(scene)
        passes = spectrum.passes_at(own, "total", rmse)
        if label not in passes:
            raise made.missing(f"picture of {label} in {scene}")
        found = spectrum.spectra_of(own, "total", {label: passes[label]})[label]
        power, error, _ = found
        return Value(float(power[1:longest + 1].sum()), float(numpy.sqrt((error[1:longest + 1] ** 2).sum())))
    return take


def cell(file, column, error=None, **where):
    """A cell of a table that a program wrote, in the row that has these texts; `error` is the column of its standard error."""
    def take(made):
        rows = made.table(file)
        for name, text in where.items():
            rows = rows[rows[name] == text]
        if rows.empty:
            raise made.missing(f"row of {file} with {where}")
        return Value(float(rows.iloc[0][column]), float(rows.iloc[0][error]) if error else math.nan)
    return take


def beyond_the_edge(stage):
    """Photons just beyond an edge of a photon map that was relaxed, over those that were there before."""
    def take(made):
        table = relaxation.read(made.folder / "relaxation.csv")
        beyond = [dict(zip(*relaxation.points(table, "edge", name))) for name in [stage, "before"]]
        nearest = min(place for place in beyond[0] if place > 0)
        return Value(beyond[0][nearest] / beyond[1][nearest])
    return take
