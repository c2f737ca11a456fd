"""Draws how variance, squared bias and MSE fall with the passes, with the photons or with the seconds, a figure per scene: a
row for the whole image and for each named region, a line per method. `photonlab analyse decomposition` writes
decomposition.csv, which is read here.

Bands are 1.96 standard errors to both sides: 95% where errors are Gaussian. Thin lines are what theory predicts for these passes
(theory.py), through the measured value at the window's first pass: dotted where light is smooth, dashed at edges. What is not above
two standard errors is not resolved: a logarithmic axis could only show the half of it that came out high, so it is marked at the
bottom.

Where the reference has it, gathered light is drawn, which is what theory is about; otherwise the whole picture. Seconds are
those of all light, and means over seeds.
"""

from dataclasses import dataclass

import numpy
from matplotlib import lines
from matplotlib.transforms import blended_transform_factory

from photonlab.command import Command, has
from photonlab.drawing import style
from photonlab.drawing.panels import name_row, panels_over_legend, set_titles
from photonlab.drawing.places import AXES
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.records import methods, records
from photonlab.records.files import InputError
from photonlab.statistics import decomposition, slopes, theory

TITLES = {"variance": "variance", "squared_bias": "squared bias", "mse": "MSE"}
ROOT_TITLES = {"variance": "√ variance", "squared_bias": "√ squared bias", "mse": "RMSE"}
BAND = 1.96    # standard errors
THEORY_LINES = {"squared_bias": {"linewidth": 0.7, "linestyle": (0, (1, 1.5)), "zorder": 1.5},
                "edge": {"linewidth": 0.7, "linestyle": (0, (6, 3)), "zorder": 1.5}}    # by what squared bias is predicted to be


def component_to_draw(rows):
    """Gathered light, where something is known of its bias at all points or at none."""
    known = rows.groupby("component")["mse"].count()
    return "gathered" if known.get("gathered", 0) >= known["total"] * 0.999 else "total"


def curve_of(rows, quantity, against="passes"):
    """(places, values, errors, resolved) of one point and region. What emits no photons has no place against them."""
    rows = rows[rows[quantity].notna() & rows[list(AXES[against].columns)].notna().all(axis=1)].sort_values("pass")
    values, errors = rows[quantity].to_numpy(), rows[f"{quantity}_error"].to_numpy()
    return AXES[against].of(rows), values, errors, values > slopes.RESOLVED * numpy.nan_to_num(errors)


def places_of(rows, passes, against):
    """Where passes are on the axis, by straight lines on logarithmic axes between the recorded ones in `rows`."""
    known = rows.drop_duplicates("pass").sort_values("pass")
    places = AXES[against].of(known)
    if not len(passes) or numpy.isnan(places).any():
        return passes
    return numpy.exp(numpy.interp(numpy.log(passes), numpy.log(known["pass"]), numpy.log(places)))


def theory_of(recorded_rows, rows, component, region):
    """(passes, {quantity: {kind: values}}) that theory predicts over the window, kinds as in THEORY_LINES; `rows` are a point's
    of decomposition.csv."""
    first, last = slopes.default_window(rows["pass"].astype(int))
    predicted = theory.predictions(recorded_rows, component, last)
    at_first = rows[(rows["pass"] == first) & (rows["region"] == region) & (rows["component"] == component)]
    # Of the whole picture with direct light by shadow rays it is a sum, which `photonlab analyse fits` predicts and this does not draw.
    is_mixed = component == "total" and (rows["component"] == "direct").any()
    if not predicted or at_first.empty or is_mixed:
        return [], {}
    measured = at_first.iloc[0]
    passes = numpy.arange(first, last + 1)

    def through_measured(quantity, shape):
        # A line through a value that is not resolved would start anywhere.
        if shape is None or not measured[quantity] > slopes.RESOLVED * measured[f"{quantity}_error"]:
            return None
        return measured[quantity] * shape[passes - 1] / shape[first - 1]

    variance = through_measured("variance", predicted["variance"])
    values = {"variance": {} if variance is None else {"squared_bias": variance}, "squared_bias": {}, "mse": {}}
    for kind in THEORY_LINES:
        squared = through_measured("squared_bias", predicted.get(kind))
        if squared is not None:
            values["squared_bias"][kind] = squared
            if variance is not None:
                values["mse"][kind] = variance + squared
    return passes, values


