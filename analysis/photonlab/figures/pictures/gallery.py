"""Draws what methods make of scenes as passes go by: a column a recorded pass, two rows a scene (PPM above, PM at the same
photons below), the reference at the right, and under each picture its RMSE and the seconds that it took.

Pass 0 is emission and direct light alone, before the first photon. The RMSE is free of the reference's noise where the
reference has two halves; the seconds are those of the passes, as in the records.
"""

from dataclasses import dataclass, field

import numpy

from photonlab.command import Command, positive
from photonlab.drawing import pictures, style, text
from photonlab.drawing.saving import Drawn
from photonlab.records import images, references
from photonlab.records.files import InputError
from photonlab.statistics import errors

CELL = 1.5              # inches
GAP = 0.05
TEXT = 0.2              # under each picture
TOP, SCENE_GAP = 0.3, 0.12
SMALL = 7.5             # points


def methods_of(scene):
    """Labels of a scene's methods: integrators in the reverse order of legends, the progressive method above its baseline."""
    first_rows = scene.rows.drop_duplicates("method").set_index("method")
    column = scene.columns["integrator"]
    return sorted(scene.labels, key=lambda label: -style.place_of(first_rows.loc[label]["integrator"], column))


@dataclass
class SceneRow:
    """What the gallery has of a scene."""
    scene: str
    methods: list = field(default_factory=list)    # [(label, {pass: (image, caption)})] of their lowest seeds
    reference: numpy.ndarray = None
    exposure: float = None
    said: list = field(default_factory=list)       # what is left out


def collect(scene):
    found = SceneRow(scene.scene)
    for label in methods_of(scene):
        of_method = scene.of_method(label)
        of_run = of_method[of_method["seed"] == of_method["seed"].min()]
        run = of_run["run"].iloc[0]
        total = of_run[of_run["component"] == "total"]
        shown, by_pass = {}, scene.run(run).snapshots
        for number, file in by_pass.items():
            of_pass = total[total["pass"] == number]
            if not of_pass.empty:
                shown[number] = (images.read_component(file, "total"), pictures.caption(of_pass))
        if shown:
            found.methods.append((label, shown))
        else:
            found.said.append(f"{scene.scene}: {label}: no snapshots, so not in the gallery")
        if found.reference is None and shown:
            judge, found.reference = references.read_reference_of(scene, scene.run(run))
            if found.reference is not None:
                snapshot = next(iter(by_pass.values()))
                images.require_same_size(snapshot, next(iter(shown.values()))[0], judge.halves[0], found.reference)
                found.exposure = pictures.exposure_for(pictures.lit_by_scene(found.reference, snapshot))
    if found.methods and found.exposure is None:
        found.exposure = pictures.exposure_for(list(found.methods[0][1].values())[-1][0])
    return found


@style.drawn_of_pictures
def draw(scenes, given_exposure, note):
    """The figure of scenes' rows, with a note in small print below."""
    passes = sorted({number for scene in scenes for _, shown in scene.methods for number in shown})
    has_reference = any(scene.reference is not None for scene in scenes)
    columns = len(passes) + has_reference
    names = {(scene.scene, label): [*text.wrapped(scene.scene, CELL + TEXT, SMALL), *text.wrapped(label, CELL + TEXT, SMALL)]
             for scene in scenes for label, _ in scene.methods}
    left = 0.1 + max(text.height_of(lines, SMALL) for lines in names.values())
    width = left + columns * (CELL + GAP)
    rows = sum(len(scene.methods) for scene in scenes)
    height = TOP + rows * (CELL + TEXT) + len(scenes) * SCENE_GAP + (TEXT if note else 0)
    figure = style.pyplot.figure(figsize=(width, height))

    def add_picture(image, x, y, scale):
        axes = figure.add_axes([x / width, 1 - (y + CELL) / height, CELL / width, CELL / height])
        axes.imshow(pictures.to_srgb(image, scale))
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(True)
        return axes

    for column, name in enumerate([f"pass {number}" for number in passes] + ["reference"] * has_reference):
        figure.text((left + column * (CELL + GAP) + CELL / 2) / width, 1 - 0.2 / height, name, ha="center", fontsize=9)
    y = TOP
    for scene in scenes:
        scale = given_exposure or scene.exposure
        for row, (label, shown) in enumerate(scene.methods):
            figure.text((left - 0.04) / width, 1 - (y + CELL / 2) / height, "\n".join(names[scene.scene, label]), rotation=90,
                        ha="right", va="center", multialignment="center", fontsize=SMALL, linespacing=text.LINE_HEIGHT)
            for column, number in enumerate(passes):
                if number not in shown:
                    continue
                image, said = shown[number]
                axes = add_picture(image, left + column * (CELL + GAP), y, scale)
                axes.set_xlabel(said, fontsize=7, labelpad=2)
            if scene.reference is not None and row == 0:
                add_picture(scene.reference, left + len(passes) * (CELL + GAP), y, scale)
            y += CELL + TEXT
        y += SCENE_GAP
    style.add_caption(figure, [note], left, 0.16)
    return figure


def make(results, options):
    scenes = [collect(scene) for scene in results.scenes()]
    yield from [said for scene in scenes for said in scene.said]
    scenes = [scene for scene in scenes if scene.methods]
    if not scenes:
        raise InputError(f"{results.folder}: no snapshots; expected some in the experiment file")
    yield Drawn("gallery", draw(scenes, options.exposure, errors.noise_note(results.rows), **options.look))


def add_options(parser):
    parser.add_argument("--exposure", type=positive, metavar="E",
                        help="factor on radiance (default: for each scene, 97%% of what its lights light is below white)")


COMMAND = Command(
    name="gallery", draws=True, summary="scenes by recorded passes, PPM above PM", about=__doc__,
    writes="figures/gallery.png and .pdf",
    make=make, is_for=pictures.has_snapshots, add_options=add_options)
