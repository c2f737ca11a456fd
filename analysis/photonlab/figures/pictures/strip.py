"""Draws what the numbers of a run look like: for every scene the images of PM, of PPM and of the reference side by
side, and under each how it differs from the reference. Of each kind it is the method that ended with the least error.

Differences keep their sign, so that bias (a region all of one colour) can be told from noise (both colours mixed). They
share one scale. Under each image are its pass and its RMSE from iterations.csv: unbiased where the reference has two
halves.
"""

from dataclasses import dataclass, field

import numpy

from photonlab.command import Command, positive
from photonlab.drawing import compared, pictures, style
from photonlab.drawing.cells import Cell, Tile, draw_cells
from photonlab.drawing.saving import Drawn
from photonlab.records import files, images, methods, records, references
from photonlab.statistics import errors

COMPONENT_TITLES = {"total": "whole image", "emission": "emission alone", "direct": "direct light alone",
                    "gathered": "gathered light alone"}


@dataclass
class Entry:
    """A picture of the strip with the difference under it."""
    label: str
    below: list                   # what stands under both, line by line
    image: numpy.ndarray
    difference: numpy.ndarray     # None without a reference


@dataclass
class Strip:
    entries: list = field(default_factory=list)
    reference: numpy.ndarray = None
    floor: float = 0.0            # its RMSE; NaN without halves
    said: list = field(default_factory=list)    # what is left out

    @property
    def differences(self):
        return [entry.difference for entry in self.entries if entry.difference is not None]


def chosen_pass(passes_of_methods, wanted):
    """The wanted pass, or the last one of which every method has a snapshot; None where there is no such pass."""
    if wanted is not None:
        return wanted
    common = set.intersection(*passes_of_methods) if passes_of_methods else set()
    return max(common) if common else None


def errors_at_end(scene, component):
    """{label: mean over seeds of the squared error after the last pass that all of them recorded}, of what has one."""
    found = {}
    for label, rows in scene.rows[(scene.rows["component"] == component) & scene.rows["mse"].notna()].groupby("method"):
        last = errors.last_pass(rows)
        if len(last):
            found[label] = last[errors.error_column(last)].mean()
    return found


def collect(scene, component, options):
    """What there is to draw of the records of one scene."""
    found, strip = {}, Strip()
    for label in methods.shown_methods(scene, options.alpha, options.all or scene.is_part, errors_at_end(scene, component)):
        rows = methods.run_of(scene, label, options.seed)
        run = None if rows is None else scene.run(rows["run"].iloc[0])
        if run and run.snapshots:
            found[label] = rows, run
        else:
            seed = "" if options.seed is None else f" with seed {options.seed}"
            strip.said.append(f"{scene.scene}: {label}: no snapshots of a run{seed}, so not in the strip")
    common = chosen_pass([set(run.snapshots) for _, run in found.values()], getattr(options, "pass"))
    for label, (rows, run) in found.items():
        number = max(run.snapshots) if common is None else common
        why_not = add_entry(strip, scene, label, rows, run, number, component)
        if why_not:
            strip.said.append(f"{scene.scene}: {label}: {why_not}")
    return strip


def add_entry(strip, scene, label, rows, run, number, component):
    """Adds a snapshot to the strip. Returns what is missing of it."""
    if number not in run.snapshots:
        return f"no snapshot of pass {number}; there are those of {', '.join(map(str, sorted(run.snapshots)))}"
    file, carried = run.snapshots[number], rows["direct"].iloc[0] == "photons"
    image = images.read_component(file, component)
    if image is None:
        return f"{file} has no layer {component}"
    judge, reference = references.read_reference_of(scene, run, component, carried)
    if reference is not None:
        images.require_same_size(file, image, judge.halves[0], reference)
        if strip.reference is None:
            strip.reference = reference
            strip.floor = errors.root(rows[rows["component"] == component]["reference_floor"].max())
    difference = None if reference is None else (image - reference).mean(axis=2)
    below = [f"pass {number}", pictures.error_text(rows[(rows["pass"] == number) & (rows["component"] == component)])]
    strip.entries.append(Entry(label, list(filter(None, below)), image, difference))
    if reference is None:
        why = f": {judge.path} {judge.why_not or 'has none'}" if judge else ""
        return f"no reference for the {COMPONENT_TITLES[component]}{why}, so no difference"
    return None


