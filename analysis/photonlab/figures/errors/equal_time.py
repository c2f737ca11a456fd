"""Compares methods at the same seconds: a table of errors, and pictures with insets at one budget.

Nothing is stopped by the clock: a method's error at a budget is interpolated between its recorded passes, on logarithmic
axes, where curves are nearly straight. Errors are means over seeds of the unbiased MSE, seconds the means of the
records, which hold passes alone. Nothing is extrapolated: a budget before a method's first pass or after its last has no error,
and the table says which ("less than one pass", "more than recorded"). "not resolved" is an error that came out at 0 or below.

The table has the whole image, and where decomposition.csv is there (`photonlab analyse decomposition`) also the experiment's named regions. The
pictures are those of the recorded pass that is nearest to the budget, of one seed; under each stand the pass, the time and the error
that this picture has. Below them are the regions, or without any the square with the most contrast, or those of --inset, each exposed
for itself.

Budgets are powers of two of a second that at least one method reaches; the pictures are of the last that all reach, or of --at.
"""

from photonlab.command import Command, positive
from photonlab.drawing import compared, style
from photonlab.drawing.saving import Drawn
from photonlab.records import files, tables
from photonlab.statistics.equal_time import COLUMNS, NAME, curves_of, read_split, table_of


@style.drawn_of_pictures
def draw(scene, seconds, component="total", insets=(), seed=None):
    """The figure of the records of one scene: pictures near so many seconds, with insets, [(x, y, width, height)]; None without
    snapshots or a reference."""
    if not all(map(scene.has_run, scene.rows["run"].unique())):
        return None
    chosen = {label: shot for label in scene.labels
              if (shot := compared.nearest(compared.shots_of(scene, label, component, seed), compared.seconds_of, seconds))}
    note = f"The recorded picture that is nearest to {seconds:g} s, of {'the lowest seed' if seed is None else f'seed {seed}'}." \
        f"{compared.distance_text(chosen, compared.seconds_of, seconds)}"
    return compared.draw(scene, f"{scene.scene}: equal time, {seconds:g} s", note, chosen, component, insets)


def make(results, options):
    split, table = read_split(results), []
    for scene in results.scenes():
        name = scene.scene
        if scene.rows["mse"].isna().all():
            yield f"{name}: no errors were recorded (was there a reference?), so no comparison"
            continue
        of_scene, seconds = table_of(name, curves_of(scene, None if split is None else split[split["scene"] == name]))
        table += of_scene
        if options.at is None and seconds is None:
            yield f"{name}: no time that all methods reach, so no pictures"
            continue
        for component in options.components:
            figure = draw(scene, options.at or seconds, component, options.inset, options.seed, **options.look)
            if figure is None:
                yield f"{name}: no snapshots, so no pictures"
            else:
                yield Drawn(f"equal-time-{files.as_file_name(name)}{compared.ending_of(component)}", figure)
    yield tables.Derived(NAME, COLUMNS, table)


def add_options(parser):
    parser.add_argument("--at", type=positive, metavar="S", help="the seconds of the pictures (default: the last that all reach)")
    compared.add_options(parser)


COMMAND = Command(
    name="equal_time", draws=True, summary="errors at the same seconds, with pictures and insets", about=__doc__,
    writes="equal-time.csv and figures/equal-time-SCENE, .png and .pdf",
    make=make, add_options=add_options)
