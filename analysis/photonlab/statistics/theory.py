"""How variance and squared bias fall with the passes, by theory, for methods as their settings tell them:

    without photons           a plain Monte Carlo mean (so is direct light by shadow rays): variance as 1 / n, no bias
    alpha                     a radius that shrinks: variance_n / variance_1 = n^-2 sum r_1^2 / r_i^2, bias_n / bias_1 = mean of
                              r_i^2 / r_1^2, with Knaus and Zwicker's radii in closed form, and with others as they were recorded;
                              asymptotes are variance -alpha, squared bias 2 (alpha - 1), MSE -min(alpha, 2 - 2 alpha), where
                              light is smooth
    a radius, no schedule     the same with a radius that stays: variance as 1 / n, the bias stays

[Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013]

At edges bias is of order one in a band as wide as the radius, so its square falls as (alpha - 1) / 2; for these very passes where a
straight edge is all bias there is: a disc of radius r at the distance t r misses the share (acos t - t sqrt(1 - t^2)) / pi of its
photons. Divided by the area that is there, bias in the band is of first order in the radius, by a local linear fit of second: its
square falls as 3 (alpha - 1) / 2 and 5 (alpha - 1) / 2. [docs/theory.md, section 2]

All of it is of independent light paths: where `light_sequence` is not independent nothing is predicted of photons.
"""

import math

import numpy

from photonlab.records.files import InputError
from photonlab.statistics.moments import QUANTITIES

EDGE_STEPS = 2000  # of the integral over the distance to an edge


def knaus_zwicker_radii(alpha, last):
    """r_i^2 / r_1^2 for passes 1 to last. [Knaus and Zwicker 2011, equation 20]"""
    squared = numpy.ones(last)
    for i in range(1, last):
        squared[i] = squared[i - 1] * (i + alpha) / (i + 1)
    return squared


def recorded_radii(rows, last):
    """The same from `radius_mean`, which after pass i is that of pass i + 1; between recorded passes by straight lines on
    logarithmic axes."""
    of_total = rows[rows["component"] == "total"]
    radii = of_total["radius_mean"]
    if radii.isna().any():
        raise InputError(f"run {of_total['run'][radii.isna()].iloc[0]}: expected radius_mean in every row of a method with alpha")
    means = radii.groupby(of_total["pass"]).mean()
    if means.empty or means.index.max() < last:
        raise InputError(f"iterations.csv: expected radii of run {rows['run'].iloc[0]} up to pass {last}, which its sums have")
    number = numpy.arange(1, last + 1)
    return numpy.exp(2 * numpy.interp(numpy.log(number), numpy.log(means.index + 1.0), numpy.log(means))
                     - 2 * math.log(means.iloc[0]))


def missing_share(t):
    """Of a disc beyond a chord at distance t radii."""
    return (numpy.arccos(t) - t * numpy.sqrt(1 - t * t)) / math.pi


def moments_across(t):
    """Of the part of a disc that an edge at distance t radii leaves: area and the first three moments of the offset across it, in
    shares of the disc and units of its radius."""
    rest = 1 - t * t
    return (1 - missing_share(t), -2 / 3 * rest ** 1.5 / math.pi,
            1 / 4 - (math.pi / 2 - numpy.arcsin(t) + t * numpy.sqrt(rest) * (1 - 2 * t * t)) / (4 * math.pi),
            (-2 / 3 * rest ** 1.5 + 2 / 5 * rest ** 2.5) / math.pi)


def centroid(t):
    """How far the part's centroid lies beside the point."""
    area, first, _, _ = moments_across(t)
    return first / area


def square_of_linear_fit(t):
    """What a local linear fit makes of the square of the offset across, less what it makes of it in a whole disc."""
    area, first, second, third = moments_across(t)
    return (second * second - first * third) / (area * second - first * first) - 1 / 4


# By `area`: bias at the distance t r from a straight edge, and the power of r that it is multiplied by.
BIAS_AT_EDGES = {"disc": (missing_share, 0), "seen": (centroid, 1), "linear": (square_of_linear_fit, 2)}


