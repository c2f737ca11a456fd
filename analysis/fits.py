"""Fits how fast variance, squared bias and MSE fall with the passes, and sets the slopes beside theory; finds the best alpha.

A slope is that of a straight line through log(quantity) against log(pass), least squares over the recorded passes of a window.
Passes of one run are cumulative and so correlated: intervals come from leaving out groups of seeds (decomposition.py), 95% by
Student's distribution with one degree less than groups. Beside it stand

    asymptote    variance -alpha, squared bias 2 (alpha - 1), MSE -min(alpha, 2 - 2 alpha), where light is smooth
                 [Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013]
    edge         (alpha - 1) / 2 for squared bias: at edges it is of order one in a band as wide as the radius
    predicted    the slope of the exact sums at these passes, fitted in the same way, which is the fair comparison before
                 the asymptote: variance_n / variance_1 = n^-2 sum r_1^2 / r_i^2, bias_n / bias_1 = mean of r_i^2 / r_1^2, with
                 Knaus and Zwicker's radii in closed form, and with Hachisuka's as they were recorded; MSE is their sum, with
                 the measured shares at the window's first pass
    predicted_edge   the same where all bias is that of a straight edge, at which a disc of radius r at the distance t r
                 misses the share (acos t - t sqrt(1 - t^2)) / pi of its photons

and a verdict: "agrees" when the difference from `predicted` is within its 95% interval, "agrees at edges" when that from
`predicted_edge` is, "between" when the slope lies between the two (pictures have both smooth walls and edges), otherwise
"differs"; "cannot tell" when a quantity is not above two standard errors at every pass of the window, or an interval is wider
than 1. Intervals are those of the seeds and, for squared bias and MSE, of the noise of the reference's halves. What a
prediction is measured from (the share of bias in MSE, that of direct light in the whole picture) has its part in the interval of
the difference: the same seeds are left out of both.

Which alpha has the least MSE is told with the probability of each, by drawing groups of seeds anew with replacement, the same
groups for all alphas, and counting who wins. With a seed a group MSE is a plain mean over the groups, whatever share of it is
squared bias, and drawing anew is right for means. With several, the scatter inside the groups is lost and what is drawn comes
out too low; so it is centred on the estimate, and spread by the root of G / (G - 1), which drawing from G groups falls short of.
The reference's noise is not drawn: it is common to all alphas, and most of it drops out between them.
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import decomposition
    import files
    import numpy
    import pandas
    import records
    import tables
    from files import InputError
    from scipy import stats
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas and OpenImageIO (on Debian: "
          "/usr/bin/python3 with python3-scipy, python3-pandas, python3-xxhash and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

WIDEST = 1.0      # interval of a slope that says anything
RESOLVED = 2.0    # standard errors above 0
FIT_COLUMNS = ["experiment", "scene", "point", *records.TABLE_SETTINGS, "component", "region", "quantity", "first_pass",
               "last_pass", "passes", "seeds", "slope", "low", "high", "asymptote", "edge", "predicted", "predicted_edge", "verdict"]
FAMILY = [column for column in records.SETTINGS if column != "alpha"]    # what alphas that are compared have in common
BEST_COLUMNS = ["experiment", "scene", *FAMILY, "threads", "component", "region", "pass", "paths_emitted", "best_alpha", "probability",
                "candidates", "mse", "runner_up", "difference", "difference_error", "verdict"]
DRAWS = 2000       # of groups of seeds
EDGE_STEPS = 2000  # of the integral over the distance to an edge
EXCLUDED = 0.05    # an alpha that is best with less than that is no candidate


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
    radii = pandas.to_numeric(of_total["radius_mean"], errors="coerce")
    if radii.isna().any():
        raise InputError(f"run {of_total['run'][radii.isna()].iloc[0]}: expected radius_mean in every row of ppm")
    means = radii.groupby(of_total["pass"]).mean()
    if means.empty or means.index.max() < last:
        raise InputError(f"iterations.csv: expected radii of run {rows['run'].iloc[0]} up to pass {last}, which its sums have")
    number = numpy.arange(1, last + 1)
    return numpy.exp(2 * numpy.interp(numpy.log(number), numpy.log(means.index + 1.0), numpy.log(means))
                     - 2 * math.log(means.iloc[0]))


def squared_bias_at_edges(squared):
    """Squared bias along a straight edge, integrated over the distance to it, after each of the passes whose r_i^2 / r_1^2 are
    given; up to a factor that is common to all. [Share of a disc beyond a chord; each pass has an equal part in the mean]"""
    radii = numpy.sqrt(squared)
    distances = (numpy.arange(EDGE_STEPS) + 0.5) / EDGE_STEPS * radii.max()
    mean, found = numpy.zeros(EDGE_STEPS), numpy.empty(len(radii))
    for place, radius in enumerate(radii):
        t = numpy.minimum(1, distances / radius)
        missed = (numpy.arccos(t) - t * numpy.sqrt(1 - t * t)) / math.pi
        mean += (missed - mean) / (place + 1)
        found[place] = (mean ** 2).mean()
    return found


def is_sampled(first, component):
    """True for light that is a plain Monte Carlo mean: path tracing, and direct light by shadow rays."""
    return first["integrator"] == "path" or (component == "direct" and first["direct"] == "sampled")


def predictions(rows, component, last):
    """{"variance", "squared_bias", "edge"}: for passes 1 to last, each up to a factor, squared bias where light is smooth and at
    edges; without what has no prediction. Those of component "total" are of its gathered light; with_direct_light() adds
    the rest."""
    first = rows.iloc[0]
    number = numpy.arange(1, last + 1)
    if is_sampled(first, component):
        return {"variance": 1 / number}
    if first["integrator"] == "photonmapper":
        constant = {"variance": 1 / number, "squared_bias": numpy.ones(last), "edge": numpy.ones(last)}
        return constant if first["mode"] == "radius" else {}
    knaus_zwicker = first["schedule"] == "knaus-zwicker"
    squared = knaus_zwicker_radii(float(first["alpha"]), last) if knaus_zwicker else recorded_radii(rows, last)
    return {"variance": numpy.cumsum(1 / squared) / number ** 2, "squared_bias": (numpy.cumsum(squared) / number) ** 2,
            "edge": squared_bias_at_edges(squared)}


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
    none = {quantity: (None, None) for quantity in decomposition.QUANTITIES}
    if is_sampled(first, component):
        return {**none, "variance": (-1.0, None), "mse": (-1.0, None)}
    if first["integrator"] == "photonmapper":
        fixed = {"variance": (-1.0, None), "squared_bias": (0.0, 0.0), "mse": (0.0, None)}
        return fixed if first["mode"] == "radius" else none
    alpha = float(first["alpha"])
    return {"variance": (-alpha, None), "squared_bias": (2 * (alpha - 1), (alpha - 1) / 2),
            "mse": (-min(alpha, 2 - 2 * alpha), None)}


def fit(moments, passes, predicted, predicted_without):
    """{quantity: (slope, low, high, predicted slope, that at edges, verdict)} from {pass: Moments}; the prediction, and that
    without each group."""
    counts = moments[passes[0]].counts
    values = numpy.array([decomposition.decompose(moments[number]) for number in passes])    # [pass][quantity]
    without = numpy.array([decomposition.replicates(moments[number]) for number in passes])    # [pass][group][quantity]
    errors = numpy.array([decomposition.standard_errors(moments[number]) for number in passes])
    terms = numpy.array([moments[number].reference_terms for number in passes])    # [pass][pixel]
    student = stats.t.ppf(0.975, len(counts) - 1)    # since the error over seeds is estimated from as many groups

    def reach_of(value, left, of_reference):
        """Half of the 95% interval, of the seeds and of the reference's noise."""
        return math.hypot(student * decomposition.jackknife_error(value, left, counts),
                          stats.norm.ppf(0.975) * numpy.linalg.norm(of_reference))

    results = {}
    for place, quantity in enumerate(decomposition.QUANTITIES):
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


