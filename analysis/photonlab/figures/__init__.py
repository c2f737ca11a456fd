"""One file a figure, those of errors and those with pictures in folders of their own: draw() takes records and returns it, and COMMAND
makes a command of it. This is the list of them, in the order in which all are drawn."""

from photonlab.command import options_of
from photonlab.drawing.saving import Drawn
from photonlab.figures import deviations, extremes, memory, probes, relaxation, scaling
from photonlab.figures.errors import (best_alpha, bias_variance, calibration, convergence, equal_time, light_paths, methods, regions, spectrum,
                                      time_to_error, tradeoff)
from photonlab.figures.pictures import emission, equal_error, gallery, grid, radii, strip
from photonlab.records.files import InputError

MODULES = [convergence, strip, gallery, bias_variance, spectrum, memory, best_alpha, methods, regions, radii, calibration, light_paths, emission,
           grid, equal_time, equal_error, time_to_error, tradeoff, probes, scaling, extremes, deviations, relaxation]


def of(kind, results, *, width=None, style=None, scenes=None, methods=None, **options):
    """{name: figure} of records, as `analysis KIND` makes them: `options` are those of its command line, with underscores. Nothing is
    written. `width` is in millimetres; `style` is a matplotlib style file."""
    commands = {module.COMMAND.name: module.COMMAND for module in MODULES}
    if kind not in commands:
        raise InputError(f"{kind}: expected one of {', '.join(commands)}")
    chosen = options_of(commands[kind], [str(results.folder)])
    unknown = set(options) - set(vars(chosen))
    if unknown:
        raise InputError(f"{kind} has no option {min(unknown)}; it has {', '.join(vars(chosen))}")
    vars(chosen).update(options, look={"width": width, "style": style})
    if scenes or methods:
        results = results.only(scenes, methods)
    made = commands[kind].make(results, chosen)
    return {said.name: said.figure for said in made if isinstance(said, Drawn)}
