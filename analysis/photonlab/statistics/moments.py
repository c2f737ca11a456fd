"""Tells bias from variance: what is left of a method's error when its noise is averaged away, and the noise itself.

Input are sums of images over independent seeds (records/ensembles.py) and the reference's halves A and B. With group means y_g of
m_g seeds each, G groups, K seeds and their mean xbar:

    variance (of one seed) = mean over pixels and channels of  sum_g m_g (y_g - xbar)^2 / (G - 1)
    squared bias           = mean( (xbar - A)(xbar - B) ) - variance / K
    MSE                    = squared bias + variance,  exactly the mean over seeds of mean( (x - A)(x - B) )

All three are unbiased, so what is near zero can come out below it; the sign is kept. A reference of one image has no halves:
its own noise is then part of the squared bias.

Only inner products of the deviations y_g - (A + B) / 2 enter, so each region needs one G x G matrix a pass, and leaving out
a group costs nothing. Standard errors are those of the jackknife over groups (for groups of unequal size after Busing, Meijer
and van der Leeden 1999, "Delete-m Jackknife for Unequal m"), and of the reference: its noise adds -d (A + B - 2 r) to the squared
bias of a pixel with the deviation d from its mean, whose spread is that of d (A - B), since the halves' noise is as likely to
have either sign; summed over pixels, which are independent. A reference of one image has a noise that is not known, and not in
them. Where a bias is lost in noise they are too large, by a factor of up to the root of 2.
"""

from dataclasses import dataclass

import numpy

from photonlab.records import ensembles
from photonlab.statistics.jackknife import jackknife_error

QUANTITIES = ["variance", "squared_bias", "mse"]


@dataclass
class Moments:
    """What is needed of a region after a pass: inner products of the groups' deviations from the reference, as means over
    pixels and channels, and the reference's own variance: 0 for a reference of one image, NaN without one, so that what needs
    it becomes NaN. A pixel with a value that is not finite in any of the images is left out, as it is in the records.

    `reference_terms` has a value a pixel of the region, whose spread is that of what the reference's noise there adds to the
    squared bias; 0 where a pixel is left out, or the noise is not known."""
    gram: numpy.ndarray
    counts: numpy.ndarray
    floor: float
    pixels: int
    reference_terms: numpy.ndarray

    def without(self, group):
        kept = numpy.arange(len(self.counts)) != group
        return Moments(self.gram[numpy.ix_(kept, kept)], self.counts[kept], self.floor, self.pixels, self.reference_terms)


def moments_of(ensemble, results, component, passes=None):
    """{(pass, region): Moments} of these passes, or all; empty where the component does not apply."""
    if component == "direct" and ensemble.description["photons_carry_direct"]:
        return {}
    halves = ensembles.read_halves(ensemble, results, component)
    found = {}
    for number in ensemble.description["passes"] if passes is None else passes:
        images = numpy.stack([ensemble.component(group, number, component) for group in range(len(ensemble.seeds))])
        mean = sum(halves) / len(halves) if halves else numpy.zeros(images.shape[1:])
        noise = (numpy.full_like(mean, numpy.nan) if not halves else (halves[0] - halves[1]) ** 2 / 4 if len(halves) == 2
                 else numpy.zeros_like(mean))
        deviations = images - mean
        finite = numpy.isfinite(deviations).all(axis=(0, 3))
        of_mean = numpy.tensordot(ensemble.counts / ensemble.counts.sum(), deviations, axes=1)
        terms = (of_mean * (halves[0] - halves[1])).mean(axis=2) if len(halves) == 2 else numpy.zeros(mean.shape[:2])
        terms = numpy.where(finite, terms, 0)
        for name, place in ensembles.regions_of(ensemble, mean.shape).items():
            kept = finite[place]
            flat = deviations[(slice(None), *place)][:, kept].reshape(len(deviations), -1)
            if flat.shape[1]:
                found[number, name] = Moments(flat @ flat.T / flat.shape[1], ensemble.counts,
                                              float(noise[place][kept].mean()), int(kept.sum()),
                                              terms[place].ravel() / kept.sum())
    return found


def decompose(moments):
    """(variance, squared bias, MSE)."""
    counts, gram = moments.counts, moments.gram
    seeds = counts.sum()
    weights = counts / seeds
    of_mean = weights @ gram @ weights
    variance = (counts @ numpy.diag(gram) - seeds * of_mean) / (len(counts) - 1)
    squared_bias = of_mean - moments.floor - variance / seeds
    return numpy.array([variance, squared_bias, squared_bias + variance])


def replicates(moments, estimate=decompose):
    """The estimate without each group in turn, a row a group. NaN with fewer than three groups."""
    if len(moments.counts) < 3:
        return numpy.full((len(moments.counts), len(QUANTITIES)), numpy.nan)
    return numpy.array([estimate(moments.without(group)) for group in range(len(moments.counts))])


def standard_errors(moments):
    """Of decompose(): over the seeds by the jackknife, and of the reference."""
    seeds = jackknife_error(decompose(moments), replicates(moments), moments.counts)
    reference = numpy.linalg.norm(moments.reference_terms)
    return numpy.hypot(seeds, [0, reference, reference])


def of_pass(ensemble, results, component, number):
    """(reference, groups of seeds, {region: moments}) of one point after a pass."""
    found = moments_of(ensemble, results, component, [number])
    return ensemble.judged.get("reference"), ensemble.seeds, {region: moments for (_, region), moments in found.items()}


def error_of_ratio(first, second, region, quantity="mse"):
    """Standard error of the ratio of two points' variances, squared biases or MSEs, of what of_pass() gives of each: by the jackknife,
    which leaves the same seeds out of both, and of the reference, whose noise adds to both, where it has two halves. NaN with fewer
    than three groups; None where seeds, reference or pixels are not the same."""
    above, below = first[2].get(region), second[2].get(region)
    if above is None or below is None or first[:2] != second[:2] or above.pixels != below.pixels:
        return None
    place = QUANTITIES.index(quantity)
    of_above, of_below = decompose(above)[place], decompose(below)[place]
    ratio = of_above / of_below
    seeds = jackknife_error(ratio, replicates(above)[:, place] / replicates(below)[:, place], above.counts)
    if quantity == "variance":
        return seeds
    return numpy.hypot(seeds, numpy.linalg.norm(above.reference_terms - ratio * below.reference_terms) / of_below)
