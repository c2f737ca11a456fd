"""Standard errors by leaving out: each group of seeds, or each seed."""

import math

import numpy


def jackknife_error(estimate, without, counts):
    """Standard error of an estimate from its replicates without each group, a row a group; `counts` are the seeds in each.
    [Busing, Meijer and van der Leeden 1999, "Delete-m Jackknife for Unequal m", equations 8 and 9]"""
    shares = counts.sum() / counts
    shape = (-1,) + (1,) * (without.ndim - 1)
    shares = shares.reshape(shape)
    groups = len(counts)
    combined = groups * estimate - ((1 - 1 / shares) * without).sum(axis=0)
    pseudo = shares * estimate - (shares - 1) * without
    return numpy.sqrt(((pseudo - combined) ** 2 / (shares - 1)).mean(axis=0))


def over_seeds(estimate, *samples):
    """(estimate of the samples, its standard error by leaving out each seed; NaN with a single one)."""
    count = len(samples[0])
    if count < 2:
        return estimate(*samples), math.nan
    left = numpy.array([estimate(*(numpy.delete(sample, place) for sample in samples)) for place in range(count)])
    return estimate(*samples), math.sqrt((count - 1) / count * ((left - left.mean()) ** 2).sum())
