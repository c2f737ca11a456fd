"""Draws how variance, squared bias and MSE fall with the passes, with the photons or with the seconds, a figure per scene: a
row for the whole image and for each named region, a line per method. Read by it, RESULTS_DIR/decomposition.csv, is written by
decomposition.py.

Bands are 1.96 standard errors to both sides: 95% where errors are Gaussian. Thin lines are what theory predicts for these passes
(fits.py), through the measured value at the window's first pass: dotted where light is smooth, dashed at edges. What is not above two standard errors
is not resolved: a logarithmic axis could only show the half of it that came out high, so it is marked at the bottom.

Where the reference has it, gathered light is drawn, which is what theory is about; otherwise the whole picture. Seconds are
those of all light, and means over seeds.
"""

import argparse
import sys
from pathlib import Path

try:
    import decomposition
    import files
    import fits
    import numpy
    import records
    import style
    import tables
    from convergence import BELOW_MARK
    from files import InputError
    from matplotlib import lines
    from matplotlib.transforms import blended_transform_factory
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)",
          file=sys.stderr)
    sys.exit(2)

TITLES = {"variance": "variance", "squared_bias": "squared bias", "mse": "MSE"}
ROOT_TITLES = {"variance": "√ variance", "squared_bias": "√ squared bias", "mse": "RMSE"}
AXES = {"passes": ("pass", "pass"), "photons": ("paths_emitted", "light paths emitted"),
        "seconds": ("seconds", "time of all passes so far (s)")}    # column and title by what is drawn against
COMPONENT_TITLES = {"gathered": "gathered light", "total": "whole picture"}
BAND = 1.96    # standard errors
THEORY_LINES = {"squared_bias": {"linewidth": 0.7, "linestyle": (0, (1, 1.5)), "zorder": 1.5},
                "edge": {"linewidth": 0.7, "linestyle": (0, (6, 3)), "zorder": 1.5}}    # by what squared bias is predicted to be


def read_decomposition(results):
    """Rows of RESULTS/decomposition.csv with estimates and errors as numbers, NaN where there are none."""
    file = results.folder / "decomposition.csv"
    numbers = ["pass", "seeds", "groups", "paths_emitted", "seconds", *(column for quantity in TITLES for column in [quantity, f"{quantity}_error"])]
    rows = tables.read_derived(results, file.name, ["scene", "point", "component", "region", *numbers], "decomposition.py")
    for column in numbers:
        rows[column] = tables.to_numbers(file, rows[column], whole=column in ["pass", "seeds", "groups"])
    return rows


def component_to_draw(rows):
    """Gathered light, where something is known of its bias at all points or at none."""
    known = rows.groupby("component")["mse"].count()
    return "gathered" if known.get("gathered", 0) >= known["total"] * 0.999 else "total"


def curve_of(rows, quantity, against="passes"):
    """(places, values, errors, resolved) of one point and region. What emits no photons has no place against them."""
    column, _ = AXES[against]
    rows = rows[rows[quantity].notna() & rows[column].notna()].sort_values("pass")
    values, errors = rows[quantity].to_numpy(), rows[f"{quantity}_error"].to_numpy()
    return rows[column].to_numpy(), values, errors, values > fits.RESOLVED * numpy.nan_to_num(errors)


def places_of(rows, passes, against):
    """Where passes are on the axis, by straight lines on logarithmic axes between the recorded ones in `rows`."""
    known = rows.drop_duplicates("pass").sort_values("pass")
    column = known[AXES[against][0]]
    if not len(passes) or column.isna().any():
        return passes
    return numpy.exp(numpy.interp(numpy.log(passes), numpy.log(known["pass"]), numpy.log(column)))


