"""Draws what the numbers of a run look like: for every scene the images of PM, of PPM and of the reference side by
side, and under each how it differs from the reference.

Differences keep their sign, so that bias (a region all of one colour) can be told from noise (both colours mixed). They
share one scale. Under each image are its pass and its RMSE from iterations.csv: unbiased where the reference has two
halves.
"""

import argparse
import sys
import textwrap
from pathlib import Path

try:
    import files
    import numpy
    import pictures
    import records
    import style
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

COMPONENT_TITLES = {"total": "whole image", "emission": "emission alone", "direct": "direct light alone",
                    "gathered": "gathered light alone"}
DIFFERENCE_COLOURS = "PuOr_r"    # both ends dark, zero white: in grey the size of an error stays, its sign goes
SMALLEST_CELL = 1.1              # inches; many methods make a wider figure, not smaller pictures


def shown_methods(scene_rows, labels, alphas, all_methods):
    """The first method of each kind (PM by radius, PM by k, PPM, ...); or all; or of PPM those with given alphas."""
    first_rows = scene_rows.drop_duplicates("method").set_index("method")
    shown, kinds = [], set()
    for label in labels:
        row = first_rows.loc[label]
        kind = style.kind(row)
        chosen = records.as_number(row["alpha"]) in alphas if alphas and row["alpha"] else kind not in kinds
        if all_methods or chosen:
            shown.append(label)
            kinds.add(kind)
    return shown


def snapshots_of(results, scene_rows, label, seed):
    """Run, run.json, {pass: file} of a method's run with a given seed (None: the lowest); None without such a run."""
    rows = scene_rows[scene_rows["method"] == label]
    rows = rows[rows["seed"] == (rows["seed"].min() if seed is None else seed)]
    if rows.empty:
        return None
    run = rows["run"].iloc[0]
    return run, results.run(run).description, results.run(run).snapshots


def chosen_pass(passes_of_methods, wanted):
    """The wanted pass, or the last one of which every method has a snapshot; None where there is no such pass."""
    if wanted is not None:
        return wanted
    common = set.intersection(*passes_of_methods) if passes_of_methods else set()
    return max(common) if common else None


def error_text(scene_rows, run, number, component):
    """ "RMSE 0.012" for the snapshot, from the records."""
    rows = scene_rows[(scene_rows["run"] == run) & (scene_rows["pass"] == number) &
                      (scene_rows["component"] == component)]
    if rows.empty or rows["mse"].isna().all():
        return ""
    column = records.error_column(rows)
    value = rows[column].iloc[0]
    return f"{records.error_name(column)} {style.two_digits(records.root(value))}" if value > 0 else "below resolution"


def collect(results, scene, scene_rows, labels, options):
    """What there is to draw: a list of (label, text below, image, difference or None); the reference or None; the RMSE
    of its floor (NaN without halves). Says what is left out."""
    found = {}
    for label in shown_methods(scene_rows, labels, options.alpha, options.all):
        snapshots = snapshots_of(results, scene_rows, label, options.seed)
        if snapshots and snapshots[2]:
            found[label] = snapshots
        else:
            seed = "" if options.seed is None else f" with seed {options.seed}"
            print(f"{scene}: {label}: no snapshots of a run{seed}, so not in the strip")
    common = chosen_pass([set(by_pass) for *_, by_pass in found.values()], getattr(options, "pass"))

    entries, reference, floor = [], None, 0.0
    for label, (run, record, by_pass) in found.items():
        number = max(by_pass) if common is None else common
        if number not in by_pass:
            present = ", ".join(map(str, sorted(by_pass)))
            print(f"{scene}: {label}: no snapshot of pass {number}; there are those of {present}")
            continue
        rows = scene_rows[scene_rows["run"] == run]
        carried = rows["direct"].iloc[0] == "photons"
        image = pictures.read_component(by_pass[number], options.component)
        if image is None:
            print(f"{scene}: {label}: {by_pass[number]} has no layer {options.component}")
            continue
        judge = records.reference_of(results, record)
        own_reference = pictures.read_reference(judge.halves, options.component, carried) if judge else None
        if own_reference is None:
            print(f"{scene}: {label}: no reference for the {COMPONENT_TITLES[options.component]}" +
                  (f": {judge.path} {judge.why_not or 'has none'}" if judge else "") + ", so no difference")
        else:
            pictures.require_same_size(by_pass[number], image, judge.halves[0], own_reference)
        if reference is None and own_reference is not None:
            reference = own_reference
            floor = records.root(rows[rows["component"] == options.component]["reference_floor"].max())
        difference = None if own_reference is None else (image - own_reference).mean(axis=2)
        below = [f"pass {number}", error_text(scene_rows, run, number, options.component)]
        entries.append((label, "\n".join(filter(None, below)), image, difference))
    return entries, reference, floor


