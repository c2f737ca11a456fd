"""Makes one page of a results folder: RESULTS/report.html, with tables of errors and costs, the figures, every run's
settings, and the images themselves in a viewer that flips, wipes and subtracts them.

The page is a single file without anything to load, so that it can be mailed, archived or attached to a paper. Errors
are those of each method's last pass: RMSE is the root of the mean over seeds of `mse_unbiased`. What the folder does
not have (figures, snapshots, a reference) is said at the top of the page.

The viewer is given radiance, not pictures: its exposure acts before sRGB's transfer function. A pixel is three half
floats, scaled by a power of two such that white at the scene's usual exposure is near 1. They tell 2000 levels a stop
from 14 stops below white on, where a screen tells 90 at most, so that nothing bands. An image is all low bytes and then
all high bytes of its halves (these two compress apart better), by channel, deflated, in base64. What is given are the layers
emission, direct and gathered, each once however many images share it; the viewer adds them up to the picture. The picture itself
is given where a file has no layers, or where they are not its sum.
"""

import argparse
import base64
import json
import math
import sys
import zlib
from html import escape
from pathlib import Path

try:
    import files
    import gallery
    import numpy
    import pandas
    import pictures
    import records
    import strip
    import style
    import tables
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

HERE = Path(__file__).parent
COMPONENT_NAMES = {"total": "whole image", "emission": "emission", "direct": "direct", "gathered": "gathered"}
COUNTERS = ["paths_emitted", "photons_stored", "photons_gathered"]
KEPT = ["map_bytes", "hit_point_bytes"]
DERIVED_TABLES = {"fits.csv": "Fits", "best-alphas.csv": "Best alphas",
                  "decomposition.csv": "Variance and squared bias"}
LARGEST_HALF = 65504.0
NOTHING = "–"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


# Cells and tables. A cell is what is shown and, in a column of numbers, the number that it is sorted by.

def three_digits(value):
    """0.00331, −12.5, 6,400,000, 2.40·10⁻⁷."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-4 <= abs(value) < 1e3:
        return f"{value:#.3g}".rstrip(".").replace("-", "−")
    if 1e3 <= abs(value) < 1e12:
        return f"{value:,.0f}".replace("-", "−")
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPTS)}".replace("-", "−")


def number(value, shown=None):
    return (NOTHING if math.isnan(value) else shown or three_digits(value), value)


def cells(texts):
    """A column of a CSV: numbers where all that is not empty is one, as they were written where all are short."""
    values = pandas.to_numeric(texts, errors="coerce")
    if (values.isna() & ~texts.str.lower().isin(["", "nan", "-nan"])).any():
        return list(texts)
    short = texts.str.len().max() <= 6
    return [number(value, text.replace("-", "−") if short else None) for value, text in zip(values, texts)]


def whole(value):
    return number(value, f"{value:,.0f}")


def table(caption, note, groups, columns, rows):
    """A sortable table. `note` is small print after the caption; `groups` are (heading, how many columns it spans)
    above the columns, or nothing. A row's cells are texts, or pairs of text and number."""
    numeric = [any(isinstance(row[place], tuple) for row in rows) for place in range(len(columns))]

    def body_cell(cell):
        if not isinstance(cell, tuple):
            return f"<td>{escape(cell)}</td>"
        shown, value = cell
        kind = "number words" if " " in shown else "number"
        return f'<td class="{kind}" data-value="{"" if math.isnan(value) else repr(float(value))}">{escape(shown)}</td>'

    above = "".join(f'<th colspan="{span}"{" class=group" if heading else ""}>{escape(heading)}</th>'
                    for heading, span in groups)
    heads = "".join(f'<th scope="col"{" class=number" if is_number else ""}><button type="button">'
                    f'{escape(name).replace("_", "_<wbr>")}</button></th>' for name, is_number in zip(columns, numeric))
    lines = "\n".join(f"<tr>{''.join(map(body_cell, row))}</tr>" for row in rows)
    return (f'<div class="wide"><table class="sortable"><caption>{escape(caption)}'
            f'{f"<span>{escape(note)}</span>" if note else ""}</caption>\n<thead>'
            f"{f'<tr>{above}</tr>' if above else ''}<tr>{heads}</tr></thead>\n<tbody>\n{lines}\n</tbody></table></div>")


# What the records say.

