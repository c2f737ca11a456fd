"""Methods compared by pictures that have something in common: a budget of seconds, or an error. Under each stand insets, and the pass,
the time and the error that this very picture has."""

import math

import numpy

from photonlab.command import rectangle
from photonlab.drawing import cells, pictures
from photonlab.drawing.cells import FRAMES, Cell, Tile
from photonlab.records import images, records, references
from photonlab.records.files import InputError
from photonlab.statistics import errors
from photonlab.statistics.equal_time import regions_of

SIDE = 0.2    # of an inset that is chosen here, in widths of the picture


def shots_of(scene, label, component, seed=None):
    """{pass: (its row of the records, a table of one; file)} of a method's snapshots: of a seed, or its lowest."""
    rows = scene.of_method(label)
    rows = rows[(rows["seed"] == (rows["seed"].min() if seed is None else seed)) & (rows["component"] == component)]
    rows = rows[rows["seconds"] > 0]
    return {number: (rows[rows["pass"] == number], file) for number, file in scene.run(rows["run"].iloc[0]).snapshots.items()
            if (rows["pass"] == number).any()} if not rows.empty else {}


def nearest(shots, value_of, target):
    """The shot whose value is nearest to the target on a logarithmic axis; None where no value is above 0."""
    known = {number: value_of(row) for number, (row, _) in shots.items()}
    known = {number: value for number, value in known.items() if value > 0}
    return shots[min(known, key=lambda number: abs(math.log(known[number] / target)))] if known else None


def distance_text(chosen, value_of, target):
    """How far the shots that were chosen, {label: shot}, are from the target, as a sentence; "" where they are within a tenth."""
    farthest = max((abs(math.log(value_of(row) / target)) for row, _ in chosen.values()), default=0.0)
    return "" if farthest < math.log(1.1) else f" Recorded pictures are up to a factor of {math.exp(farthest):.2g} away from it."


def error_of(row):
    """RMSE of a row of the records."""
    return errors.root(row[errors.error_column(row)].iloc[0])


def seconds_of(row):
    return row["seconds"].iloc[0]


def place_of_inset(reference, is_light, side):
    """Top left corner (y, x) of the square of `side` pixels with the most contrast, without a light in it."""
    luminance = numpy.log1p(reference.mean(axis=2))
    best, corner = -1.0, (0, 0)
    for y in range(0, luminance.shape[0] - side + 1, max(1, side // 4)):
        for x in range(0, luminance.shape[1] - side + 1, max(1, side // 4)):
            spread = luminance[y:y + side, x:x + side].std()
            if spread > best and not is_light[y:y + side, x:x + side].any():
                best, corner = spread, (y, x)
    return corner


def insets_of(scene, reference, is_light, asked):
    """[(left, top, right, bottom)]: those that are asked for, the scene's regions, or the square with the most contrast."""
    height, width = reference.shape[:2]
    if asked:
        for x, y, across, down in asked:
            if x + across > width or y + down > height:
                raise InputError(f"--inset {x},{y},{across},{down}: expected pixels inside the {width}x{height} of {scene.scene}")
        return [(x, y, x + across, y + down) for x, y, across, down in asked]
    regions = [place for place in regions_of(scene, scene.scene).values() if place[2] <= width and place[3] <= height]
    if regions:
        return regions[:len(FRAMES)]
    side = max(4, round(SIDE * width))
    y, x = place_of_inset(reference, is_light, side)
    return [(x, y, x + side, y + side)]


def cell_of(title, image, insets, scale, inset_scales, below):
    """A picture over its insets, each exposed for itself."""
    picture = Tile(pictures.to_srgb(image, scale), marked=list(zip(insets, FRAMES)))
    details = [Tile(pictures.to_srgb(image[top:bottom, left:right], own), frame=frame)
               for (left, top, right, bottom), own, frame in zip(insets, inset_scales, FRAMES)]
    return Cell(title, [[picture], details], below)


def texts_of(row):
    """What is said of a picture: its pass, its time and its error."""
    return [f"pass {row['pass'].iloc[0]:.0f}, {errors.two_digits(seconds_of(row))} s", *filter(None, [pictures.error_text(row)])]


def draw(scene, title, note, chosen, component="total", insets=()):
    """The figure of the records of one scene: the pictures in `chosen`, {label: (row, file)}, and the reference; None without a picture
    or a reference."""
    if not chosen:
        return None
    first, first_file = next(iter(chosen.values()))
    judge, reference = references.read_reference_of(scene, scene.run(first["run"].iloc[0]), component,
                                                    first["direct"].iloc[0] == "photons")
    if reference is None:
        return None
    found = {}
    for label, (row, file) in chosen.items():
        image = images.read_component(file, component)
        if image is not None:
            images.require_same_size(file, image, judge.halves[0], reference)
            found[label] = image
    emission = images.read_component(first_file, "emission")
    is_light = numpy.zeros(reference.shape[:2], bool) if emission is None else emission.max(axis=2) > 0
    lit = reference * ~is_light[:, :, None]
    insets = insets_of(scene, reference, is_light, insets)
    scale = pictures.exposure_for(lit)
    inset_scales = [pictures.exposure_for(lit[top:bottom, left:right]) for left, top, right, bottom in insets]
    shown = [cell_of(label, image, insets, scale, inset_scales, texts_of(chosen[label][0]))
             for label, image in found.items()]
    shown.append(cell_of("reference", reference, insets, scale, inset_scales, []))
    figure, _ = cells.draw_cells(shown, title, f"{note} Insets are exposed for themselves. {errors.noise_note(scene.rows)}".rstrip())
    return figure


def ending_of(component):
    """What the name of a file says of its component."""
    return "" if component == "total" else f"-{component}"


def add_options(parser):
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=["total"], help="which light, a figure each "
                        "(default: total)")
    parser.add_argument("--inset", type=rectangle, action="append", default=[], metavar="x,y,w,h", help="a part to be shown larger, in "
                        "pixels; as often as wanted")
    parser.add_argument("--seed", type=int, metavar="S", help="seed to show (default: each method's lowest)")
