"""Folders that reports are made of."""

import numpy
from matplotlib import pyplot

from photonlab.drawing.saving import RECORDS
from photonlab.records import records
from support import synthetic
from support.images import layered, write_exr, write_runs

NASTY = 'box <img src=x onerror=alert(1)> & "q"'


def colour_of(channels, layer=""):
    return numpy.stack([channels[f"{layer}{channel}"] for channel in "RGB"], axis=2)


def make_results(results, scenes=("cornell-box",), passes=(1, 64), reference="reference/box", change=lambda row: None):
    """PM and PPM over two seeds; each scene's, method's and pass's image is another one. Returns the images of the
    least seeds by (scene, method, pass)."""
    made, shown = [], {}
    for place, scene in enumerate(scenes):
        for settings, mse in [(synthetic.PM_RADIUS, 4e-4), ({"alpha": "0.7"}, 1e-4)]:
            own = synthetic.rows(lambda seed, number, component: mse * (1 + seed) if component != "emission" else -1e-9,
                                 seeds=[1, 2], passes=[0, 1, 64], scene=scene, **settings)
            for row in own:
                row["run"] = f"{place}-{settings.get('integrator', 'ppm')}-seed-{row['seed']}"
                row.update(relmse="0.25", paths_emitted=str(50000 * int(row["pass"])), map_bytes=str(3 * 2 ** 20))
                change(row)
            made += own
            channels = {(run, number): layered(0.3 + 0.05 * place + 0.02 * len(own[0]["mode"]) + 0.1 / (1 + number) +
                                               0.03 * run.endswith("2"), 0.25)
                        for run in {row["run"] for row in own} for number in passes}
            write_runs(results, {row["run"] for row in own}, passes, lambda *place: channels[place], reference)
            shown |= {(scene, "PM, radius" if own[0]["mode"] else "PPM", number): colour_of(image)
                      for (run, number), image in channels.items() if run.endswith("1")}
    synthetic.write_csv(results, made)
    for half in ["half_a", "half_b"] if reference else []:
        write_exr(results / reference / f"{half}.exr", layered(0.4, 0.25))
    return shown


def write_figure(results, name, of=None):
    """A figure that says that it was made from the records which are there, or from others."""
    (results / "figures").mkdir(exist_ok=True)
    pyplot.imsave(results / "figures" / name, numpy.zeros((4, 4, 3)), metadata={RECORDS: of or records.read(results).hash})


def write_derived(results, name, text):
    """A CSV that says the same."""
    header, *lines = text.strip().split("\n")
    (results / name).write_text("\n".join([f"{header},records", *(f"{line},{records.read(results).hash}" for line in lines)]) + "\n")