def theory_of(recorded_rows, rows, component, region):
    """(passes, {quantity: {kind: values}}) that theory predicts over the window, kinds as in THEORY_LINES; `rows` are a point's
    of decomposition.csv."""
    first, last = fits.default_window(rows["pass"].astype(int))
    predicted = fits.predictions(recorded_rows, component, last)
    at_first = rows[(rows["pass"] == first) & (rows["region"] == region) & (rows["component"] == component)]
    # Of the whole picture with direct light by shadow rays it is a sum, which fits.py predicts and this does not draw.
    is_mixed = component == "total" and (rows["component"] == "direct").any()
    if not predicted or at_first.empty or is_mixed:
        return [], {}
    measured = at_first.iloc[0]
    passes = numpy.arange(first, last + 1)

    def through_measured(quantity, shape):
        # A line through a value that is not resolved would start anywhere.
        if shape is None or not measured[quantity] > fits.RESOLVED * measured[f"{quantity}_error"]:
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
                      color=look["color"], **BELOW_MARK)
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
    text = [f"{COMPONENT_TITLES[component].capitalize()}, {seeds:.0f} seeds in {groups:.0f} groups; per pixel and channel, "
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
        text.append("Path tracing emits none and is left out.")
    return " ".join(text)


def draw_scene(recorded, rows, labels, against="passes", roots=False):
    """The figure of one scene; None when nothing in it is resolved. `recorded` are the records, `rows` those of
    decomposition.csv, both of the scene."""
    titles, shape, unit = (ROOT_TITLES, numpy.sqrt, "radiance") if roots else (TITLES, lambda values: values, "radiance²")
    styles = style.method_styles(recorded, labels)
    component = component_to_draw(rows)
    rows = rows[rows["pass"] > 0]    # a logarithmic axis has no place for it
    label_of = recorded.drop_duplicates("run").assign(point=lambda runs: runs["run"].map(decomposition.point_of)) \
        .drop_duplicates("point").set_index("point")["method"].to_dict()
    points = recorded["run"].map(decomposition.point_of)
    lines_of_figure = []    # (region, {quantity: curves}, {quantity: theories}, limits)
    for region in rows["region"].drop_duplicates():
        curves = {quantity: {} for quantity in TITLES}
        theories = {quantity: {} for quantity in TITLES}
        for point in sorted(set(rows["point"]), key=lambda point: labels.index(label_of[point])):
            of_point = rows[rows["point"] == point]
            drawn = of_point[(of_point["component"] == component) & (of_point["region"] == region)]
            passes, predicted = theory_of(recorded[points == point], of_point, component, region)
            for quantity in TITLES:
                if drawn[quantity].notna().any():
                    curve = curve_of(drawn, quantity, against)
                    if len(curve[0]):
                        curves[quantity][label_of[point]] = curve
                if predicted.get(quantity) and label_of[point] in curves[quantity]:
                    theories[quantity][label_of[point]] = (places_of(of_point, passes, against), predicted[quantity])
        limits = vertical_range([curve for of_quantity in curves.values() for curve in of_quantity.values()], shape)
        if limits:
            lines_of_figure.append((region, curves, theories, limits))
    if not lines_of_figure:
        return None

    style.use()
    any_theory = any(of_quantity for _, _, theories, _ in lines_of_figure for of_quantity in theories.values())
    any_below = any(not resolved.all() for _, curves, _, _ in lines_of_figure for of_quantity in curves.values()
                    for *_, resolved in of_quantity.values())
    places = [place for _, curves, _, _ in lines_of_figure for of_quantity in curves.values()
              for curve in of_quantity.values() for place in curve[0]]
    drawn_labels = {label for _, curves, _, _ in lines_of_figure for of_quantity in curves.values() for label in of_quantity}
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels if label in drawn_labels]
    if any_theory:
        handles += [lines.Line2D([], [], label=label, color="#555555", **THEORY_LINES[kind])
                    for kind, label in [("squared_bias", "theory, smooth"), ("edge", "theory, at edges")]]
    if any_below:
        handles.append(lines.Line2D([], [], label="below resolution", color="#555555", **BELOW_MARK))
    caption = notes(rows[rows["component"] == component], component, any_theory, against)
    figure, grid = style.panels_over_legend(len(lines_of_figure), len(TITLES), handles, caption)
    for (region, curves, theories, limits), row in zip(lines_of_figure, grid):
        for axes, (quantity, title) in zip(row, titles.items()):
            draw_panel(axes, curves[quantity], theories[quantity], styles, limits, shape)
            style.logarithmic(axes.xaxis, min(places) / 1.15, max(2 * min(places), *places) * 1.15,
                              base_two=against == "passes", most=4)
            axes.set_title(title, loc="right")
            axes.set_xlabel(AXES[against][1])
        row[0].set_ylabel(f"{region} ({unit})")
    grid[0][0].set_title(rows["scene"].iloc[0], loc="left")
    figure.align_ylabels()
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/bias-variance-SCENE.png and .pdf; what is not drawn "
                                     "by default is in the\nname: bias-variance-SCENE-roots-seconds.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    parser.add_argument("--against", choices=AXES, default="passes", help="the horizontal axis (default: passes); photons are "
                        "the light paths emitted")
    parser.add_argument("--roots", action="store_true", help="draw RMSE and the roots of variance and squared bias, in radiance")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    recorded = results.rows
    rows = read_decomposition(results)
    unknown = set(rows["point"]) - set(recorded["run"].map(decomposition.point_of))
    if unknown:
        raise InputError(f"{results.folder / 'decomposition.csv'}: {min(unknown)} is not in iterations.csv; run "
                                  "decomposition.py again")
    labels = records.methods_in_order(recorded)
    for scene, scene_rows in rows.groupby("scene", sort=False):
        of_scene = recorded[recorded["scene"] == scene]
        figure = draw_scene(of_scene, scene_rows, [label for label in labels if label in set(of_scene["method"])],
                            options.against, options.roots)
        if figure is None:
            print(f"{scene}: nothing is resolved, so there is nothing to draw")
            continue
        extra = ("-roots" if options.roots else "") + (f"-{options.against}" if options.against != "passes" else "")
        for file in style.save(figure, results.folder, f"bias-variance-{records.file_name(scene)}{extra}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