def area_of(first):
    """What a row's method divides by; records from before there was a choice have none."""
    return first.get("area") or "disc"


def squared_bias_at_edges(squared, area="disc"):
    """Squared bias along a straight edge, integrated over the distance to it, after each of the passes whose r_i^2 / r_1^2 are
    given; up to a factor that is common to all. [Each pass has an equal part in the mean]"""
    at, power = BIAS_AT_EDGES[area]
    radii = numpy.sqrt(squared)
    distances = (numpy.arange(EDGE_STEPS) + 0.5) / EDGE_STEPS * radii.max()
    mean, found = numpy.zeros(EDGE_STEPS), numpy.empty(len(radii))
    for place, radius in enumerate(radii):
        mean += (radius ** power * at(numpy.minimum(1, distances / radius)) - mean) / (place + 1)
        found[place] = (mean ** 2).mean()
    return found


def is_sampled(first, component):
    """True for light that is a plain Monte Carlo mean: that of methods without photons, and direct light by shadow rays."""
    return first["photons_per_pass"] == "" or (component == "direct" and first["direct"] == "sampled")


def has_fixed_radius(first):
    return first["alpha"] == "" and first["radius_initial"] != "" and first["schedule"] == ""


def is_of_a_sequence(first):
    """True where photons of different paths depend on each other: the variance of their sum is none that is predicted here."""
    return first.get("light_sequence") == "sobol"


def predictions(rows, component, last):
    """{"variance", "squared_bias", "edge"}: for passes 1 to last, each up to a factor, squared bias where light is smooth and at
    edges; without what has no prediction. Those of component "total" are of its gathered light; with_direct_light() adds
    the rest."""
    first = rows.iloc[0]
    number = numpy.arange(1, last + 1)
    if is_sampled(first, component):
        return {"variance": 1 / number}
    if is_of_a_sequence(first):
        return {}
    if has_fixed_radius(first):
        return {"variance": 1 / number, "squared_bias": numpy.ones(last), "edge": numpy.ones(last)}
    if not first["alpha"] or rows["radius_mean"].isna().all():
        return {}
    knaus_zwicker = first["schedule"] == "knaus-zwicker"
    squared = knaus_zwicker_radii(float(first["alpha"]), last) if knaus_zwicker else recorded_radii(rows, last)
    return {"variance": numpy.cumsum(1 / squared) / number ** 2, "squared_bias": (numpy.cumsum(squared) / number) ** 2,
            "edge": squared_bias_at_edges(squared, area_of(first))}


def with_direct_light(predicted, direct, gathered, number):
    """The prediction of the whole picture: direct light by shadow rays adds its own variance, which falls as 1 / n. `direct` and
    `gathered` are the variances that were measured at pass `number`, and give the shares."""
    direct, gathered = max(0.0, direct), max(0.0, gathered)
    if not predicted or direct + gathered == 0:
        return predicted
    variance = predicted["variance"]
    passes = numpy.arange(1, len(variance) + 1)
    return {**predicted,
            "variance": (direct * number / passes + gathered * variance / variance[number - 1]) / (direct + gathered)}


def asymptotes(first, component):
    """{quantity: (smooth, at edges)} of slopes; None where theory has none."""
    none = {quantity: (None, None) for quantity in QUANTITIES}
    if is_sampled(first, component):
        return {**none, "variance": (-1.0, None), "mse": (-1.0, None)}
    if is_of_a_sequence(first):
        return none
    if has_fixed_radius(first):
        return {"variance": (-1.0, None), "squared_bias": (0.0, 0.0), "mse": (0.0, None)}
    if not first["alpha"]:
        return none
    alpha = float(first["alpha"])
    _, power = BIAS_AT_EDGES[area_of(first)]
    return {"variance": (-alpha, None), "squared_bias": (2 * (alpha - 1), (2 * power + 1) * (alpha - 1) / 2),
            "mse": (-min(alpha, 2 - 2 * alpha), None)}
