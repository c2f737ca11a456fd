"""Draws what methods keep in memory: bytes of photon map and hit points against the light paths emitted, a figure per scene.

PM keeps every photon until it gathers, PPM those of a pass. Photons with their index count at their largest so far, as the mean
over seeds; what the process needs besides is in the records' `peak_rss_mib`. Methods with the same bytes share a line.
"""

import argparse
import sys
from pathlib import Path

try:
    import files
    import records
    import style
    import tables
    from matplotlib import lines
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and matplotlib (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-matplotlib)", file=sys.stderr)
    sys.exit(2)

MEASURED = ["paths_emitted", "map_bytes", "hit_point_bytes"]
MEBIBYTE = 2 ** 20


def curve_of(rows):
    """Mean over seeds of the MiB after each pass, by light paths; empty for a method that emits none."""
    rows = rows[(rows["component"] == "total") & (rows["pass"] > 0)].dropna(subset=MEASURED)
    means = rows.groupby("pass")[MEASURED].mean()
    means = means[means["paths_emitted"] > 0]
    return means.set_index("paths_emitted").sum(axis=1) / MEBIBYTE


def lines_of(rows, labels):
    """[(labels, curve)]: methods whose bytes are the same share one."""
    drawn = []
    for label in labels:
        curve = curve_of(rows[rows["method"] == label])
        if curve.empty:
            continue
        same = next((own for own, other in drawn if curve.equals(other)), None)
        if same is None:
            drawn.append(([label], curve))
        else:
            same.append(label)
    return drawn


def shared_name(labels):
    """What the labels of methods have in common: "PPM (3 settings)"."""
    parts = [label.split(", ") for label in labels]
    common = [part for part in parts[0] if all(part in others for others in parts)]
    return labels[0] if len(labels) == 1 else f"{', '.join(common)} ({len(labels)} settings)".lstrip()


def draw_scene(rows, labels):
    """The figure of one scene; None when no method of it emits photons."""
    drawn = lines_of(rows, labels)
    if not drawn:
        return None
    style.use()
    styles = style.method_styles(rows, labels)
    looks = [{**styles[own[0]], "label": shared_name(own)} for own, _ in drawn]
    figure, [[axes]] = style.panels_over_legend(
        1, 1, [lines.Line2D([], [], **look) for look in looks], "Photons with their index, at their largest so far, and hit points "
        "with their statistics; means over seeds.", panel_height=2.4)
    for look, (_, curve) in zip(looks, drawn):
        axes.plot(curve.index, curve, markevery=style.marked_places(list(curve.index)), **look)
    for axis, values in [(axes.xaxis, [place for _, curve in drawn for place in curve.index]),
                         (axes.yaxis, [value for _, curve in drawn for value in curve if value > 0])]:
        style.logarithmic(axis, min(values) / 1.2, max(2 * min(values), *values) * 1.1)
    axes.set_xlabel("light paths emitted")
    axes.set_ylabel("photon map and hit points (MiB)")
    axes.set_title(rows["scene"].iloc[0], loc="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/memory-SCENE.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = records.read(parser.parse_args(arguments).results)
    recorded = results.rows
    for column in MEASURED:
        recorded[column] = tables.to_numbers(results.file, recorded[column])
    labels = records.methods_in_order(recorded)
    for scene, rows in recorded.groupby("scene", sort=False):
        figure = draw_scene(rows, [label for label in labels if label in set(rows["method"])])
        if figure is None:
            print(f"{scene}: no method emits photons, so there is nothing to draw")
            continue
        for file in style.save(figure, results.folder, f"memory-{records.file_name(scene)}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