def read_runs(results, missing):
    """{name: run} of the runs of the records that have a run.json."""
    names = results.rows["run"].unique()
    without = [name for name in names if not results.has_run(name)]
    if without:
        missing.append(f"No run.json, so neither settings nor images, of {len(without)} of {len(names)} "
                       f"runs: {', '.join(without[:3])}{', …' if len(without) > 3 else '.'}")
    return {name: results.run(name) for name in names if name not in without}


def found(run, *keys):
    """A value inside run.json as text; "" where there is none."""
    value = run.description
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return "" if value is None else str(value)


def found_number(run, key):
    """A whole number inside run.json; 0 where there is none."""
    value = run.description.get(key)
    return value if isinstance(value, int) else 0


def distinct(texts):
    return list(dict.fromkeys(filter(None, texts)))


def last_pass(rows):
    """The rows of the last pass that all of a method's seeds recorded; none where they have no pass in common. `rows`
    are those of one scene, method and component."""
    curve = records.aggregate_over_seeds(rows, "mse")
    return rows[rows["pass"] == curve.index.max()]


def rmse_cell(rows):
    value = rows[records.error_column(rows)].mean(skipna=False)
    if math.isnan(value):
        return number(value)
    root = records.root(value)
    return (three_digits(root) if value > 0 else "below resolution", root if value > 0 else 0.0)


def process_cell(rows, runs):
    """The largest memory of the process, which is a run's own where it ran alone. `rows` are those of a method's last pass."""
    together = max((found_number(runs[run], "runs_together") for run in rows["run"] if run in runs), default=1)
    if together > 1:
        return (f"with {together - 1} other{'s' * (together > 2)}", math.nan)
    return number(rows["peak_rss_mib"].max())


def result_tables(scene, rows, labels, runs):
    """Errors and costs of a scene's methods at their last passes, as two tables."""
    errors, costs = [], []
    for label in labels:
        components = {component: last_pass(of_component) for component, of_component in
                      rows[rows["method"] == label].groupby("component", sort=False)}
        last = components.get("total", next(iter(components.values())))
        if last.empty:
            continue
        start = [label, whole(last["pass"].iloc[0]), number(last["seconds"].mean())]
        present = [components.get(component, rows.iloc[:0]) for component in COMPONENT_NAMES]
        errors.append(start + [rmse_cell(of_component) for of_component in present] +
                      [number(of_component["relmse"].mean(skipna=False)) for of_component in present])
        costs.append(start + [whole(last["seed"].nunique())] + [whole(last[counter].mean()) for counter in COUNTERS] +
                     [number(last[column].max() / 2 ** 20) for column in KEPT] + [process_cell(last, runs)])
    start = ["method", "pass", "seconds"]
    names = list(COMPONENT_NAMES.values())
    judged = rows["mse"].notna().any()
    noise = "" if judged else "there is no reference, so there are none"
    of_noise = "without" if records.error_column(rows) == "mse_unbiased" else "with"
    groups = [("", 3), (f"RMSE, {of_noise} the reference's noise", 4), ("relMSE, with its noise", 4)]
    return (table(f"{scene}: errors of the last pass", noise, groups if judged else [("", 3), ("RMSE", 4), ("relMSE", 4)],
                  start + names + names, errors) +
            table(f"{scene}: costs of a seed up to there", "", [("", 4), ("photons", 3), ("largest memory, MiB", 3)],
                  start + ["seeds", "paths emitted", "stored", "gathered", "photon map", "hit points", "process"],
                  costs))


