"""Draws of which frequencies errors are made, at the last pass of which all methods have pictures: blotches are at the left, grain is
at the right, and two methods of one RMSE (--at) can differ by a factor of ten at either end.

The power is summed in rings of one cycle an image, and all rings with the frequency 0 add up to the unbiased MSE (the formula, after
Celarek et al. 2019, is in statistics/spectrum.py); it is free of the reference's noise where the reference has two halves. Lines are
means over the seeds that have snapshots; beyond eight cycles neighbouring rings are drawn as their mean, an eighth of an octave at a
time, up to half a cycle a pixel: what is beyond, in the corners of the plane of frequencies, is in the sum and not drawn. What is not
above 0 is below what this reference can resolve, and left out. The number beside a name is the share of the MSE that is in the mean of
the picture, at the frequency 0, which has no place on the axis.
"""

import math

import numpy
from matplotlib import lines

from photonlab.command import Command, positive
from photonlab.drawing import compared, style
from photonlab.drawing.panels import name_row, panels_over_legend, set_titles
from photonlab.drawing.pictures import has_snapshots
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.figures.errors.convergence import COMPONENT_TITLES
from photonlab.records import records, snapshots, tables
from photonlab.statistics import errors
from photonlab.statistics.spectrum import COLUMNS, NAME, over_seeds, spectrum

SINGLE = 8    # cycles: rings that are drawn one by one


def passes_at(scene, component, rmse):
    """{label: pass} of the pictures whose RMSE is nearest to this one, of each method's lowest seed."""
    nearest = {label: compared.nearest(compared.shots_of(scene, label, component), compared.error_of, rmse) for label in scene.labels}
    return {label: int(shot[0]["pass"].iloc[0]) for label, shot in nearest.items() if shot}


def spectra_of(scene, component, passes):
    """{label: (power by ring, its standard error, seeds)} of the records of one scene, after {label: pass}."""
    found = {}
    for label, shown, halves in snapshots.judged_images(scene, component, passes):
        found[label] = (*over_seeds([spectrum(image, *halves) for image in shown]), len(shown))
    return found


def curve_of(power):
    """(frequencies, powers): rings up to SINGLE as they are, beyond as means over an eighth of an octave. Rings whose corners alone are
    in the image, beyond a share of sqrt(1/2), are left out."""
    power = power[:int(len(power) * math.sqrt(0.5))]
    rings = numpy.arange(1, len(power))
    bins = numpy.where(rings <= SINGLE, rings, SINGLE + numpy.ceil(8 * numpy.log2(rings / SINGLE)))
    places = numpy.unique(bins)
    return (numpy.array([numpy.exp(numpy.log(rings[bins == place]).mean()) for place in places]),
            numpy.array([power[1:][bins == place].mean() for place in places]))


@style.drawn
def draw(scene, found, passes, component="total"):
    """The figure of the records of one scene and their spectra_of() after {label: pass}; None where nothing is resolved."""
    curves = {label: curve_of(power) for label, (power, _, _) in found.items()}
    values = [value for _, powers in curves.values() for value in powers if value > 0]
    if not values:
        return None
    styles = style.method_styles(scene)
    shares = {label: power[0] / power.sum() for label, (power, _, _) in found.items() if power.sum() > 0}
    common = len(set(passes.values())) == 1
    told = {label: ["" if common else f"pass {passes[label]}", f"mean {max(0.0, shares[label]):.1%}" if label in shares else ""]
            for label in curves}
    handles = [lines.Line2D([], [], label=f"{label} ({', '.join(filter(None, told[label]))})", **styles[label]) for label in curves]
    seeds = [count for *_, count in found.values()]
    of = COMPONENT_TITLES[component].capitalize() + (f" after pass {next(iter(passes.values()))}, " if common else ", ")
    count = f"{min(seeds)}" if min(seeds) == max(seeds) else f"{min(seeds)} to {max(seeds)}"
    caption = f"{of}means over {count} seeds. Rings of one cycle an image, beyond {SINGLE} cycles means of neighbours; with the mean " \
        f"they sum to the MSE. {errors.noise_note(scene.rows)}"
    figure, grid = panels_over_legend(1, 1, handles, caption, panel_height=2.6)
    axes = grid[0][0]
    for label, (frequencies, powers) in curves.items():
        axes.plot(frequencies, numpy.where(powers > 0, powers, numpy.nan), markevery=style.marked_places(list(frequencies), 7),
                  **styles[label])
    high = max(frequencies[-1] for frequencies, _ in curves.values())
    style.logarithmic(axes.xaxis, 0.9, high * 1.1)
    style.logarithmic(axes.yaxis, min(values) / 1.3, max(values) * 1.3)
    axes.set_xlabel("cycles an image")
    name_row(grid[0], "power in a ring (radiance²)")
    set_titles(axes, scene.scene)
    return figure


def rows_of(scene, component, passes, found):
    return [{"scene": scene, "component": component, "method": label, "pass": passes[label], "frequency": ring, "power": float(value),
             "power_error": float(error), "seeds": seeds}
            for label, (power, errors_of_rings, seeds) in found.items()
            for ring, (value, error) in enumerate(zip(power, errors_of_rings))]


def make(results, options):
    table, drawn = [], []
    for scene in results.scenes():
        for component in options.components:
            if options.at:
                passes = passes_at(scene, component, options.at)
            else:
                number = getattr(options, "pass") or snapshots.last_common_pass(scene)
                passes = dict.fromkeys(scene.labels, number) if number else {}
            found = spectra_of(scene, component, passes)
            table += rows_of(scene.scene, component, passes, found)
            figure = draw(scene, found, passes, component, **options.look) if found else None
            drawn.append((f"{scene.scene}{compared.ending_of(component)}", figure))
    yield from drawn_of_scenes("spectrum", drawn, "no pictures with a reference at one pass, so no spectrum")
    if not options.at:
        yield tables.Derived(NAME, COLUMNS, table)


def add_options(parser):
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=["total"], help="which light, a figure each "
                        "(default: total)")
    parser.add_argument("--at", type=positive, metavar="RMSE", help="of each method's picture whose RMSE is nearest to this one")
    parser.add_argument("--pass", type=int, metavar="N", help="of the pictures after this pass (default: the last of all methods)")


COMMAND = Command(
    name="spectrum", draws=True, summary="of which frequencies errors are made", about=__doc__,
    writes="spectrum.csv and figures/spectrum-SCENE, .png and .pdf",
    make=make, is_for=has_snapshots, add_options=add_options)
