"""Slopes on logarithmic axes over the recorded passes of a window, with their 95% intervals, beside those of theory.

Passes of one run are cumulative and so correlated: intervals come from leaving out groups of seeds (moments.py), by Student's
distribution with one degree less than groups, and for squared bias and MSE from the noise of the reference's halves as well. What a
prediction is measured from (the share of bias in MSE, that of direct light in the whole picture) has its part in the interval of the
difference: the same seeds are left out of both.
"""

import math

import numpy
from scipy import stats

from photonlab.statistics.jackknife import jackknife_error
from photonlab.statistics.moments import QUANTITIES, decompose, replicates, standard_errors

WIDEST = 1.0      # interval of a slope that says anything
RESOLVED = 2.0    # standard errors above 0


def default_window(passes):
    """From a 32nd of the last pass on, but not before pass 4: the first passes are not on the asymptote."""
    last = max(passes)
    return max(4, last // 32), last


def slope_weights(passes):
    """What the logarithm of each pass's value counts in the slope."""
    x = numpy.log(numpy.asarray(passes, dtype=float))
    x -= x.mean()
    return x / (x @ x)


def slope(passes, values):
    """Least squares on logarithmic axes; NaN when a value is not positive. `values` may have rows of replicates."""
    with numpy.errstate(invalid="ignore", divide="ignore"):
        return numpy.log(values) @ slope_weights(passes)


def fit(moments, passes, predicted, predicted_without):
    """{quantity: (slope, low, high, predicted slope, that at edges, verdict)} from {pass: Moments}; the prediction, and that
    without each group."""
    counts = moments[passes[0]].counts
    values = numpy.array([decompose(moments[number]) for number in passes])    # [pass][quantity]
    without = numpy.array([replicates(moments[number]) for number in passes])    # [pass][group][quantity]
    errors = numpy.array([standard_errors(moments[number]) for number in passes])
    terms = numpy.array([moments[number].reference_terms for number in passes])    # [pass][pixel]
    student = stats.t.ppf(0.975, len(counts) - 1)    # since the error over seeds is estimated from as many groups

    def reach_of(value, left, of_reference):
        """Half of the 95% interval, of the seeds and of the reference's noise."""
        return math.hypot(student * jackknife_error(value, left, counts),
                          stats.norm.ppf(0.975) * numpy.linalg.norm(of_reference))

    results = {}
    for place, quantity in enumerate(QUANTITIES):
        expected = {bias: predicted_slope(quantity, passes, values[0], predicted, bias) for bias in ["squared_bias", "edge"]}
        found = slope(passes, values[:, place])
        left = slope(passes, without[:, :, place].T)
        if not (values[:, place] > RESOLVED * errors[:, place]).all() or not numpy.isfinite(left).all():
            results[quantity] = (None, None, None, *expected.values(), "cannot tell")
            continue
        of_reference = (slope_weights(passes) / values[:, place]) @ terms if quantity != "variance" else numpy.zeros(1)
        differences = []
        for bias, slope_expected in expected.items():
            # Where the bias cannot be told, the two predictions of MSE differ in noise alone.
            if slope_expected is None or (bias == "edge" and quantity == "mse" and results["squared_bias"][0] is None):
                continue
            expected_left = numpy.array([predicted_slope(quantity, passes, first, of_group, bias)
                                         for first, of_group in zip(without[0], predicted_without)])
            off = found - slope_expected
            differences.append((off, reach_of(off, left - expected_left, of_reference)))
        reach = reach_of(found, left, of_reference)
        results[quantity] = (found, found - reach, found + reach, *expected.values(),
                             "cannot tell" if 2 * reach > WIDEST else verdict_of(differences))
    return results


def verdict_of(differences):
    """Of a slope's differences from its predictions, where light is smooth and at edges (without those that there are not),
    each with half the width of its interval."""
    if not all(2 * reach <= WIDEST for _, reach in differences):
        return "cannot tell"
    for (off, reach), agreement in zip(differences, ["agrees", "agrees at edges"]):
        if abs(off) <= reach:
            return agreement
    if len(differences) == 2 and differences[0][0] * differences[1][0] < 0:
        return "between"
    return "differs" if differences else ""


def predicted_slope(quantity, passes, first_values, predicted, bias):
    """The fitted slope of the prediction at these passes, with squared bias as `bias` ("squared_bias", "edge") says; None
    without one. `first_values`, of all quantities at the first of them, may have rows of replicates; NaN where they are such
    that the prediction is not positive."""
    places = numpy.array(passes) - 1
    if quantity == "variance":
        # It has no other prediction at edges.
        return slope(passes, predicted["variance"][places]) if predicted and bias == "squared_bias" else None
    if bias not in predicted:
        return None
    squared, variance = predicted[bias][places], predicted["variance"][places]
    if quantity == "squared_bias":
        return slope(passes, squared)
    return slope(passes, first_values[..., 0:1] * (variance / variance[0]) + first_values[..., 1:2] * (squared / squared[0]))
