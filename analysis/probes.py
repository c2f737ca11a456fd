"""Draws what happens at single points as passes go by: radius, photons, their density, and radiance, the figure by which
Hachisuka, Ogaki and Jensen 2008 ("Progressive Photon Mapping", section 4) explain the method. The radius shrinks while
the photons inside it grow in number, so their density grows without bound; radiance converges.

A line is one seed's. Photons is N of that paper, which shrinks with the disc, for PPM with its schedule; for other
methods it counts photons found, and density is there only where those lie in the disc of that radius.
"""

import argparse
import sys
from pathlib import Path

try:
    import files
    import records
    import style
    import tables
    from files import InputError
    from matplotlib import lines
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas and matplotlib (on Debian: "
          "/usr/bin/python3 with python3-pandas, python3-xxhash and python3-matplotlib)", file=sys.stderr)
    sys.exit(2)

COLUMNS = ["schema", "experiment", "run", "scene", "seed", "probe", "x", "y", "pass", "radius", "photons", "density",
           "radiance_r", "radiance_g", "radiance_b"]
NUMBERS = ["seed", *COLUMNS[COLUMNS.index("x"):]]
QUANTITIES = {"radius": "radius (scene units)", "photons": "photons", "density": "photons a unit of area",
              "radiance": "radiance"}


def read_probes(results, labels_by_run):
    """Rows of RESULTS/probes.csv as numbers, with `method` and `radiance`, the mean of its channels."""
    file = results.folder / "probes.csv"
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected an experiment with probes")
    rows = tables.table_in(file, records.read_merged(results.folder, file.name)[0])
    tables.require_columns(file, rows, COLUMNS, f"expected those of schema {records.SCHEMA}")
    for column in NUMBERS:
        rows[column] = tables.to_numbers(file, rows[column])
    unknown = ~rows["run"].isin(labels_by_run)
    if unknown.any():
        raise InputError(f"{tables.place(file, unknown)}: run {rows['run'][unknown].iloc[0]} is not in "
                                  "iterations.csv")
    rows["method"] = rows["run"].map(labels_by_run)
    rows["radiance"] = rows[["radiance_r", "radiance_g", "radiance_b"]].mean(axis=1, skipna=False)
    return rows


def draw_scene(rows, labels, styles):
    """A row a quantity, a column a probe."""
    style.use()
    names = list(rows["probe"].drop_duplicates())
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels if label in set(rows["method"])]
    figure, grid = style.panels_over_legend(
        len(QUANTITIES), len(names), handles,
        f"Seed {rows['seed'].iloc[0]:.0f}. " + "; ".join(
            f"{name}: pixel ({group['x'].iloc[0]:.0f}, {group['y'].iloc[0]:.0f})"
            for name, group in rows.groupby("probe", sort=False)) + ". Radiance is the mean of its three channels.",
        panel_height=1.2)
    for column, name in enumerate(names):
        of_probe = rows[(rows["probe"] == name) & (rows["pass"] > 0)]
        for row, (quantity, title) in enumerate(QUANTITIES.items()):
            axes = grid[row][column]
            for label in labels:
                curve = of_probe[(of_probe["method"] == label) & of_probe[quantity].notna()].sort_values("pass")
                passes = list(curve["pass"])
                if passes:
                    axes.plot(passes, curve[quantity], markevery=style.marked_places(passes), **styles[label])
            values = rows[(rows["pass"] > 0) & (rows[quantity] > 0)][quantity]
            if quantity != "radiance" and not values.empty:
                style.logarithmic(axes.yaxis, values.min() / 1.15, values.max() * 1.15)
            style.logarithmic(axes.xaxis, 1 / 1.1, max(2, rows["pass"].max()) * 1.1, base_two=True)
            if column == 0:
                axes.set_ylabel(title)
            if row == 0:
                axes.set_title(f"{rows['scene'].iloc[0]}: {name}", loc="left")
        grid[-1][column].set_xlabel("pass")
    figure.align_ylabels()
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/probes-SCENE.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path, help="folder of an experiment's results")
    results = records.read(parser.parse_args(arguments).results)
    recorded = results.rows
    labels = records.methods_in_order(recorded)
    first_rows = recorded.drop_duplicates("run").set_index("run")
    rows = read_probes(results, first_rows["method"].to_dict())
    for scene, scene_rows in rows.groupby("scene", sort=False):
        of_seed = scene_rows[scene_rows["seed"] == scene_rows["seed"].min()]
        styles = style.method_styles(recorded, labels)
        figure = draw_scene(of_seed, labels, styles)
        for file in style.save(figure, results.folder, f"probes-{records.file_name(scene)}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