def text(number):
    return "" if number is None else decomposition.text(number)


def fits_of(ensemble, own, moments, component, window):
    """The rows of fits.csv of one point and component. `moments` are by component."""
    first = own.iloc[0]
    passes = [number for number in sorted(ensemble.description["passes"]) if window[0] <= number <= window[1]]
    if len(passes) < 3:
        print(f"{ensemble.folder}: fewer than 3 recorded passes from {window[0]} to {window[1]}, so no slopes")
        return []
    gathered = predictions(own, component, passes[-1])
    table = []
    for region in dict.fromkeys(region for _, region in moments[component]):
        of_region = {number: moments[component].get((number, region)) for number in passes}
        if None in of_region.values():    # no finite pixel
            continue
        predicted, predicted_without = gathered, [gathered] * len(ensemble.seeds)
        if component == "total" and moments.get("direct"):
            of_parts = [moments[part][passes[0], region] for part in ["direct", "gathered"]]
            shares = [decomposition.decompose(part)[0] for part in of_parts]
            shares_without = [decomposition.replicates(part)[:, 0] for part in of_parts]
            predicted = with_direct_light(gathered, *shares, passes[0])
            predicted_without = [with_direct_light(gathered, *left, passes[0]) for left in zip(*shares_without)]
        for quantity, (found, low, high, expected, at_edges, verdict) in fit(of_region, passes, predicted,
                                                                            predicted_without).items():
            smooth, edge = asymptotes(first, component)[quantity]
            table.append({
                "experiment": first["experiment"], "scene": first["scene"], "point": ensemble.point,
                **records.table_settings(own), "component": component, "region": region,
                "quantity": quantity, "first_pass": passes[0], "last_pass": passes[-1], "passes": len(passes),
                "seeds": int(of_region[passes[0]].counts.sum()), "slope": text(found), "low": text(low), "high": text(high),
                "asymptote": text(smooth), "edge": text(edge), "predicted": text(expected), "predicted_edge": text(at_edges),
                "verdict": verdict})
    return table