def draw_strip(title, entries, reference, floor, exposure, noise):
    """The figure: images above, differences below, the reference last with the colour bar under it."""
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    differences = [difference for *_, difference in entries if difference is not None]
    columns = len(entries) + (reference is not None)
    width = max(style.FULL_WIDTH, columns * SMALLEST_CELL)
    cell = min((width - 0.2) / columns - 0.06, 2.6)
    picture_height, picture_width = entries[0][2].shape[:2]
    cell_height = cell * picture_height / picture_width
    names = [textwrap.wrap(label, max(12, int(cell * 14))) for label, *_ in entries]
    top = 0.3 + 0.15 * max(map(len, names))
    note = f"Pictures: radiance × {exposure:.3g}, sRGB."
    if differences:
        note += " Differences: mean over R, G, B."
    if floor > 0:
        note += f" Floor of the reference: RMSE {style.two_digits(floor)}."
    note = textwrap.wrap(f"{note} {noise}", int(104 * width / style.FULL_WIDTH))
    text, caption = 0.36, 0.12 + 0.13 * len(note)
    rows = 2 if differences else 1
    height = top + rows * cell_height + text + (0.08 if rows > 1 else 0) + caption

    figure = style.pyplot.figure(figsize=(width, height))

    def add_picture(column, row):
        x, y = 0.1 + column * (cell + 0.06), top + row * (cell_height + 0.08)
        axes = figure.add_axes([x / width, 1 - (y + cell_height) / height, cell / width, cell_height / height])
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(True)
        return axes

    largest = max([numpy.percentile(numpy.abs(difference[numpy.isfinite(difference)]), 99)
                   for difference in differences if numpy.isfinite(difference).any()], default=0.0)
    largest = largest or 1.0    # nothing differs
    colours = style.pyplot.get_cmap(DIFFERENCE_COLOURS).copy()
    colours.set_bad("#ff00ff")
    mapped = None
    for column, ((label, below, image, difference), name) in enumerate(zip(entries, names)):
        axes = add_picture(column, 0)
        axes.imshow(pictures.to_srgb(image, exposure))
        axes.set_title("\n".join(name), fontsize=8.5)
        if difference is not None:
            axes = add_picture(column, 1)
            mapped = axes.imshow(difference, cmap=colours, vmin=-largest, vmax=largest)
        axes.set_xlabel(below, fontsize=8, labelpad=3)
    if reference is not None:
        axes = add_picture(len(entries), 0)
        axes.imshow(pictures.to_srgb(reference, exposure))
        axes.set_title("reference", fontsize=8.5)
    if mapped is not None:
        x = 0.1 + len(entries) * (cell + 0.06)
        y = top + cell_height + 0.08
        heading = 0.25
        figure.text((x + 0.05) / width, 1 - y / height, "image − reference", fontsize=8, va="top")
        bar = figure.add_axes([(x + 0.05) / width, 1 - (y + cell_height) / height, 0.12 / width,
                               (cell_height - heading) / height])
        beyond = any((numpy.abs(difference) > largest).any() for difference in differences)
        figure.colorbar(mapped, cax=bar, extend="both" if beyond else "neither", ticks=[-largest, 0, largest])
        limit = style.two_digits(largest)
        bar.set_yticklabels([f"−{limit}", "0", f"+{limit}"], fontsize=8)
        bar.tick_params(length=2)
    figure.text(0.1 / width, 1 - 0.05 / height, title, va="top", fontsize=9.5)
    figure.text(0.1 / width, 0.05 / height, "\n".join(note), fontsize=7.5, color="#333333", linespacing=1.25)
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="Writes RESULTS_DIR/figures/strip-SCENE.png and .pdf (strip-SCENE-COMPONENT for a single component)."
        "\n\n" + __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path,
                        help="folder of an experiment's results: iterations.csv and runs/ are in it")
    parser.add_argument("--pass", type=int, metavar="N",
                        help="pass to show (default: the last one that all methods have)")
    parser.add_argument("--seed", type=int, metavar="S", help="seed to show (default: each method's lowest)")
    parser.add_argument("--alpha", type=style.positive, nargs="+", default=[], metavar="A",
                        help="alphas of PPM to show (default: the lowest)")
    parser.add_argument("--all", action="store_true", help="show every method, not the first one of each kind")
    parser.add_argument("--component", choices=records.COMPONENTS, default="total",
                        help="what to show (default: total)")
    parser.add_argument("--exposure", type=style.positive, metavar="E",
                        help="factor on radiance in the pictures (default: 97%% of the lit pixels are below white)")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    rows = results.rows
    labels = records.methods_in_order(rows)
    for scene, scene_rows in rows.groupby("scene", sort=False):
        own_labels = [label for label in labels if label in set(scene_rows["method"])]
        entries, reference, floor = collect(results, scene, scene_rows, own_labels, options)
        if not entries:
            print(f"{scene}: nothing to show, so no strip")
            continue
        exposure = options.exposure or pictures.exposure_for(entries[0][2] if reference is None else reference)
        title = f"{scene}: {COMPONENT_TITLES[options.component]}"
        figure = draw_strip(title, entries, reference, floor, exposure, records.noise_note(scene_rows))
        suffix = "" if options.component == "total" else f"-{options.component}"
        for file in style.save(figure, results.folder, f"strip-{records.file_name(scene)}{suffix}", results.hash):
            print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