def draw_panel(axes, curves, theories, styles, limits, shape):
    """One region and quantity; `curves` and `theories` are by label. `shape` is what values go through before they are drawn:
    the root, or nothing. `limits` are of values that have gone through it."""
    at_bottom = blended_transform_factory(axes.transData, axes.transAxes)
    methods_below = 0    # each has a row of marks of its own
    for label, (places, values, errors, resolved) in curves.items():
        look = styles[label]
        shown = shape(numpy.where(resolved, values, numpy.nan))
        low = numpy.maximum(shape(numpy.maximum(values - BAND * errors, 0)), limits[0])
        axes.fill_between(places, low, shape(numpy.maximum(values + BAND * errors, 0)), where=resolved & numpy.isfinite(errors),
                          color=look["color"], alpha=0.2, linewidth=0)
        axes.plot(places, shown, label=label, markevery=style.marked_places(list(places)), **look)
        if not resolved.all():
            axes.plot(places[~resolved], [0.03 + 0.045 * methods_below] * int((~resolved).sum()), transform=at_bottom,
                      color=look["color"], **style.BELOW_MARK)
            methods_below += 1
    for label, (places, kinds) in theories.items():
        for kind, values in kinds.items():
            axes.plot(places, shape(values), color=styles[label]["color"], **THEORY_LINES[kind])
    style.logarithmic(axes.yaxis, *limits)


def vertical_range(curves, shape):
    """Limits of a row's axis: every resolved value of its panels, and room for marks below."""
    seen = [value for _, values, _, resolved in curves for value in shape(values[resolved])]
    if not seen:
        return None
    low, high = min(seen), max(seen)
    margin = max((high / low) ** 0.06, 1.2)
    any_below = any(not resolved.all() for *_, resolved in curves)
    return low / margin ** (3 if any_below else 1), high * margin


def notes(rows, component, any_theory, against):
    """What a reader has to know to read the figure, in one paragraph."""
    seeds, groups = rows["seeds"].min(), rows["groups"].min()
    text = [f"{style.LIGHT_TITLES[component].capitalize()}, {seeds:.0f} seeds in {groups:.0f} groups; per pixel and channel, "
            "of one seed's image. Band: 1.96 standard errors (jackknife over groups)."]
    if any_theory:
        text.append("Thin lines: predicted for these passes, through the measured value at the window's first.")
    if rows["mse"].notna().any() and (rows["reference_floor"] == "").any():
        text.append("The reference has no second half: its own noise is in squared bias and MSE.")
    elif rows["mse"].notna().any():
        text.append("All without the reference's noise.")
    if (rows["direct"] == "photons").any():
        text.append("Photons carry direct light.")
    if against == "photons" and rows["paths_emitted"].isna().any():
        text.append("A method that emits none is left out.")
    return " ".join(text)


@dataclass
class Row:
    """What a row of the figure shows of a region."""
    region: str
    curves: dict      # {quantity: {label: curve}}
    theories: dict    # {quantity: {label: (places, {kind: values})}}
    limits: tuple     # of the vertical axis

    def all_curves(self):
        return [curve for of_quantity in self.curves.values() for curve in of_quantity.values()]


def row_of(scene, rows, component, region, against, shape):
    """A row of the figure; None when nothing in it is resolved. `rows` are those of decomposition.csv."""
    points = scene.rows["run"].map(methods.point_of)
    label_of = dict(zip(points, scene.rows["method"]))
    curves, theories = ({quantity: {} for quantity in TITLES} for _ in range(2))
    for point in sorted(set(rows["point"]), key=lambda point: scene.labels.index(label_of[point])):
        label, of_point = label_of[point], rows[rows["point"] == point]
        drawn = of_point[(of_point["component"] == component) & (of_point["region"] == region)]
        passes, predicted = theory_of(scene.rows[points == point], of_point, component, region)
        for quantity in TITLES:
            curve = curve_of(drawn, quantity, against)
            if len(curve[0]):
                curves[quantity][label] = curve
                if predicted.get(quantity):
                    theories[quantity][label] = (places_of(of_point, passes, against), predicted[quantity])
    row = Row(region, curves, theories, None)
    row.limits = vertical_range(row.all_curves(), shape)
    return row if row.limits else None