def drawn_mse(moments, draws):
    """MSE from groups of seeds drawn anew: `draws` says in each row how often each group was drawn."""
    counts, gram, groups = moments.counts, moments.gram, len(moments.counts)
    seeds = draws @ counts
    weights = draws * counts / seeds[:, None]
    of_mean = numpy.einsum("dg,gh,dh->d", weights, gram, weights)
    variance = ((draws * counts) @ numpy.diag(gram) - seeds * of_mean) / (groups - 1)
    found = of_mean - moments.floor + variance * (1 - 1 / seeds)
    return decomposition.decompose(moments)[2] + (found - found.mean()) * math.sqrt(groups / (groups - 1))


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


def best_alphas(family, component):
    """Rows of best-alphas.csv of points of one scene that differ in alpha alone: {alpha: (own records, seeds by group,
    {(pass, region): Moments})}. All share their seeds, so differences are taken group by group."""
    table = []
    first_own, first_seeds, first_moments = next(iter(family.values()))
    if any(seeds != first_seeds for _, seeds, _ in family.values()):
        print(f"{first_own['scene'].iloc[0]}: alphas with other seeds or other slots than each other, so no best alpha")
        return []
    for number, region in first_moments:
        if number == 0:
            continue
        found = {}
        for alpha, (_, _, moments) in family.items():
            if (number, region) not in moments:
                continue
            at = moments[number, region]
            found[alpha] = (decomposition.decompose(at)[2], decomposition.replicates(at)[:, 2], at)
        if len(found) < 2 or not all(numpy.isfinite(mse) for mse, *_ in found.values()):
            continue
        order = sorted(found, key=lambda alpha: found[alpha][0])
        (least, least_without, at), (second, second_without, _) = found[order[0]], found[order[1]]
        error = float(decomposition.jackknife_error(second - least, second_without - least_without, at.counts))
        probabilities = probabilities_of_best({alpha: moments for alpha, (*_, moments) in found.items()})
        candidates = sorted((alpha for alpha, probability in probabilities.items() if probability >= EXCLUDED), key=float)
        first = first_own.iloc[0]
        of_pass = first_own[(first_own["pass"] == number) & (first_own["component"] == component)]
        table.append({"experiment": first["experiment"], "scene": first["scene"],
                      **{column: value for column, value in records.table_settings(first_own).items() if column != "alpha"}, "component": component, "region": region,
                      "pass": number, "paths_emitted": decomposition.pandas_mean(of_pass["paths_emitted"]),
                      "best_alpha": order[0], "probability": text(probabilities.get(order[0])),
                      "candidates": ";".join(candidates), "mse": text(least), "runner_up": order[1],
                      "difference": text(second - least), "difference_error": text(error),
                      "verdict": "" if second - least > RESOLVED * error else "cannot tell"})
    return table


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/fits.csv and, where alpha was swept, best-alphas.csv: the alpha "
                                     "of least MSE by\nscene, component, region and pass, with its probability, the alphas of 5% "
                                     "and more, its lead\non the runner-up and that lead's standard error.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    parser.add_argument("--from", dest="first", type=int, metavar="PASS", help="first pass of the window (default: a 32nd of "
                        "the last, at least 4)")
    parser.add_argument("--to", dest="last", type=int, metavar="PASS", help="last pass of the window (default: the last)")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    table, families = [], {}
    for ensemble in decomposition.read_ensembles(results):
        own = decomposition.rows_of(ensemble, results)
        if own is None:
            continue
        first = own.iloc[0]
        first_pass, last_pass = default_window(ensemble.description["passes"])
        window = (options.first or first_pass, options.last or last_pass)
        # Emission has neither bias nor variance.
        moments = {component: decomposition.moments_of(ensemble, results, component)
                   for component in records.COMPONENTS if component != "emission"}
        for component in moments:
            if not moments[component]:
                continue
            table += fits_of(ensemble, own, moments, component, window)
            if first["integrator"] == "ppm":
                rest = tuple(first[column] for column in ["scene", *FAMILY])
                families.setdefault((rest, component), {})[first["alpha"]] = (own, ensemble.seeds,
                                                                              moments[component])
    print(tables.write_derived(results, "fits.csv", FIT_COLUMNS, table))
    best = [row for (_, component), family in families.items() if len(family) > 1
            for row in best_alphas(family, component)]
    if best:
        print(tables.write_derived(results, "best-alphas.csv", BEST_COLUMNS, best))
    else:
        files.remove_file(results.folder / "best-alphas.csv")    # of earlier records
    return 0


if __name__ == "__main__":
    files.run(main)