def derived_table(name, title, rows, recorded):
    """A CSV that another tool of the analysis wrote. Settings are named by the method that `recorded` gives them, and
    what is the same in all rows is said once, above."""
    notes = []
    if name == "decomposition.csv" and "pass" in rows.columns and not rows.empty:
        passes = tables.to_numbers(name, rows["pass"], whole=True)
        owner = [rows[column] for column in ["scene", "point"] if column in rows.columns]
        last = passes.groupby(owner).transform("max") if owner else passes.max()
        rows = rows[passes == last]
        notes.append("the last pass alone; the file has all of them")
    settings = ["scene", *records.SETTINGS]
    if set(settings) <= set(rows.columns):
        known = recorded[[*settings, "method"]].drop_duplicates()
        methods = rows[settings].merge(known, on=settings, how="left")["method"]
        rows = rows.assign(point=methods.fillna("").to_numpy()).rename(columns={"point": "method"})
        rows = rows.drop(columns=records.TABLE_SETTINGS, errors="ignore")
    rows = rows[[column for column in rows.columns if (rows[column] != "").any()]]
    if len(rows.drop_duplicates()) > 1:
        same = [column for column in rows.columns if rows[column].nunique() == 1]
        if same:
            values = [cells(rows[column].iloc[:1])[0] for column in same]
            notes.append("in all rows " + ", ".join(f"{column} = {value[0] if isinstance(value, tuple) else value}"
                                                    for column, value in zip(same, values)))
        rows = rows.drop(columns=same)
    if rows.empty:
        return f"<p>{escape(name)} has no rows.</p>"
    return table(f"{title} ({name})", "; ".join(notes), [], list(rows.columns),
                 list(zip(*(cells(rows[column]) for column in rows.columns))))


# Images for the viewer.

def encoded(image, scale):
    """Radiance as the viewer reads it; how is told at the top of this file."""
    scaled = image * scale
    halves = numpy.where(numpy.isinf(scaled), scaled, numpy.clip(scaled, -LARGEST_HALF, LARGEST_HALF))
    planes = halves.astype("<f2").transpose(2, 0, 1).copy().view(numpy.uint8).reshape(-1, 2)
    return base64.b64encode(zlib.compress(planes.T.tobytes(), 9)).decode()


def snapshots(rows, labels, runs, missing, name, seeds):
    """[(method, pass, seed, layers, captions by component, file)] of each method's lowest seeds that have snapshots."""
    shown, without = [], []
    for label in labels:
        of_method = rows[rows["method"] == label]
        own = []    # [(seed, its rows, files by pass)]
        for seed, of_run in sorted(of_method.groupby("seed"), key=lambda pair: pair[0]):
            run = of_run["run"].iloc[0]
            if run in runs and runs[run].snapshots:
                own.append((int(seed), of_run, runs[run].snapshots))
        if not own and any(run in runs for run in of_method["run"]):
            without.append(label)
        for number in dict.fromkeys(number for *_, by_pass in own[:seeds] for number in by_pass):
            for seed, of_run, by_pass in own[:seeds]:
                if number in by_pass:
                    of_pass = of_run[of_run["pass"] == number]
                    captions = {component: gallery.caption(of_component)
                                for component, of_component in of_pass.groupby("component") if component != "emission"}
                    shown.append((label, number, seed, pictures.read_layers([by_pass[number]]), captions, by_pass[number]))
    if shown and without:    # an experiment that keeps no images misses none
        missing.append(f"{name}: no snapshots of {', '.join(without)}.")
    return shown


def references(results, rows, runs, missing, name):
    """{path: (layers, its first file)} of the references that the runs were judged by."""
    judges = {}
    for run in rows["run"].unique():
        judge = records.reference_of(results, runs[run].description) if run in runs else None
        if judge:
            judges.setdefault(judge.path, judge)
    missing += [f"{name}: the reference {path} {judge.why_not}." for path, judge in judges.items() if not judge.halves]
    return {path: (pictures.read_layers(judge.halves), judge.halves[0]) for path, judge in judges.items() if judge.halves}


def given_layers(layers):
    """What the viewer needs of an image: its three layers where they add up to the picture, all where they do not."""
    picture = layers["picture"]
    parts = [layer for name, layer in layers.items() if name != "picture"]
    if parts and numpy.allclose(sum(parts), picture, rtol=1e-4, atol=1e-6 * numpy.nanmax(numpy.abs(picture), initial=0)):
        return {name: layer for name, layer in layers.items() if name != "picture"}
    return layers