def handles_of(scene, shown, styles):
    """The legend of the rows that are shown."""
    labels = {label for row in shown for of_quantity in row.curves.values() for label in of_quantity}
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in scene.labels if label in labels]
    if any(of_quantity for row in shown for of_quantity in row.theories.values()):
        handles += [lines.Line2D([], [], label=label, color="#555555", **THEORY_LINES[kind])
                    for kind, label in [("squared_bias", "theory, smooth"), ("edge", "theory, at edges")]]
    if any(not resolved.all() for row in shown for *_, resolved in row.all_curves()):
        handles.append(lines.Line2D([], [], label="below resolution", color="#555555", **style.BELOW_MARK))
    return handles


@style.drawn
def draw(scene, rows, against="passes", roots=False, component=None):
    """The figure of the records of one scene and its rows of decomposition.csv; None when nothing in it is resolved. Without a
    component it is of the gathered light, where that is known."""
    titles, shape, unit = (ROOT_TITLES, numpy.sqrt, "radiance") if roots else (TITLES, lambda values: values, "radiance²")
    styles, component = style.method_styles(scene), component or component_to_draw(rows)
    rows = rows[rows["pass"] > 0]    # a logarithmic axis has no place for it
    shown = [row_of(scene, rows, component, region, against, shape) for region in rows["region"].drop_duplicates()]
    shown = [row for row in shown if row]
    if not shown:
        return None
    places = [place for row in shown for curve in row.all_curves() for place in curve[0]]
    any_theory = any(of_quantity for row in shown for of_quantity in row.theories.values())
    caption = notes(rows[rows["component"] == component], component, any_theory, against)
    figure, grid = panels_over_legend(len(shown), len(TITLES), handles_of(scene, shown, styles), caption)
    scene_name = rows["scene"].iloc[0]
    for row, panels in zip(shown, grid):
        for axes, (quantity, title) in zip(panels, titles.items()):
            draw_panel(axes, row.curves[quantity], row.theories[quantity], styles, row.limits, shape)
            style.logarithmic(axes.xaxis, min(places) / 1.15, max(2 * min(places), *places) * 1.15,
                              base_two=against == "passes", most=4)
            set_titles(axes, scene_name if axes is grid[0][0] else "", title)
            axes.set_xlabel(AXES[against].title)
        name_row(panels, f"{row.region} ({unit})")
    figure.align_ylabels()
    return figure


def make(results, options):
    rows = decomposition.read_decomposition(results)
    points = set(results.rows["run"].map(methods.point_of))
    rows = rows[rows["point"].isin(points)] if results.is_part else rows
    unknown = set(rows["point"]) - points
    if unknown:
        raise InputError(f"{results.folder / decomposition.NAME}: {min(unknown)} is not in iterations.csv; run "
                         "`photonlab analyse decomposition` again")
    of_scene = {scene.scene: scene for scene in results.scenes()}
    extra = ("-roots" if options.roots else "") + (f"-{options.against}" if options.against != "passes" else "")
    for component in options.components:
        figures = ((name, draw(of_scene[name], own, options.against, options.roots, component, **options.look))
                   for name, own in rows.groupby("scene", sort=False))
        yield from drawn_of_scenes("bias-variance", figures, "nothing is resolved, so there is nothing to draw",
                                   extra + (f"-{component}" if component else ""))


def add_options(parser):
    parser.add_argument("--components", choices=records.COMPONENTS, nargs="+", default=[None], help="which light, a figure each "
                        "(default: gathered, where the reference has it)")
    parser.add_argument("--against", choices=[name for name in AXES if name not in ["cpu_seconds", "memory"]], default="passes",
                        help="the horizontal axis (default: passes); photons are the light paths emitted")
    parser.add_argument("--roots", action="store_true", help="draw RMSE and the roots of variance and squared bias, in radiance")


COMMAND = Command(
    name="bias_variance", draws=True, summary="the figure of decomposition.csv", about=__doc__,
    writes="figures/bias-variance-SCENE.png and .pdf; what is not drawn by default is in the name: bias-variance-SCENE-roots-seconds",
    make=make, is_for=has(decomposition.NAME), add_options=add_options)
