"""Tells bias from variance: what is left of a method's error when its noise is averaged away, and the noise itself.

Input are the sums of images over independent seeds that `photonlab run` keeps for an experiment with `decomposition = true`, and the
reference's halves. The table has a row a point, recorded pass, component and region, with variance (of one seed), squared bias and
MSE, their sum, each with its standard error; statistics/moments.py says how they are estimated. All three are unbiased, so what is
near zero can come out below it; the sign is kept. A reference of one image has no halves: its own noise is then part of the squared
bias.
"""

import numpy

from photonlab.command import Command, has
from photonlab.records import ensembles, images, methods, records, tables
from photonlab.records.files import InputError
from photonlab.statistics.moments import QUANTITIES, decompose, moments_of, standard_errors

NAME = "decomposition.csv"
MEASURED = ["seeds", "groups", "paths_emitted", "seconds", *(f"{quantity}{part}" for quantity in QUANTITIES for part in ["", "_error"])]


def columns_of(columns):
    """Of the table; `columns` are those of the records."""
    return ["experiment", "scene", "point", "method", *columns.table_settings, "pass", "component", "region", "pixels", *MEASURED,
            "reference_floor"]


def text(number):
    """A number with all its digits; empty where there is none."""
    return "" if number is None or not numpy.isfinite(number) else repr(float(number))


def table_of(ensemble, results, own):
    """The rows of the table for one point; `own` are its records."""
    first = own.iloc[0]
    has_halves = len(ensembles.read_halves(ensemble, results, "total")) == 2
    table = []
    for component in records.COMPONENTS:
        for (number, region), moments in moments_of(ensemble, results, component).items():
            of_pass = own[(own["pass"] == number) & (own["component"] == component)]
            table.append({
                "experiment": first["experiment"], "scene": first["scene"], "point": ensemble.point, "method": first["method"],
                **methods.table_settings(own, results.columns), "pass": number, "component": component,
                "region": region, "pixels": moments.pixels, "seeds": int(moments.counts.sum()),
                "groups": len(moments.counts), "paths_emitted": text(of_pass["paths_emitted"].mean()),
                "seconds": repr(float(of_pass["seconds"].mean())), "reference_floor": repr(moments.floor) if has_halves else "",
                **{name: text(value) for name, value in zip(QUANTITIES, decompose(moments))},
                **{f"{name}_error": text(error) for name, error in zip(QUANTITIES, standard_errors(moments))}})
    return table


def read_decomposition(results):
    """Rows of RESULTS/decomposition.csv with estimates and errors as numbers, NaN where there are none."""
    file = results.folder / NAME
    rows = tables.read_derived(results, NAME, ["scene", "point", "component", "region", "pass", *MEASURED], "`photonlab analyse decomposition`")
    for column in ["pass", *MEASURED]:
        rows[column] = tables.to_numbers(file, rows[column], whole=column in ["pass", "seeds", "groups"])
    return rows


def error_of_independent_ratio(first, second, quantity):
    """Standard error of the ratio of a quantity of two rows of the table, of methods that share nothing."""
    return abs(first[quantity] / second[quantity]) * numpy.hypot(first[f"{quantity}_error"] / first[quantity],
                                                                 second[f"{quantity}_error"] / second[quantity])


def pass_of_images(ensemble, wanted):
    """The pass that was asked for, or the last."""
    passes = ensemble.description["passes"]
    if wanted is not None and wanted not in passes:
        raise InputError(f"{ensemble.folder}: pass {wanted} was not recorded; expected one of "
                         f"{', '.join(map(str, sorted(passes)))} for --images")
    return max(passes) if wanted is None else wanted


def write_images(ensemble, results, number):
    """RESULTS/decomposition/POINT/pass-N.exr: layers `bias` (signed) and `variance` (of one seed), a value a pixel and
    channel; R, G, B are the bias. Nothing without a reference."""
    halves = ensembles.read_halves(ensemble, results, "total")
    if not halves:
        return
    counts = ensemble.counts
    of_groups = numpy.stack([ensemble.component(group, number, "total") for group in range(len(counts))])
    mean = numpy.tensordot(counts / counts.sum(), of_groups, axes=1)
    variance = numpy.tensordot(counts, (of_groups - mean) ** 2, axes=1) / (len(counts) - 1)
    bias = mean - sum(halves) / len(halves)
    file = results.folder / "decomposition" / ensemble.point / f"pass-{number:06}.exr"
    images.write_exr(file, [f"{prefix}{channel}" for prefix in ["", "bias.", "variance."] for channel in "RGB"],
                     numpy.concatenate([bias, bias, variance], axis=2), results.hash)


def make(results, options):
    table, left_out = [], []
    for ensemble, own in ensembles.read_points(results, left_out):
        table += table_of(ensemble, results, own)
        write_images(ensemble, results, pass_of_images(ensemble, options.images))
    yield from left_out
    yield tables.Derived(NAME, columns_of(results.columns), table)


def add_options(parser):
    parser.add_argument("--images", type=int, metavar="PASS", help="the recorded pass whose images are written (default: the "
                        "last)")


COMMAND = Command(
    name="decomposition", summary="variance and squared bias, into decomposition.csv and images", about=__doc__,
    writes="decomposition.csv and, of one pass, images of bias and variance in decomposition/",
    make=make, is_for=has("ensembles"), add_options=add_options)