def viewer_scene(results, name, rows, labels, runs, missing, seeds):
    """A scene for the viewer, its images all of one size; None without images."""
    shown = snapshots(rows, labels, runs, missing, name, seeds)
    judges = references(results, rows, runs, missing, name)
    images = [(f"{label}, pass {number}", label, seed, layers, captions, file)
              for label, number, seed, layers, captions, file in shown]
    images += [("reference" if len(judges) == 1 else f"reference {path}", "reference", None, layers, {}, file)
               for path, (layers, file) in judges.items()]
    if not images:
        return None
    *_, first, _, first_file = images[0]
    for *_, layers, _, file in images:
        pictures.require_same_size(file, layers["picture"], first_file, first["picture"])
    exposure = pictures.exposure_for(gallery.lit_by_scene(images[-1][3]["picture"], first_file))
    scale = 2.0 ** round(math.log2(exposure))
    places, listed = {}, {}    # of encoded pixels; of images by name
    for image_name, group, seed, layers, captions, _ in images:
        image = listed.setdefault(image_name, {"name": image_name, "group": group, "seeds": []})
        image["seeds"].append({"seed": seed, "captions": captions, "layers": {
            layer: places.setdefault(encoded(radiance, scale), len(places))
            for layer, radiance in given_layers(layers).items()}})
    return {"name": name, "width": first["picture"].shape[1], "height": first["picture"].shape[0], "scale": scale,
            "exposure": exposure, "pixels": list(places), "images": list(listed.values())}


def seeds_left_out(rows, runs, seeds):
    """What the viewer does not have though the folder does."""
    with_images = rows[rows["run"].map(lambda run: run in runs and bool(runs[run].snapshots))]
    most = int(with_images.groupby(["scene", "method"])["seed"].nunique().max())
    return f"Of up to {most} seeds of a method, those of the lowest {seeds} are here; --seeds gives more." if most > seeds else ""


def viewer_scenes(results, rows, labels, runs, missing, seeds):
    """Every scene's images. Only images of one size can be compared, so a scene of several sizes is several here."""
    scenes = []
    for scene, of_scene in rows.groupby("scene", sort=False):
        sizes = of_scene.groupby(["width", "height"], sort=False)
        for (width, height), of_size in sizes:
            name = scene if sizes.ngroups == 1 else f"{scene}, {width} × {height}"
            own_labels = [label for label in labels if label in set(of_size["method"])]
            scenes.append(viewer_scene(results, name, of_size, own_labels, runs, missing, seeds))
    return [scene for scene in scenes if scene]


# The page.

VIEWER = """
<section id="images">
<h2>Images</h2>
<p class="small" id="left-out">{left_out}</p>
<noscript><p>The images are shown by JavaScript, which is off.</p></noscript>
<div id="viewer">
<div>
<div id="stage">
<div id="picture" tabindex="0" role="group" aria-describedby="keys"
     aria-label="The images A and B. Arrow keys move the pixel whose values are shown.">
<canvas></canvas><div id="divider"></div><div id="pixel"></div><span id="left-tag"></span><span id="right-tag"></span>
</div>
</div>
<p id="legend"></p>
<div id="scale-of-difference"><span></span><canvas width="255" height="1"></canvas><span></span></div>
</div>
<div id="controls">
<label>Scene <select id="scene"></select></label>
<label>A <select id="image-a"></select></label>
<label>Seed of A <select id="seed-a"></select></label>
<label>B <select id="image-b"></select></label>
<label>Seed of B <select id="seed-b"></select></label>
<label>Layer <select id="layer"><option value="picture">picture</option><option>emission</option><option>direct</option>
<option>gathered</option></select></label>
<fieldset><legend>Compare</legend>
<label><input type="radio" name="mode" value="flip" checked> flip</label>
<label><input type="radio" name="mode" value="wipe"> wipe</label>
<label><input type="radio" name="mode" value="difference"> difference</label>
</fieldset>
<div class="of-flip"><button type="button" id="flip">Flip to B</button></div>
<label class="of-wipe">Divider <input type="range" id="divider-place" min="0" step="1"><output></output></label>
<label class="of-difference">Map <select id="map"><option value="signed">A − B, mean of R, G, B</option>
<option value="absolute">|A − B|, each channel</option></select></label>
<label class="of-difference">Gain <input type="range" id="gain" min="0" max="10" step="1" value="4">
<output></output></label>
<label>Exposure <input type="range" id="exposure" min="-8" max="8" step="0.25" value="0"><output></output></label>
<label>Zoom <input type="range" id="zoom" min="1" max="16" step="1"><output></output></label>
<table id="values"><caption></caption><thead><tr><th></th><th>R</th><th>G</th><th>B</th></tr></thead>
<tbody><tr><th scope="row">A</th><td></td><td></td><td></td></tr>
<tr><th scope="row">B</th><td></td><td></td><td></td></tr>
<tr><th scope="row">A − B</th><td></td><td></td><td></td></tr></tbody></table>
<p id="keys" class="small">Over the picture: <kbd>space</kbd> flips, <kbd>w</kbd> wipes, <kbd>d</kbd> subtracts. In
wipe mode the divider follows the mouse. After a click or <kbd>tab</kbd> to the picture, arrow keys move the pixel.</p>
</div>
</div>
<p class="small">Radiance in half floats: values and differences are exact to 0.05% of a pixel's radiance. Pixels that are not
a number, and layers that an image does not have, are magenta. Where photons carry direct light, it is in the layer gathered. {noise}</p>
</section>
"""


