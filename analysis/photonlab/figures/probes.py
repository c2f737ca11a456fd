"""Draws what happens at single points as passes go by: radius, photons, their density, and radiance, the figure by which
Hachisuka, Ogaki and Jensen 2008 ("Progressive Photon Mapping", section 4) explain the method. The radius shrinks while
the photons inside it grow in number, so their density grows without bound; radiance converges.

A line is one seed's. Photons is N of that paper, which shrinks with the disc, for PPM with its schedule; for other
methods it counts photons found, and density is there only where those lie in the disc of that radius.
"""

from matplotlib import lines

from photonlab.command import Command, has
from photonlab.drawing import style
from photonlab.drawing.panels import name_row, panels_over_legend, set_titles
from photonlab.drawing.saving import drawn_of_scenes
from photonlab.records import files, records, tables
from photonlab.records.files import InputError

COLUMNS = ["schema", "experiment", "run", "scene", "seed", "probe", "x", "y", "pass", "radius", "photons", "density",
           "radiance_r", "radiance_g", "radiance_b"]
NUMBERS = ["seed", *COLUMNS[COLUMNS.index("x"):]]
QUANTITIES = {"radius": "radius (scene units)", "photons": "photons", "density": "photons a unit of area",
              "radiance": "radiance"}


def read_probes(results):
    """Rows of RESULTS/probes.csv as numbers, with `method` and `radiance`, the mean of its channels."""
    file = results.folder / "probes.csv"
    if not files.is_there(file):
        raise InputError(f"{file}: is not there; expected an experiment with probes")
    with records.opened_merged(results.folder, file.name) as (stream, _, _):
        rows = tables.table_in(file, stream)
    tables.require_columns(file, rows, COLUMNS, f"expected those of schema {records.SCHEMA}")
    for column in NUMBERS:
        rows[column] = tables.to_numbers(file, rows[column])
    labels_by_run = dict(zip(results.rows["run"], results.rows["method"]))
    unknown = ~rows["run"].isin(labels_by_run)
    if unknown.any():
        raise InputError(f"{tables.place(file, unknown)}: run {rows['run'][unknown].iloc[0]} is not in iterations.csv")
    rows["method"] = rows["run"].map(labels_by_run)
    rows["radiance"] = rows[["radiance_r", "radiance_g", "radiance_b"]].mean(axis=1, skipna=False)
    return rows


@style.drawn
def draw(rows, labels, styles):
    """The figure of one scene's probes: a row a quantity, a column a probe. Labels and styles are those of the records' methods."""
    names = list(rows["probe"].drop_duplicates())
    handles = [lines.Line2D([], [], label=label, **styles[label]) for label in labels if label in set(rows["method"])]
    figure, grid = panels_over_legend(
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
            if row == 0:
                set_titles(axes, f"{rows['scene'].iloc[0]}: {name}")
        grid[-1][column].set_xlabel("pass")
    for row, title in zip(grid, QUANTITIES.values()):
        name_row(row, title)
    figure.align_ylabels()
    return figure


def make(results, options):
    rows, styles = read_probes(results), style.method_styles(results)
    return drawn_of_scenes("probes", ((scene, draw(own[own["seed"] == own["seed"].min()], results.labels, styles, **options.look))
                                           for scene, own in rows.groupby("scene", sort=False)))


COMMAND = Command(
    name="probes", draws=True, summary="radius, photons, density and radiance at single pixels", about=__doc__,
    writes="figures/probes-SCENE.png and .pdf",
    make=make, is_for=has("probes.csv"))
