"""Makes the pictures of this page: /usr/bin/python3 docs/photon-mapping/make.py [PROGRAM [SCENE]]

One render, by PROGRAM (build/release/src/app/photonlab), writes everything that is drawn: images after 1, 10 and 100 passes with what
each pixel holds, and the photons of the first pass and the hit points as point clouds. Beside these files stands how each is read.
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy

PAGE = Path(__file__).resolve().parent
ROOT = PAGE.parents[1]
sys.path.insert(0, str(ROOT / "analysis"))    # not where the package is installed

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.colors import LogNorm

from photonlab.drawing import pictures
from photonlab.records import images

PASSES = [1, 10, 100]
RADIUS = 4.0             # cm, of the first pass: so wide that what it does can be seen
PLACE = 17.5, 17.0       # x and z of the disc that is shown: at the edge of the caustic
RENDER = ["--resolution", "512x512", "--passes", "100", "--photons", "60000", "--radius", f"{RADIUS:g}", "--area", "disc",
          "--statistics", "--estimate-error", "on", "--snapshots", "1,10,100", "--most-points", "1000000"]
LOOKS = {"font.size": 17, "figure.dpi": 100, "savefig.dpi": 100, "axes.titlesize": 19, "font.family": "DejaVu Sans"}
KINDS = {"float": "<f4", "uchar": "u1", "ushort": "<u2"}


def read_cloud(file):
    """The vertices of a binary PLY, by the names of their properties."""
    header, _, rest = file.read_bytes().partition(b"end_header\n")
    words = [line.split() for line in header.decode().splitlines()]
    kind = [(line[2], KINDS[line[1]]) for line in words if line[0] == "property"]
    return numpy.frombuffer(rest, kind)


def places_of(cloud):
    return numpy.stack([cloud["x"], cloud["y"], cloud["z"]], axis=1).astype(float)


def vector(text):
    return numpy.array([float(number) for number in text.split(",")])


class View:
    """A camera that looks at the room from outside, with perspective."""
    eye, target, width = numpy.array([300.0, 165.0, 190.0]), numpy.array([-2.0, 43.0, 42.0]), 0.87

    def __init__(self):
        self.forward = self.target - self.eye
        self.forward /= numpy.linalg.norm(self.forward)
        self.right = numpy.cross(self.forward, [0, 1, 0])
        self.right /= numpy.linalg.norm(self.right)
        self.up = numpy.cross(self.right, self.forward)

    def __call__(self, places):
        """x, y in the picture and the distance."""
        seen = numpy.asarray(places, float) - self.eye
        depth = seen @ self.forward
        return (seen @ self.right) / depth, (seen @ self.up) / depth, depth


def outside(title):
    figure = pyplot.figure(figsize=(16, 9), facecolor="white")
    axes = figure.add_axes([0, 0, 1, 1])
    axes.set_axis_off()
    axes.set_xlim(-View.width / 2, View.width / 2)
    axes.set_ylim(-View.width * 9 / 32 - 0.01, View.width * 9 / 32 - 0.01)
    axes.text(0.02, 0.955, title, transform=axes.transAxes, fontsize=24, va="top")
    return figure, axes


def scatter(axes, places, size, **looks):
    x, y, depth = View()(places)
    order = numpy.argsort(-depth)    # what is near covers what is behind it
    looks = {name: value[order] if isinstance(value, numpy.ndarray) else value for name, value in looks.items()}
    axes.scatter(x[order], y[order], s=size, linewidths=0, **looks)


def line(axes, places, **looks):
    x, y, _ = View()(places)
    axes.plot(x, y, **looks)


def draw_room(axes):
    """What there is, in outline."""
    for ends in [[(-60, 0, 60), (60, 0, 60), (60, 0, -60), (-60, 0, -60), (-60, 0, 60)],
                 [(60, 0, -60), (60, 90, -60), (-60, 90, -60), (-60, 90, 60), (-60, 0, 60)], [(-60, 0, -60), (-60, 90, -60)]]:
        line(axes, ends, color="#999999", lw=1.2, zorder=0)
    corners = numpy.array([[-10, 88, -18], [18, 88, -18], [18, 88, 10], [-10, 88, 10], [-10, 88, -18]])
    x, y, _ = View()(corners)
    axes.fill(x, y, color="#ffd97a", zorder=3)
    axes.text(x.mean(), y.max() + 0.008, "lamp", ha="center")
    turn = numpy.linspace(0, 2 * numpy.pi, 100)
    view = View()
    ring = numpy.array([16, 16.1, 8]) + 16 * (numpy.outer(numpy.cos(turn), view.right) + numpy.outer(numpy.sin(turn), view.up))
    line(axes, ring, color="#444444", lw=2, zorder=5)
    angle = numpy.radians(28)
    block = numpy.array([(x, y, z) for y in [0, 44] for x, z in [(-13, -13), (13, -13), (13, 13), (-13, 13)]], float)
    block[:, [0, 2]] = block[:, [0, 2]] @ [[numpy.cos(angle), -numpy.sin(angle)], [numpy.sin(angle), numpy.cos(angle)]] + [-26, -22]
    for corners in [[0, 1, 2, 3, 0], [4, 5, 6, 7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]:
        line(axes, block[corners], color="#999999", lw=1.2, zorder=0)


def camera_of(scene):
    look = next(ElementTree.parse(scene).getroot().iter("lookat"))
    return vector(look.get("origin"))


def draw_hit_points(points, image, eye):
    figure, axes = outside("1. Hit points: where the camera's rays meet what scatters light")
    kept = numpy.random.default_rng(1).permutation(len(points))[:40000]
    shown = points[kept]
    colours = pictures.to_srgb(image, 1.6)[shown["row"], shown["column"]]
    scatter(axes, places_of(shown), 5, c=colours)
    scatter(axes, places_of(shown[shown["edges"] > 1]), 5, color="#d9541e")
    x, y, _ = View()([eye])
    for place in places_of(points[points["edges"] == 1])[::len(points) // 24]:
        line(axes, [eye, place], color="black", lw=0.7, alpha=0.5, zorder=4)
    axes.plot(x, y, "s", color="black", ms=13, zorder=6)
    axes.text(x[0], y[0] - 0.022, "camera", ha="center")
    draw_room(axes)
    axes.text(0.02, 0.06, f"{len(points):,} hit points of {image.shape[1]} × {image.shape[0]} pixels; one in seven or eight is drawn.\n"
              "Orange: seen through the glass ball, or mirrored in it.", transform=axes.transAxes)
    return figure


def draw_photons(photons):
    figure, axes = outside("2. Photons: where light from the lamp arrives after at least one bounce")
    caustic = photons["caustic"] == 1
    scatter(axes, places_of(photons[~caustic]), 5, color="#27588f", alpha=0.55)
    scatter(axes, places_of(photons[caustic]), 6, color="#d9541e", alpha=0.8)
    draw_room(axes)
    axes.text(0.02, 0.06, f"{len(photons):,} photons of one pass of 60,000 light paths. Orange: {caustic.sum():,} that came by glass\n"
              "alone, the caustic. Light straight from the lamp is sampled instead, and stores none.", transform=axes.transAxes)
    return figure


def draw_disc(photons, last_radius):
    figure, axes = pyplot.subplots(figsize=(16, 9))
    figure.subplots_adjust(left=0.07, right=0.62, bottom=0.1, top=0.87)
    floor = photons[photons["y"] < 0.01]
    x, z = floor["x"].astype(float), floor["z"].astype(float)
    within = numpy.hypot(x - PLACE[0], z - PLACE[1]) < RADIUS
    caustic = floor["caustic"] == 1
    for kind, colour in [(~caustic, "#27588f"), (caustic, "#d9541e")]:
        axes.scatter(x[kind & ~within], z[kind & ~within], s=26, color=colour, alpha=0.35, linewidths=0)
        axes.scatter(x[kind & within], z[kind & within], s=60, color=colour, linewidths=0)
    axes.add_patch(pyplot.Circle(PLACE, RADIUS, fill=False, lw=3))
    axes.add_patch(pyplot.Circle(PLACE, last_radius, fill=False, lw=3, ls=(0, (3, 2))))
    axes.plot(*PLACE, "x", color="black", ms=14, mew=3)
    axes.set(xlim=(PLACE[0] - 13, PLACE[0] + 13), ylim=(PLACE[1] + 10, PLACE[1] - 10), aspect="equal", xlabel="x, cm", ylabel="z, cm")
    figure.text(0.02, 0.955, "3. One disc: photons around a hit point, on the floor seen from above", fontsize=24, va="top")
    figure.text(0.65, 0.5, f"{within.sum()} photons of the first pass lie\nwithin r = {RADIUS:g} cm (solid).\n\n"
                r"$L \approx \frac{1}{N\,\pi r^2}\;\sum\;f\,\Phi$" "\n\nTheir flux over the disc's area is the\nestimate: of a mean over the disc.\n"
                "That is the bias, largest where light\nhas an edge, as here.\n\n"
                f"After 100 passes the radius is {last_radius:.2f} cm\n(dashed), and what was gathered in all\nof them is one mean.", va="center")
    return figure


def draw_passes(found):
    figure, axes = pyplot.subplots(1, 3, figsize=(16, 6.4))
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.02, top=0.8, wspace=0.02)
    figure.text(0.01, 0.975, "4. Passes: new photons each, and discs that shrink", fontsize=24, va="top")
    for place, number in zip(axes, PASSES):
        place.imshow(pictures.to_srgb(found[number]["image"], 1.6))
        radius = found[number]["radius"]
        place.set_title(f"after {number} pass{'' if number == 1 else 'es'}: radius now {radius[radius > 0].mean():.2g} cm")
        place.set_axis_off()
    return figure


def draw_error(last):
    figure = pyplot.figure(figsize=(16, 6))
    figure.text(0.01, 0.975, "5. Where the error is, as the passes themselves tell it: after 100 of them", fontsize=24, va="top")
    def positive(values):
        return numpy.where(values > 0, values, numpy.nan)
    limit = numpy.percentile(numpy.abs(last["bias"]), 99)
    shown = [("radius, cm", positive(last["radius"]), {"cmap": "viridis"}),
             ("photons a cm²", positive(last["density"]), {"cmap": "magma", "norm": LogNorm()}),
             ("estimated bias", last["bias"], {"cmap": "RdBu_r", "vmin": -limit, "vmax": limit}),
             ("estimated noise", last["deviation"], {"cmap": "magma", "vmin": 0, "vmax": numpy.percentile(last["deviation"], 99)})]
    for column, (title, values, looks) in enumerate(shown):
        place = figure.add_axes([0.01 + 0.2475 * column, 0.17, 0.2375, 0.2375 * 16 / 6])
        drawn = place.imshow(values, **looks)
        place.set_title(title)
        place.set_axis_off()
        beside = figure.add_axes([0.03 + 0.2475 * column, 0.1, 0.1975, 0.03])
        bar = figure.colorbar(drawn, cax=beside, orientation="horizontal")
        bar.ax.tick_params(labelsize=13)
        if "norm" not in looks:
            bar.locator = matplotlib.ticker.MaxNLocator(4)
            bar.update_ticks()
    return figure


def read_image(file):
    names = ["radius", "count", "density"]
    found = dict(zip(names, numpy.moveaxis(images.read_channels(file, names), 2, 0)))
    found["image"] = images.read_component(file, "total")
    for name in ["bias", "deviation"]:
        found[name] = images.read_channels(file, [f"estimated_{name}.R"])[:, :, 0]
    return found


def main(program=ROOT / "build/release/src/app/photonlab", scene=ROOT / "src/app/study/scene.xml"):
    pyplot.rcParams.update(LOOKS)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        clouds = folder / "photons.ply", folder / "points.ply"
        subprocess.run([program, "render", scene, "-o", folder / "image.exr", *RENDER, "--photons-out", clouds[0],
                        "--hit-points-out", clouds[1]], check=True)
        photons, points = map(read_cloud, clouds)
        found = {number: read_image(folder / f"image-pass-{number}.exr") for number in PASSES}
    last = found[PASSES[-1]]
    at = numpy.argmin(numpy.hypot(points["x"] - PLACE[0], points["z"] - PLACE[1]) + 1e3 * (points["y"] > 0.01))
    last_radius = float(last["radius"][points["row"][at], points["column"][at]])
    for name, figure in [("hit-points", draw_hit_points(points, last["image"], camera_of(scene))), ("photons", draw_photons(photons)),
                         ("disc", draw_disc(photons, last_radius)), ("passes", draw_passes(found)), ("error", draw_error(last))]:
        figure.savefig(PAGE / f"{name}.png")


main(*sys.argv[1:])
