"""Compares methods at the same error: of each the recorded picture whose RMSE is nearest to it, with insets; under each stand the pass,
the time and the error that this picture has.

The error is the least that all methods reach, or that of --at. A method whose errors are all larger is shown at its best, which the
text under it says; so does the caption, where pictures are more than a tenth away.
"""

from photonlab.command import Command, positive
from photonlab.drawing import compared, style
from photonlab.drawing.pictures import has_snapshots
from photonlab.drawing.saving import Drawn
from photonlab.records import files
from photonlab.statistics.errors import two_digits


def common_error(shots):
    """The least RMSE that all methods reach, of {label: shots}; None where one has no error."""
    least = [min((error for row, _ in of_method.values() if (error := compared.error_of(row)) > 0), default=None)
             for of_method in shots.values()]
    return None if not least or None in least else max(least)


def draw(scene, rmse=None, component="total", insets=(), seed=None, **look):
    """The figure of the records of one scene: pictures of this RMSE, with insets, [(x, y, width, height)]; None without snapshots or a
    reference, or where methods have no errors in common."""
    if not all(map(scene.has_run, scene.rows["run"].unique())):
        return None
    shots = {label: own for label in scene.labels if (own := compared.shots_of(scene, label, component, seed))}
    rmse = rmse or common_error(shots)
    return None if rmse is None else draw_at(scene, shots, rmse, component, insets, seed, **look)


@style.drawn_of_pictures
def draw_at(scene, shots, rmse, component, insets, seed):
    chosen = {label: shot for label, own in shots.items() if (shot := compared.nearest(own, compared.error_of, rmse))}
    note = f"The recorded picture whose RMSE is nearest to {two_digits(rmse)}, of " \
        f"{'the lowest seed' if seed is None else f'seed {seed}'}.{compared.distance_text(chosen, compared.error_of, rmse)}"
    return compared.draw(scene, f"{scene.scene}: equal error, RMSE {two_digits(rmse)}", note, chosen, component,
                         insets)


def make(results, options):
    for scene in results.scenes():
        for component in options.components:
            figure = draw(scene, options.at, component, options.inset, options.seed, **options.look)
            if figure is None:
                yield f"{scene.scene}: no snapshots with errors, so no pictures of equal error"
            else:
                yield Drawn(f"equal-error-{files.as_file_name(scene.scene)}{compared.ending_of(component)}", figure)


def add_options(parser):
    parser.add_argument("--at", type=positive, metavar="RMSE", help="the error of the pictures (default: the least that all reach)")
    compared.add_options(parser)


COMMAND = Command(
    name="equal_error", draws=True, summary="pictures of the same error with insets, and what they took", about=__doc__,
    writes="figures/equal-error-SCENE, .png and .pdf",
    make=make, is_for=has_snapshots, add_options=add_options)