def facts(rows, runs):
    """Who, when and with what, as a list of terms."""
    starts = sorted(distinct(found(run, "started") for run in runs.values()))
    days = distinct(start[:10] for start in ([starts[0], starts[-1]] if starts else []))

    def joined(separator, *places):
        return distinct(separator.join(filter(None, (found(run, *place) for place in places))) for run in runs.values())

    extent = " · ".join(f"{count} {what}{'' if count == 1 else 's'}" for count, what in
                        [(rows["scene"].nunique(), "scene"), (rows["method"].nunique(), "method"),
                         (rows["seed"].nunique(), "seed"), (rows["run"].nunique(), "run")])
    listed = [("Experiment", distinct(rows["experiment"])), ("Extent", [extent]), ("Date", [" to ".join(days)]),
              ("Program", joined(" ", ("program", "name"), ("program", "version"), ("program", "commit"))),
              ("Compiler", joined(" ", ("program", "compiler"), ("program", "compiler_flags"))),
              ("Processor", joined("", ("processor",))), ("Threads", distinct(rows["threads"]))]
    return "<dl>" + "".join(f"<dt>{escape(term)}</dt><dd>{'<br>'.join(map(escape, texts))}</dd>"
                            for term, texts in listed if any(texts)) + "</dl>"


def scene_table(rows, runs):
    lines = []
    for scene, of_scene in rows.groupby("scene", sort=False):
        own = [runs[run] for run in of_scene["run"].unique() if run in runs]
        images = distinct(f"{row['width']} × {row['height']}, {row['samples_per_pixel']} a pixel"
                          for _, row in of_scene.drop_duplicates(["width", "height", "samples_per_pixel"]).iterrows())
        floor = of_scene[of_scene["component"] == "total"]["reference_floor"].max()
        lines.append([scene, "; ".join(distinct(found(run, "scene", "file") for run in own)) or NOTHING,
                      "; ".join(images), "; ".join(distinct(found(run, "reference", "path") for run in own)) or
                      NOTHING, number(records.root(floor))])
    return table("Scenes", "the noise is the reference's own RMSE", [],
                 ["scene", "file", "image, samples", "reference", "its noise"], lines)


def figures(results, stale):
    """The figures of these records; the names of others go to `stale`."""
    drawn = {file: files.read_bytes(file) for file in sorted((results.folder / "figures").glob("*.png"))}
    stale += [f"figures/{file.name}" for file, data in drawn.items() if style.records_of_png(data) != results.hash]
    shown = "\n".join(f'<figure><img alt="{escape(file.name)}" src="data:image/png;base64,{base64.b64encode(data).decode()}">'
                      f"<figcaption>{escape(file.name)}</figcaption></figure>" for file, data in drawn.items()
                      if style.records_of_png(data) == results.hash)
    return f'<section id="figures"><h2>Figures</h2>{shown}</section>' if shown else ""


def derived_tables(results, stale):
    """The tables that other tools made from these records; the names of others go to `stale`."""
    shown = ""
    for name, title in DERIVED_TABLES.items():
        if not files.is_there(results.folder / name):
            continue
        rows = tables.read_table(results.folder / name)
        if tables.is_stale(rows, results.hash):
            stale.append(name)
        else:
            shown += derived_table(name, title, rows.drop(columns=tables.RECORDS, errors="ignore"), results.rows)
    return shown


def flattened(value, name=""):
    """[("settings.alpha", 0.7), ...] of the objects in run.json; lists stay whole."""
    if not isinstance(value, dict):
        return [(name, value)]
    return [line for key, inner in value.items() for line in flattened(inner, f"{name}.{key}" if name else key)]


