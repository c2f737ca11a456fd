"""Fits how fast variance, squared bias and MSE fall with the passes, and sets the slopes beside theory; finds the best alpha.

A slope is that of a straight line through log(quantity) against log(pass), least squares over the recorded passes of a window.
Passes of one run are cumulative and so correlated: intervals come from leaving out groups of seeds (moments.py), 95% by
Student's distribution with one degree less than groups. Beside it stand

    asymptote    variance -alpha, squared bias 2 (alpha - 1), MSE -min(alpha, 2 - 2 alpha), where light is smooth
                 [Knaus and Zwicker 2011; Kaplanyan and Dachsbacher 2013]
    edge         (alpha - 1) / 2 for squared bias: at edges bias is of order one in a band as wide as the radius; by the area that
                 is there 3 (alpha - 1) / 2, by a local linear fit 5 (alpha - 1) / 2: of first and of second order
    predicted    the slope of the exact sums at these passes, fitted in the same way, which is the fair comparison before
                 the asymptote: variance_n / variance_1 = n^-2 sum r_1^2 / r_i^2, bias_n / bias_1 = mean of r_i^2 / r_1^2, with
                 Knaus and Zwicker's radii in closed form, and with Hachisuka's as they were recorded; MSE is their sum, with
                 the measured shares at the window's first pass
    predicted_edge   the same where all bias is that of a straight edge (theory.py)

and a verdict: "agrees" when the difference from `predicted` is within its 95% interval, "agrees at edges" when that from
`predicted_edge` is, "between" when the slope lies between the two (pictures have both smooth walls and edges), otherwise
"differs"; "cannot tell" when a quantity is not above two standard errors at every pass of the window, or an interval is wider
than 1. Intervals are those of the seeds and, for squared bias and MSE, of the noise of the reference's halves. What a
prediction is measured from (the share of bias in MSE, that of direct light in the whole picture) has its part in the interval of
the difference: the same seeds are left out of both.

Which alpha has the least MSE is told with the probability of each (best_alphas.py). best-alphas.csv, written where alpha was swept,
has it by scene, component, region and pass, with the alphas of 5% and more, the lead on the runner-up and that lead's standard
error.
"""

from photonlab.command import Command, has
from photonlab.records import ensembles, files, methods, records, tables
from photonlab.statistics import best_alphas, theory
from photonlab.statistics.decomposition import text
from photonlab.statistics.moments import decompose, moments_of, replicates
from photonlab.statistics.slopes import default_window, fit

NAME = "fits.csv"


def columns_of(columns):
    """Of the table; `columns` are those of the records."""
    return ["experiment", "scene", "point", "method", *columns.table_settings, "component", "region", "quantity", "first_pass", "last_pass",
            "passes", "seeds", "slope", "low", "high", "asymptote", "edge", "predicted", "predicted_edge", "verdict"]


def passes_in_window(ensemble, options):
    """(first pass of the window, last, the recorded ones in it)"""
    recorded = ensemble.description["passes"]
    first, last = default_window(recorded)
    first, last = options.first or first, options.last or last
    return first, last, [number for number in sorted(recorded) if first <= number <= last]


def moments_by_component(ensemble, results):
    """Of the components that apply; emission has neither bias nor variance."""
    found = {component: moments_of(ensemble, results, component) for component in records.COMPONENTS if component != "emission"}
    return {component: moments for component, moments in found.items() if moments}


def fits_of(ensemble, own, moments, component, passes, columns):
    """The rows of the table of one point and component over a window. `moments` are by component, `columns` those of the records."""
    first = own.iloc[0]
    predicted = theory.predictions(own, component, passes[-1])
    table = []
    for region in dict.fromkeys(region for _, region in moments[component]):
        of_region = {number: moments[component].get((number, region)) for number in passes}
        if None in of_region.values():    # no finite pixel
            continue
        found = fit(of_region, passes, *predictions_of_region(predicted, moments, component, passes[0], region, len(ensemble.seeds)))
        for quantity, (slope, low, high, expected, at_edges, verdict) in found.items():
            smooth, edge = theory.asymptotes(first, component)[quantity]
            table.append({
                "experiment": first["experiment"], "scene": first["scene"], "point": ensemble.point, "method": first["method"],
                **methods.table_settings(own, columns), "component": component, "region": region,
                "quantity": quantity, "first_pass": passes[0], "last_pass": passes[-1], "passes": len(passes),
                "seeds": int(of_region[passes[0]].counts.sum()), "slope": text(slope), "low": text(low), "high": text(high),
                "asymptote": text(smooth), "edge": text(edge), "predicted": text(expected), "predicted_edge": text(at_edges),
                "verdict": verdict})
    return table


def predictions_of_region(predicted, moments, component, first_pass, region, groups):
    """(prediction, the same without each group), with the share of direct light where the whole picture holds some."""
    if component != "total" or "direct" not in moments:
        return predicted, [predicted] * groups
    parts = [moments[part][first_pass, region] for part in ["direct", "gathered"]]
    shares, without = [decompose(part)[0] for part in parts], [replicates(part)[:, 0] for part in parts]
    return (theory.with_direct_light(predicted, *shares, first_pass),
            [theory.with_direct_light(predicted, *left, first_pass) for left in zip(*without)])


def make(results, options):
    table, families, left_out = [], {}, []
    for ensemble, own in ensembles.read_points(results, left_out):
        first_pass, last_pass, passes = passes_in_window(ensemble, options)
        if len(passes) < 3:
            left_out.append(f"{ensemble.folder}: fewer than 3 recorded passes from {first_pass} to {last_pass}, so no slopes")
        moments = moments_by_component(ensemble, results)
        first = own.iloc[0]
        for component in moments:
            if len(passes) > 2:
                table += fits_of(ensemble, own, moments, component, passes, results.columns)
            if first["alpha"]:
                rest = tuple(first[["scene", *best_alphas.family_of(results.columns)]])
                families.setdefault((rest, component), {})[first["alpha"]] = best_alphas.Point(own, ensemble.seeds,
                                                                                             moments[component])
    yield from left_out
    yield tables.Derived(NAME, columns_of(results.columns), table)
    yield from write_best(results, {key: family for key, family in families.items() if len(family) > 1})


def write_best(results, families):
    """best-alphas.csv of {(scene and settings, component): {alpha: point}}; an older one is removed where there is none."""
    best = []
    for ((scene, *_), component), family in families.items():
        if len({str(point.seeds) for point in family.values()}) > 1:
            yield f"{scene}: alphas with other seeds or other slots than each other, so no best alpha"
        else:
            best += best_alphas.best_alphas(family, component, results.columns)
    if best:
        yield tables.Derived(best_alphas.NAME, best_alphas.columns_of(results.columns), best)
    else:
        files.remove_file(results.folder / best_alphas.NAME)


def add_options(parser):
    parser.add_argument("--from", dest="first", type=int, metavar="PASS", help="first pass of the window (default: a 32nd of "
                        "the last, at least 4)")
    parser.add_argument("--to", dest="last", type=int, metavar="PASS", help="last pass of the window (default: the last)")


COMMAND = Command(
    name="fits", summary="slopes beside theory, into fits.csv; the best alphas", about=__doc__,
    writes="fits.csv and, where alpha was swept, best-alphas.csv",
    make=make, is_for=has("ensembles"), add_options=add_options)
