"""Which alpha has the least MSE, with the probability of each, by drawing groups of seeds anew with replacement, the same groups for
all alphas, and counting who wins.

With a seed a group MSE is a plain mean over the groups, whatever share of it is squared bias, and drawing anew is right for means.
With several, the scatter inside the groups is lost and what is drawn comes out too low; so it is centred on the estimate, and spread
by the root of G / (G - 1), which drawing from G groups falls short of. The reference's noise is not drawn: it is common to all
alphas, and most of it drops out between them.
"""

import math
from dataclasses import dataclass

import numpy
import pandas

from photonlab.records import methods, tables
from photonlab.statistics.decomposition import text
from photonlab.statistics.jackknife import jackknife_error
from photonlab.statistics.moments import decompose, replicates
from photonlab.statistics.slopes import RESOLVED

NAME = "best-alphas.csv"
DRAWS = 2000       # of groups of seeds
EXCLUDED = 0.05    # an alpha that is best with less than that is no candidate


@dataclass
class Point:
    """An alpha of a sweep."""
    rows: pandas.DataFrame    # its records
    seeds: list               # by group
    moments: dict             # {(pass, region): Moments}


def family_of(columns):
    """The settings that alphas which are compared have in common."""
    return [name for name in columns.settings if name != "alpha"]


def columns_of(columns):
    """Of the table; `columns` are those of the records."""
    return ["experiment", "scene", *(name for name in columns.table_settings if name != "alpha"), "component", "region", "pass",
            "paths_emitted", "best_alpha", "probability", "candidates", "mse", "runner_up", "difference", "difference_error", "verdict"]


def drawn_mse(moments, draws):
    """MSE from groups of seeds drawn anew: `draws` says in each row how often each group was drawn."""
    counts, gram, groups = moments.counts, moments.gram, len(moments.counts)
    seeds = draws @ counts
    weights = draws * counts / seeds[:, None]
    of_mean = numpy.einsum("dg,gh,dh->d", weights, gram, weights)
    variance = ((draws * counts) @ numpy.diag(gram) - seeds * of_mean) / (groups - 1)
    found = of_mean - moments.floor + variance * (1 - 1 / seeds)
    return decompose(moments)[2] + (found - found.mean()) * math.sqrt(groups / (groups - 1))


def probabilities_of_best(family):
    """{alpha: probability that its MSE is the least} of {alpha: Moments} over the same groups; {} with fewer than three."""
    groups = len(next(iter(family.values())).counts)
    if groups < 3:
        return {}
    draws = numpy.random.default_rng(1).multinomial(groups, numpy.full(groups, 1 / groups), size=DRAWS).astype(float)
    drawn = numpy.array([drawn_mse(moments, draws) for moments in family.values()])
    # What is equal to the last digits, as all alphas are after the first pass, shares a draw.
    wins = drawn <= drawn.min(axis=0) + 1e-12 * numpy.abs(drawn).max(axis=0)
    return dict(zip(family, (wins / wins.sum(axis=0)).mean(axis=1).tolist()))


def best_alphas(family, component, columns):
    """Rows of the table for points of one scene that differ in alpha alone, {alpha: Point}; they share their seeds, so that
    differences are taken group by group."""
    first = next(iter(family.values()))
    table = []
    for number, region in first.moments:
        at = {alpha: point.moments[number, region] for alpha, point in family.items() if (number, region) in point.moments}
        if number == 0 or len(at) < 2 or not all(numpy.isfinite(decompose(moments)[2]) for moments in at.values()):
            continue
        of_pass = first.rows[(first.rows["pass"] == number) & (first.rows["component"] == component)]
        table.append({"experiment": of_pass["experiment"].iloc[0], "scene": of_pass["scene"].iloc[0],
                      **methods.table_settings(first.rows, columns), "component": component, "region": region, "pass": number,
                      "paths_emitted": text(of_pass["paths_emitted"].mean()), **winner_of(at)})
    return table


def winner_of(family):
    """The columns of the table from `best_alpha` on, of {alpha: Moments} at one pass and region."""
    mse = {alpha: decompose(moments)[2] for alpha, moments in family.items()}
    best, second = sorted(mse, key=mse.get)[:2]
    without = {alpha: replicates(family[alpha])[:, 2] for alpha in [best, second]}
    lead = mse[second] - mse[best]
    error = float(jackknife_error(lead, without[second] - without[best], family[best].counts))
    probabilities = probabilities_of_best(family)
    candidates = sorted((alpha for alpha, probability in probabilities.items() if probability >= EXCLUDED), key=float)
    return {"best_alpha": best, "probability": text(probabilities.get(best)), "candidates": ";".join(candidates),
            "mse": text(mse[best]), "runner_up": second, "difference": text(lead), "difference_error": text(error),
            "verdict": "" if lead > RESOLVED * error else "cannot tell"}


def read_best(results):
    """Rows of RESULTS/best-alphas.csv: best alpha and paths as numbers, candidates as lists of them."""
    file = results.folder / NAME
    rows = tables.read_derived(results, NAME, columns_of(results.columns), "`photonlab analyse fits` on an experiment that sweeps alpha")
    for column in ["paths_emitted", "best_alpha"]:
        rows[column] = tables.to_numbers(file, rows[column])
    rows["candidates"] = [[float(alpha) for alpha in listed.split(";") if alpha] for listed in rows["candidates"]]
    return rows
