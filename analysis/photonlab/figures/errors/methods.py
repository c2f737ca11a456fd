"""Which method for which light: MSE of every method and region relative to a baseline with the same photons, as a table, and MSE
against the initial radius where one was swept.

The baseline is ppm with schedule hachisuka, at the initial radius that most methods have. Values are those of decomposition.csv, of
gathered light at the last pass. A ratio's standard error is that of both together where they have the same seeds, so that what they
share, photons and the reference's noise, is not counted; it takes them as independent where their seeds or references differ or the
sums over seeds are gone. A reference of one image has a noise that is not known, and not in it.
"""

from matplotlib import lines

from photonlab.command import Command, has
from photonlab.drawing import style
from photonlab.drawing.panels import filled, name_row, panels_over_legend, set_titles
from photonlab.drawing.saving import Drawn
from photonlab.records import ensembles, methods, tables
from photonlab.records.files import InputError
from photonlab.statistics import decomposition
from photonlab.statistics.moments import error_of_ratio, of_pass

NAME = "methods.csv"
SWEPT = "footprints"
NAMED = ["integrator", "schedule", "test_variant"]    # settings that tell rules apart
COLUMNS = ["scene", "region", "method", "pass", "mse", "mse_error", "relative", "relative_error"]


def last_rows(results):
    """The rows of decomposition.csv at the last pass that all methods have, of gathered light, with the label of their method, its
    rule, and its first radius."""
    rows = decomposition.read_decomposition(results)
    points_by_pass = rows.groupby("pass")["point"].nunique()
    last = points_by_pass.index[points_by_pass == points_by_pass.max()].max()
    rows = rows[(rows["component"] == "gathered") & (rows["pass"] == last)].copy()
    points = results.rows["run"].map(methods.point_of)
    rows["method"] = rows["point"].map(dict(zip(points, results.rows["method"])))
    rows = rows[rows["method"].notna()].copy()    # what was not asked for
    first = results.rows.drop_duplicates("method").set_index("method")
    rows["swept"] = rows["method"].map(first[SWEPT]).fillna("")
    rows["integrator"] = rows["method"].map(first["integrator"])
    rows["rule"] = [rule_of(first.loc[method], results.columns) for method in rows["method"]]
    return rows


def rule_of(row, columns):
    """A method's label without its radius."""
    return ", ".join(columns.setting_text(name, row[name]) for name in NAMED if name in row and row[name])


def moments_of_points(results, number):
    """{point: moments of gathered light after pass `number`}."""
    return {ensemble.point: of_pass(ensemble, results, "gathered", number) for ensemble, _ in ensembles.read_points(results, [])}


def relative_error(row, baseline, moments):
    """Of the ratio of their MSEs."""
    if row["point"] == baseline["point"]:
        return 0.0
    if {row["point"], baseline["point"]} <= moments.keys():
        error = error_of_ratio(moments[row["point"]], moments[baseline["point"]], row["region"])
        if error is not None:
            return error
    return decomposition.error_of_independent_ratio(row, baseline, "mse")


def relative_rows(rows, moments):
    """A row a method and region; empty where the baseline is not there."""
    common = rows["swept"].value_counts().idxmax()
    table = []
    for (scene, region), own in rows.groupby(["scene", "region"], sort=False):
        of_radius = own[(own["swept"] == common) | (own["swept"] == "")]
        baseline = of_radius[(of_radius["integrator"] == "ppm") & of_radius["rule"].str.contains("hachisuka")]
        if baseline.empty:
            continue
        for _, row in of_radius.iterrows():
            table.append({"scene": scene, "region": region, "method": row["rule"], "pass": int(row["pass"]),
                          "mse": repr(float(row["mse"])), "mse_error": repr(float(row["mse_error"])),
                          "relative": repr(float(row["mse"] / baseline.iloc[0]["mse"])),
                          "relative_error": decomposition.text(relative_error(row, baseline.iloc[0], moments))})
    return table


@style.drawn
def draw_sweep(rows):
    """MSE against the initial radius, a panel a scene and region, for rules of which more than one was tried; None without."""
    swept = rows[rows["swept"] != ""]
    counts = swept.groupby("rule")["swept"].nunique()
    rules = list(counts[counts > 1].index)
    if not rules:
        return None
    panels = list(dict.fromkeys(zip(rows["scene"], rows["region"])))
    looks = {rule: {"color": color, "marker": marker} for rule, color, marker in zip(rules, style.COLOURS, style.MARKERS)}
    handles = [lines.Line2D([], [], label=rule, **looks[rule]) for rule in rules]
    radii = swept["swept"].astype(float)
    columns = 3
    figure, grid = panels_over_legend(-(-len(panels) // columns), columns, handles,
                                      "Gathered light at the last pass, without the reference's noise; 1.96 standard errors.")
    for axes, panel in filled(grid, panels):
        own = swept[(swept["scene"] == panel[0]) & (swept["region"] == panel[1])]
        for rule in rules:
            of_rule = own[own["rule"] == rule].assign(place=lambda r: r["swept"].astype(float)).sort_values("place")
            axes.errorbar(of_rule["place"], of_rule["mse"], yerr=1.96 * of_rule["mse_error"], **looks[rule])
        style.logarithmic(axes.xaxis, radii.min() / 1.15, radii.max() * 1.15, base_two=True)
        axes.set_yscale("log")
        set_titles(axes, ", ".join(panel))
        axes.set_xlabel("initial radius (footprints)")
    for panels_of_row in grid:
        name_row(panels_of_row, "MSE (radiance²)")
    return figure


def make(results, options):
    rows = last_rows(results)
    try:
        moments = moments_of_points(results, int(rows["pass"].iloc[0]))
    except InputError as error:    # the table alone says enough for the ratios
        moments = {}
        yield f"{error}: errors of ratios are those of independent methods"
    table = relative_rows(rows, moments)
    if not table:
        yield f"{results.folder}: no ppm with schedule hachisuka, which the others are compared with"
        return
    yield tables.Derived(NAME, COLUMNS, table)
    figure = draw_sweep(rows, **options.look)
    if figure is not None:
        yield Drawn("initial-radius", figure)


COMMAND = Command(
    name="methods", draws=True, summary="MSE of every method and region relative to ppm, and against the initial radius", about=__doc__,
    writes="methods.csv; where radii were swept figures/initial-radius, .png and .pdf",
    make=make, is_for=lambda results: has(decomposition.NAME)(results) and results.rows["schedule"].nunique() > 1)