def settings(runs):
    """Every run's run.json, folded; what is null does not apply to the run."""
    folded = []
    for name, run in runs.items():
        texts = [(place, value if isinstance(value, str) else json.dumps(value))
                 for place, value in flattened(run.description) if value is not None]
        lines = "".join(f"<dt>{escape(place)}</dt><dd>{escape(text)}</dd>" for place, text in texts)
        folded.append(f"<details><summary>{escape(name)}</summary><dl>{lines}</dl></details>")
    return f'<section id="settings"><h2>Settings of the runs</h2>{"".join(folded)}</section>' if folded else ""


def inlined(data):
    """JSON that no text in it can end early: `</script>` in a name is only an escape."""
    return json.dumps(data, ensure_ascii=False).replace("<", "\\u003c")


def page(results, seeds):
    """The whole page as text, with images of up to `seeds` seeds a method."""
    rows = results.rows
    for column in [*COUNTERS, *KEPT, "peak_rss_mib"]:
        rows[column] = tables.to_numbers(results.file, rows[column])
    labels = records.methods_in_order(rows)
    missing, stale = [], []
    runs = read_runs(results, missing)
    scenes = viewer_scenes(results, rows, labels, runs, missing, seeds)
    figure_section = figures(results, stale)
    derived = derived_tables(results, stale)
    missing += [f"{name}: was not made from the records that are here now, so it is not shown." for name in stale]
    of_scenes = "".join(result_tables(scene, of_scene, [label for label in labels if label in set(of_scene["method"])], runs)
                        for scene, of_scene in rows.groupby("scene", sort=False))
    experiments = ", ".join(distinct(rows["experiment"]))
    title = " / ".join(distinct(found(run, "title") for run in runs.values())) or experiments
    colours = style.pyplot.get_cmap(strip.DIFFERENCE_COLOURS)(numpy.linspace(0, 1, 255), bytes=True)[:, :3].tolist()
    data = inlined({"differenceColours": colours, "scenes": scenes})
    absences = "".join(f"<li>{escape(text)}</li>" for text in missing)
    settings_section = settings(runs)
    sections = [("errors", "Errors and costs", True), ("derived", "Derived tables", derived),
                ("images", "Images", scenes), ("figures", "Figures", figure_section),
                ("settings", "Settings", settings_section)]
    contents = " · ".join(f'<a href="#{anchor}">{name}</a>' for anchor, name, there in sections if there)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy"
      content="default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<title>{escape(experiments)}: {escape(title)}</title>
<style>
{(HERE / "report.css").read_text(encoding="utf-8")}</style>
</head>
<body>
<header>
<h1>{escape(title)}</h1>
{facts(rows, runs)}
{f'<div id="missing"><p>Missing from this folder:</p><ul>{absences}</ul></div>' if missing else ""}
<nav>{contents}</nav>
</header>
<section id="errors">
<h2>Errors and costs</h2>
{scene_table(rows, runs)}
{of_scenes}
<p class="small">RMSE: root of the mean over seeds of the squared error, of <code>mse_unbiased</code> in iterations.csv where it is
without the reference's noise; “below resolution” where that mean is not above 0, less than the reference can tell. relMSE:
mean over seeds of <code>relmse</code>. Seconds and photons: means over seeds. Memory: the largest; that of a process is no
method's own where it made several runs together. A click on a column's name sorts by it.</p>
</section>
{f'<section id="derived"><h2>Derived tables</h2>{derived}</section>' if derived else ""}
{VIEWER.format(left_out=seeds_left_out(rows, runs, seeds), noise=records.noise_note(rows)) if scenes else ""}
{figure_section}
{settings_section}
<script type="application/json" id="data">{data}</script>
<script>
{(HERE / "report.js").read_text(encoding="utf-8")}</script>
</body>
</html>
"""


def whole_positive(text):
    """A whole number above 0 from the command line."""
    value = int(text)
    if value < 1:
        raise ValueError(text)
    return value


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog=__doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path,
                        help="folder of an experiment's results: iterations.csv and runs/ are in it")
    parser.add_argument("--seeds", type=whole_positive, default=2, metavar="N", help="how many seeds of each method the viewer "
                        "has images of, of those with snapshots (default: 2); the page grows with it")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    text = page(results, options.seeds)
    print(f"{files.replace_file(results.folder / 'report.html', text)} ({len(text) / 1e6:.1f} MB)")
    return 0


if __name__ == "__main__":
    files.run(main)
