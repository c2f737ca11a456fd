"""Draws how error falls: RMSE against passes and against seconds, for every scene of an experiment.

A line is the root of the mean, over seeds, of the MSE: of the unbiased one where the reference has two halves, so
that the reference's own noise drops out (E[(x-A)(x-B)] is the true MSE). Its band goes from the least to the largest
seed. What comes out at 0 or below is less than the reference can resolve; a logarithmic axis has no place for it, so it
is marked at the bottom and not dropped. The upper row is the whole image; the lower one the gathered light alone, whose
slope the Monte Carlo noise of sampled direct light would otherwise hide.
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import files
    import records
    import style
    from matplotlib import lines
    from matplotlib.transforms import blended_transform_factory
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and matplotlib (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-matplotlib)", file=sys.stderr)
    sys.exit(2)

COMPONENT_TITLES = {"total": "whole image", "gathered": "gathered light alone"}
FLOOR_LINE = {"color": "#555555", "linewidth": 0.8, "linestyle": (0, (4, 3)), "zorder": 1}
BELOW_MARK = {"linestyle": "none", "marker": 7, "markersize": 4.5, "zorder": 5}    # 7: points down
FARTHEST_FLOOR = 30.0   # a floor that many times below the least error is told, not drawn: it would flatten the curves


def curves_of(rows, labels, column):
    """Curves by label, without pass 0 (emission and direct light alone: a logarithmic axis has no place for it)."""
    curves = {}
    for label in labels:
        curve = records.aggregate_over_seeds(rows[rows["method"] == label], column)
        curve = curve[(curve.index > 0) & curve["mean"].notna()]
        if not curve.empty:
            curves[label] = curve
    return curves


def vertical_range(curves, floor):
    """Limits of the RMSE axis: all lines, and the floor where it is near. A band may leave at the bottom: its least
    seed can come out next to 0 by chance."""
    seen = [records.root(value) for curve in curves.values() for column in ["mean", "largest"]
            for value in curve[column] if value > 0 and math.isfinite(value)]
    if floor and (not seen or floor > min(seen) / FARTHEST_FLOOR):
        seen.append(floor)
    if not seen:
        return None
    low, high = min(seen), max(seen)
    margin = max((high / low) ** 0.06, 1.1)
    return low / margin ** 1.5, high * margin


def draw_panel(axes, curves, styles, horizontal, limits, floor):
    """One panel: RMSE against `horizontal`, "pass" or "seconds"."""
    bottom = limits[0]
    at_bottom = blended_transform_factory(axes.transData, axes.transAxes)
    places = []
    methods_below = 0    # each has a row of marks of its own
    for label, curve in curves.items():
        x = (curve.index if horizontal == "pass" else curve["seconds"]).to_numpy()
        x, curve = x[x > 0], curve[x > 0]
        places += list(x)
        look = styles[label]
        if (curve["seeds"] > 1).any():
            low, high = [[value if value > bottom else bottom for value in map(records.root, curve[column])]
                         for column in ["least", "largest"]]
            axes.fill_between(x, low, high, color=look["color"], alpha=0.2, linewidth=0)
        axes.plot(x, curve["mean"].map(records.root), label=label, markevery=style.marked_places(list(x)), **look)
        below = x[curve["mean"] <= 0]
        if len(below):
            marked = [below[i] for i in style.marked_places(list(below))]
            axes.plot(marked, [0.035 + 0.04 * methods_below] * len(marked), transform=at_bottom, color=look["color"],
                      **BELOW_MARK)
            methods_below += 1
    if floor and limits[0] <= floor <= limits[1]:
        axes.axhline(floor, **FLOOR_LINE)
    if places:
        low, high = min(places), max(places)
        margin = max((high / low) ** 0.04, 1.05)
        style.logarithmic(axes.xaxis, low / margin, high * margin, base_two=horizontal == "pass")
    style.logarithmic(axes.yaxis, *limits)
    axes.set_xlabel("pass" if horizontal == "pass" else "time of all passes so far (s)")


def notes(rows, column, floors):
    """What a reader has to know to read the figure, in one paragraph."""
    seeds = rows.groupby("method")["seed"].nunique()
    count = f"{seeds.min()}" if seeds.min() == seeds.max() else f"{seeds.min()} to {seeds.max()}"
    text = []
    kind = "unbiased MSE" if column == "mse_unbiased" else "MSE"
    if seeds.max() > 1:
        text.append(f"Line: root of the mean {kind} over {count} seeds; band: least to largest seed.")
    else:
        text.append(f"Line: root of the {kind} of one seed.")
    text.append(records.noise_note(rows))
    if floors:
        hidden = [f"{style.two_digits(floor)} ({COMPONENT_TITLES[component]})" for component, floor in floors.items()]
        text.append(f"Floor of the reference, below the axis: RMSE {', '.join(hidden)}.")
    if (rows["direct"] == "photons").any():
        text.append("Where photons carry direct light, gathered light is judged against direct + gathered.")
    nonfinite = rows[(rows["component"] == "total") & (rows["nonfinite"] > 0)]
    if not nonfinite.empty:
        text.append(f"Up to {nonfinite['nonfinite'].max():.0f} pixels that are not finite are left out.")
    return " ".join(filter(None, text))


def draw_scene(scene_rows, labels):
    """The figure of one scene; None when nothing in it can be drawn."""
    styles = style.method_styles(scene_rows, labels)
    panels = []
    for component in COMPONENT_TITLES:
        rows = scene_rows[(scene_rows["component"] == component) & (scene_rows["pass"] > 0)]
        column = records.error_column(rows)
        floor = records.root(rows["reference_floor"].max())
        curves = curves_of(rows, labels, column)
        limits = vertical_range(curves, 0.0 if math.isnan(floor) else floor)
        if curves and limits:
            panels.append((component, rows, column, floor, curves, limits))
    if not panels:
        return None

    style.use()
    drawn = [label for label in labels if any(label in curves for *_, curves, _ in panels)]
    floors_in_sight = [low <= floor <= high for *_, floor, _, (low, high) in panels]
    hidden_floors = {component: floor for component, _, _, floor, _, (low, _) in panels if 0 < floor < low}
    any_below = any((curve["mean"] <= 0).any() for *_, curves, _ in panels for curve in curves.values())
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in drawn]
    if any(floors_in_sight):
        handles.append(lines.Line2D([], [], label="floor of the reference", **FLOOR_LINE))
    if any_below:
        handles.append(lines.Line2D([], [], label="below resolution (≤ 0)", color="#555555", **BELOW_MARK))
    caption = notes(scene_rows[scene_rows["pass"] > 0], panels[0][2], hidden_floors)

    figure, grid = style.panels_over_legend(len(panels), 2, handles, caption)
    for (component, _, _, floor, curves, limits), (left, right) in zip(panels, grid):
        draw_panel(left, curves, styles, "pass", limits, floor)
        draw_panel(right, curves, styles, "seconds", limits, floor)
        left.set_ylabel("RMSE (radiance)")
        left.set_title(f"{scene_rows['scene'].iloc[0]}: {COMPONENT_TITLES[component]}", loc="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Writes RESULTS_DIR/figures/convergence-SCENE.png and .pdf.\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path,
                        help="folder of an experiment's results: iterations.csv is in it")
    results = records.read(parser.parse_args(arguments).results)
    rows = results.rows
    labels = records.methods_in_order(rows)
    for scene, scene_rows in rows.groupby("scene", sort=False):
        figure = draw_scene(scene_rows, [label for label in labels if label in set(scene_rows["method"])])
        if figure is None:
            print(f"{scene}: no errors were recorded (was there a reference?), so no convergence plot")
            continue
        for file in style.save(figure, results.folder, f"convergence-{records.file_name(scene)}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
