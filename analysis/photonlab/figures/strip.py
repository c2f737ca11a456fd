"""Draws what the numbers of a run look like: for every scene the images of PM, of PPM and of the reference side by
side, and under each how it differs from the reference.

Differences keep their sign, so that bias (a region all of one colour) can be told from noise (both colours mixed). They
share one scale. Under each image are its pass and its RMSE from iterations.csv: unbiased where the reference has two
halves.
"""

import textwrap
from dataclasses import dataclass, field

import numpy

from photonlab.command import Command, positive
from photonlab.drawing import pictures, style
from photonlab.drawing.saving import save
from photonlab.records import files, images, methods, records, references
from photonlab.statistics import errors

COMPONENT_TITLES = {"total": "whole image", "emission": "emission alone", "direct": "direct light alone",
                    "gathered": "gathered light alone"}
SMALLEST_CELL = 1.1              # inches; many methods make a wider figure, not smaller pictures
GAP, MARGIN, ROW_GAP = 0.06, 0.1, 0.08


@dataclass
class Entry:
    """A picture of the strip with the difference under it."""
    label: str
    below: str                    # what stands under both
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


def collect(scene, options):
    """What there is to draw of the records of one scene."""
    found, strip = {}, Strip()
    for label in methods.shown_methods(scene, options.alpha, options.all):
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
        why_not = add_entry(strip, scene, label, rows, run, number, options.component)
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
    strip.entries.append(Entry(label, "\n".join(filter(None, below)), image, difference))
    if reference is None:
        why = f": {judge.path} {judge.why_not or 'has none'}" if judge else ""
        return f"no reference for the {COMPONENT_TITLES[component]}{why}, so no difference"
    return None


@dataclass(frozen=True)
class Layout:
    """Where things are, in inches from the upper left corner."""
    width: float
    height: float
    cell: float           # width of a picture
    cell_height: float
    top: float            # where pictures begin

    def add_axes(self, figure, column, row):
        x, y = MARGIN + column * (self.cell + GAP), self.top + row * (self.cell_height + ROW_GAP)
        axes = figure.add_axes([x / self.width, 1 - (y + self.cell_height) / self.height, self.cell / self.width,
                                self.cell_height / self.height])
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(True)
        return axes


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


def draw(title, strip, exposure, noise):
    """The figure: images above, differences below, the reference last with the colour bar under it."""
    style.use_for_pictures()
    columns = len(strip.entries) + (strip.reference is not None)
    width = max(style.FULL_WIDTH, columns * SMALLEST_CELL)
    cell = min((width - 2 * MARGIN) / columns - GAP, 2.6)
    picture_height, picture_width = strip.entries[0].image.shape[:2]
    cell_height = cell * picture_height / picture_width
    names = [textwrap.wrap(entry.label, max(12, int(cell * 14))) for entry in strip.entries]
    note = textwrap.wrap(note_of(strip, exposure, noise), int(104 * width / style.FULL_WIDTH))
    top = 0.3 + 0.15 * max(map(len, names))
    text, caption = 0.36, 0.12 + 0.13 * len(note)
    rows = 2 if strip.differences else 1
    height = top + rows * cell_height + text + (ROW_GAP if rows > 1 else 0) + caption

    figure, layout = style.pyplot.figure(figsize=(width, height)), Layout(width, height, cell, cell_height, top)
    largest = largest_difference(strip.differences)
    colours = style.pyplot.get_cmap(style.DIFFERENCE_COLOURS).copy()
    colours.set_bad("#ff00ff")
    mapped = None
    for column, (entry, name) in enumerate(zip(strip.entries, names)):
        axes = layout.add_axes(figure, column, 0)
        axes.imshow(pictures.to_srgb(entry.image, exposure))
        axes.set_title("\n".join(name), fontsize=8.5)
        if entry.difference is not None:
            axes = layout.add_axes(figure, column, 1)
            mapped = axes.imshow(entry.difference, cmap=colours, vmin=-largest, vmax=largest)
        axes.set_xlabel(entry.below, fontsize=8, labelpad=3)
    if strip.reference is not None:
        axes = layout.add_axes(figure, len(strip.entries), 0)
        axes.imshow(pictures.to_srgb(strip.reference, exposure))
        axes.set_title("reference", fontsize=8.5)
    if mapped is not None:
        add_colour_bar(figure, layout, strip, mapped, largest)
    figure.text(MARGIN / width, 1 - 0.05 / height, title, va="top", fontsize=9.5)
    figure.text(MARGIN / width, 0.05 / height, "\n".join(note), fontsize=7.5, color="#333333", linespacing=1.25)
    return figure


def add_colour_bar(figure, layout, strip, mapped, largest):
    """Under the reference: what the colours of differences mean."""
    x = MARGIN + len(strip.entries) * (layout.cell + GAP)
    y = layout.top + layout.cell_height + ROW_GAP
    heading = 0.25
    figure.text((x + 0.05) / layout.width, 1 - y / layout.height, "image − reference", fontsize=8, va="top")
    bar = figure.add_axes([(x + 0.05) / layout.width, 1 - (y + layout.cell_height) / layout.height, 0.12 / layout.width,
                           (layout.cell_height - heading) / layout.height])
    beyond = any((numpy.abs(difference) > largest).any() for difference in strip.differences)
    figure.colorbar(mapped, cax=bar, extend="both" if beyond else "neither", ticks=[-largest, 0, largest])
    limit = errors.two_digits(largest)
    bar.set_yticklabels([f"−{limit}", "0", f"+{limit}"], fontsize=8)
    bar.tick_params(length=2)


def make(results, options):
    for scene in results.scenes():
        strip = collect(scene, options)
        yield from strip.said
        if not strip.entries:
            yield f"{scene.scene}: nothing to show, so no strip"
            continue
        exposure = options.exposure or pictures.exposure_for(strip.entries[0].image if strip.reference is None else strip.reference)
        figure = draw(f"{scene.scene}: {COMPONENT_TITLES[options.component]}", strip, exposure, errors.noise_note(scene.rows))
        suffix = "" if options.component == "total" else f"-{options.component}"
        yield from save(figure, results, f"strip-{files.as_file_name(scene.scene)}{suffix}")


def add_options(parser):
    parser.add_argument("--pass", type=int, metavar="N",
                        help="pass to show (default: the last one that all methods have)")
    parser.add_argument("--seed", type=int, metavar="S", help="seed to show (default: each method's lowest)")
    parser.add_argument("--alpha", type=positive, nargs="+", default=[], metavar="A",
                        help="alphas to show of methods that have one (default: the lowest)")
    parser.add_argument("--all", action="store_true", help="show every method, not the first one of each kind")
    parser.add_argument("--component", choices=records.COMPONENTS, default="total",
                        help="what to show (default: total)")
    parser.add_argument("--exposure", type=positive, metavar="E",
                        help="factor on radiance in the pictures (default: 97%% of the lit pixels are below white)")


COMMAND = Command(
    name="strip", summary="PM, PPM and reference side by side, with their differences", about=__doc__,
    writes="figures/strip-SCENE.png and .pdf (strip-SCENE-COMPONENT for a single component)",
    make=make, is_for=pictures.has_snapshots, add_options=add_options)