def note_of(strip, exposure, noise):
    note = f"Pictures: radiance × {exposure:.3g}, sRGB."
    if strip.differences:
        note += " Differences: mean over R, G, B."
    if strip.floor > 0:
        note += f" Floor of the reference: RMSE {errors.two_digits(strip.floor)}."
    return f"{note} {noise}"


def largest_difference(differences):
    """Of all but 1% of the pixels; 1 where nothing differs."""
    largest = max([numpy.percentile(numpy.abs(difference[numpy.isfinite(difference)]), 99)
                   for difference in differences if numpy.isfinite(difference).any()], default=0.0)
    return largest or 1.0


@style.drawn_of_pictures
def draw(title, strip, exposure, noise):
    """The figure: images above, differences below, the reference last with the colour bar under it."""
    largest = largest_difference(strip.differences)
    colours = style.pyplot.get_cmap(style.DIFFERENCE_COLOURS).copy()
    colours.set_bad("#ff00ff")
    shown = []
    for entry in strip.entries:
        rows = [[Tile(pictures.to_srgb(entry.image, exposure))]]
        if entry.difference is not None:
            rows.append([Tile(entry.difference, {"cmap": colours, "vmin": -largest, "vmax": largest})])
        shown.append(Cell(entry.label, rows, entry.below))
    if strip.reference is not None:
        shown.append(Cell("reference", [[Tile(pictures.to_srgb(strip.reference, exposure))]]))
    figure, axes = draw_cells(shown, title, note_of(strip, exposure, noise))
    if strip.reference is not None and strip.differences:
        mapped = next(rows[1][0].images[0] for rows in axes if len(rows) > 1 and isinstance(rows[1], list))
        add_colour_bar(figure, axes[-1][1], strip, mapped, largest)
    return figure


def add_colour_bar(figure, place, strip, mapped, largest):
    """Under the reference, where its difference would be: what the colours of differences mean. `place` is in fractions of the
    figure."""
    x, y, width, height = place
    small = style.size("small")
    heading = 1.5 * small / 72 / figure.get_figheight()
    figure.text(x, y + height, "image − reference", fontsize=small, va="top")
    bar = figure.add_axes([x, y, 0.12 / figure.get_figwidth(), height - heading])
    beyond = any((numpy.abs(difference) > largest).any() for difference in strip.differences)
    figure.colorbar(mapped, cax=bar, extend="both" if beyond else "neither", ticks=[-largest, 0, largest])
    limit = errors.two_digits(largest)
    bar.set_yticklabels([f"−{limit}", "0", f"+{limit}"], fontsize=small)


def make(results, options):
    for scene in results.scenes():
        for component in options.components:
            strip = collect(scene, component, options)
            yield from strip.said
            if not strip.entries:
                yield f"{scene.scene}: nothing to show, so no strip"
                continue
            exposure = options.exposure or pictures.exposure_for(strip.entries[0].image if strip.reference is None else strip.reference)
            figure = draw(f"{scene.scene}: {COMPONENT_TITLES[component]}", strip, exposure, errors.noise_note(scene.rows), **options.look)
            yield Drawn(f"strip-{files.as_file_name(scene.scene)}{compared.ending_of(component)}", figure)


def add_options(parser):
    parser.add_argument("--pass", type=int, metavar="N",
                        help="pass to show (default: the last one that all methods have)")
    parser.add_argument("--seed", type=int, metavar="S", help="seed to show (default: each method's lowest)")
    parser.add_argument("--alpha", type=positive, nargs="+", default=[], metavar="A",
                        help="alphas to show of methods that have one (default: the best)")
    parser.add_argument("--all", action="store_true", help="show every method, not the best one of each kind")
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=["total"],
                        help="which light, a figure each (default: total)")
    parser.add_argument("--exposure", type=positive, metavar="E",
                        help="factor on radiance in the pictures (default: 97%% of the lit pixels are below white)")


COMMAND = Command(
    name="strip", draws=True, summary="PM, PPM and reference side by side, with their differences", about=__doc__,
    writes="figures/strip-SCENE.png and .pdf (strip-SCENE-COMPONENT for a single component)",
    make=make, is_for=pictures.has_snapshots, add_options=add_options)
