"""Draws which alpha has the least MSE as the budget grows: a figure per scene, with a column for the whole image and for each
named region, and a row for each set of settings that the sweep of alphas was repeated with (an initial radius, say).

The line is the best alpha after each recorded pass, against the light paths emitted so far. The band holds the candidates: all
alphas that win at least 5% of the draws when groups of seeds are drawn anew (fits.py, which writes the best-alphas.csv that is
read here). Where that is all of them, as after the first pass, when all alphas are the same image, the line has a gap.

Where the reference has it, gathered light is drawn; otherwise the whole picture.
"""

import argparse
import math
import sys
from pathlib import Path

try:
    import files
    import fits
    import numpy
    import records
    import style
    import tables
    from bias_variance import COMPONENT_TITLES
    from matplotlib import lines, patches
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, scipy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-scipy, python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)",
          file=sys.stderr)
    sys.exit(2)

BAND = {"color": "#c9c9c9", "linewidth": 0}
LINE = {"color": "black", "marker": "o", "markeredgecolor": "white", "markeredgewidth": 0.5}


def read_best(results):
    """Rows of RESULTS/best-alphas.csv: best alpha and paths as numbers, candidates as lists of them."""
    file = results.folder / "best-alphas.csv"
    rows = tables.read_derived(results, file.name, fits.BEST_COLUMNS, "fits.py on an experiment that sweeps alpha")
    for column in ["paths_emitted", "best_alpha"]:
        rows[column] = tables.to_numbers(file, rows[column])
    rows["candidates"] = [[float(alpha) for alpha in text.split(";") if alpha] for text in rows["candidates"]]
    return rows


def families_of(rows):
    """{label: rows} of the sweeps of one scene, named by the settings that differ among them."""
    differing = [column for column in fits.FAMILY if rows[column].nunique() > 1]
    if "radius_initial" in differing:
        differing = [column for column in differing if column != "radius_rule"]
    if not differing:
        return {"": rows}
    names = rows[differing].apply(lambda row: ", ".join(records.setting_text(column, row[column]) for column in differing
                                                        if row[column]), axis=1)
    labelled = {name: own for name, own in rows.groupby(names, sort=False)}
    return dict(sorted(labelled.items(), key=lambda item: [records.as_number(item[1][column].iloc[0]) or 0.0
                                                          for column in differing]))


def draw_panel(axes, rows, alphas):
    """One sweep in one region: a box of candidates about each pass, and the best alphas where it is not all of them."""
    rows = rows.sort_values("paths_emitted")
    paths = rows["paths_emitted"].to_numpy()
    steps = numpy.diff(numpy.log(paths)) / 2 if len(paths) > 1 else numpy.array([0.3])
    edges = numpy.exp(numpy.append(numpy.log(paths) - [*steps[:1], *steps][:len(paths)], math.log(paths[-1]) + steps[-1]))
    half = min(numpy.diff(alphas), default=0.1) / 2
    low, high = rows["candidates"].map(min).to_numpy() - half, rows["candidates"].map(max).to_numpy() + half
    axes.fill_between(numpy.repeat(edges, 2)[1:-1], numpy.repeat(low, 2), numpy.repeat(high, 2), **BAND)
    axes.plot(paths, rows["best_alpha"].where(rows["candidates"].map(len) < len(alphas)), **LINE)


def draw_scene(rows):
    """The figure of one scene; None when no alpha has a probability, which takes three groups of seeds."""
    rows = rows[rows["component"] == ("gathered" if (rows["component"] == "gathered").any() else "total")]
    rows = rows[(rows["paths_emitted"] > 0) & (rows["candidates"].map(len) > 0)]
    if rows.empty:
        return None
    families, regions = families_of(rows), list(dict.fromkeys(rows["region"]))
    component = rows["component"].iloc[0]
    style.use()
    handles = [lines.Line2D([], [], label="best alpha", **LINE),
               patches.Patch(label="candidates (5% and more)", **BAND)]
    figure, grid = style.panels_over_legend(
        len(families), len(regions), handles, f"{COMPONENT_TITLES[component].capitalize()}: alpha of least mean squared "
        "error. Candidates win at least 5% of 2000 draws of groups of seeds, the same groups for all alphas.",
        panel_height=1.6 if len(families) < 3 else 1.15)
    low, high = rows["paths_emitted"].min(), rows["paths_emitted"].max()
    for (label, own), row in zip(families.items(), grid):
        alphas = sorted({*own["best_alpha"], *(alpha for listed in own["candidates"] for alpha in listed)})
        for axes, region in zip(row, regions):
            draw_panel(axes, own[own["region"] == region], alphas)
            style.logarithmic(axes.xaxis, low / 1.5, high * 1.5, most=4)
            axes.set_title(region, loc="right")
        row[0].set_ylabel(f"{label}\nα" if label else "α")
    for axes in grid[-1]:
        axes.set_xlabel("light paths emitted")
    grid[0][0].set_title(rows["scene"].iloc[0], loc="left")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/best-alpha-SCENE.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = records.read(parser.parse_args(arguments).results)
    for scene, rows in read_best(results).groupby("scene", sort=False):
        figure = draw_scene(rows)
        if figure is None:
            print(f"{scene}: no alpha has a probability, which takes three seeds, so there is nothing to draw")
            continue
        for file in style.save(figure, results.folder, f"best-alpha-{records.file_name(scene)}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
