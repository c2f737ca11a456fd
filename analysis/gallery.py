"""Draws what methods make of scenes as passes go by: a column a recorded pass, two rows a scene (PPM above, PM at the same
photons below), the reference at the right, and under each picture its RMSE and the seconds that it took.

Pass 0 is emission and direct light alone, before the first photon. The RMSE is free of the reference's noise where the
reference has two halves; the seconds are those of the passes, as in the records.
"""

import argparse
import sys
from pathlib import Path

try:
    import files
    import pictures
    import records
    import style
    from files import InputError
except ImportError as error:
    print(f"{sys.executable}: {error}; expected an interpreter with numpy, pandas, matplotlib and OpenImageIO (on "
          "Debian: /usr/bin/python3 with python3-pandas, python3-xxhash, python3-matplotlib and python3-openimageio)", file=sys.stderr)
    sys.exit(2)

ROW_ORDER = ["ppm", "photonmapper", "path"]    # the progressive method above its baseline
CELL = 1.5              # inches
GAP = 0.05
TEXT = 0.2              # under each picture
LEFT, TOP, SCENE_GAP = 0.32, 0.3, 0.12


def caption(rows):
    """ "RMSE 0.012, 3.4 s" of one recorded pass."""
    parts = []
    if not rows["mse"].isna().all():
        value = rows[records.error_column(rows)].iloc[0]
        name = records.error_name(records.error_column(rows))
        parts.append(f"{name} {style.two_digits(records.root(value))}" if value > 0 else "below resolution")
    parts.append(f"{style.two_digits(rows['seconds'].iloc[0])} s")
    return ", ".join(parts)


def methods_of(scene_rows, labels):
    """Labels of a scene's methods, PPM first."""
    first_rows = scene_rows.drop_duplicates("method").set_index("method")
    own = [label for label in labels if label in first_rows.index]
    return sorted(own, key=lambda label: ROW_ORDER.index(first_rows.loc[label]["integrator"]))


def lit_by_scene(picture, snapshot):
    """A picture with the lights themselves, which a snapshot shows apart, blacked out: what the exposure is chosen for."""
    emission = pictures.read_component(snapshot, "emission")
    return picture if emission is None else picture * (emission.max(axis=2, keepdims=True) <= 0)


def collect(results, scene, rows, labels):
    """[(label, {pass: (image, caption)})] of a scene's lowest seeds, its reference or None, and the exposure for it."""
    found, reference, exposure = [], None, None
    for label in methods_of(rows, labels):
        of_method = rows[rows["method"] == label]
        of_run = of_method[of_method["seed"] == of_method["seed"].min()]
        run = of_run["run"].iloc[0]
        total = of_run[of_run["component"] == "total"]
        images, by_pass = {}, results.run(run).snapshots
        for number, file in by_pass.items():
            of_pass = total[total["pass"] == number]
            if not of_pass.empty:
                images[number] = (pictures.read_component(file, "total"), caption(of_pass))
        if images:
            found.append((label, images))
        else:
            print(f"{scene}: {label}: no snapshots, so not in the gallery")
        if reference is None and images:
            judge, (snapshot, *_) = records.reference_of(results, results.run(run).description), by_pass.values()
            reference = pictures.read_reference(judge.halves, "total", False) if judge else None
            if reference is not None:
                pictures.require_same_size(snapshot, next(iter(images.values()))[0], judge.halves[0], reference)
                exposure = pictures.exposure_for(lit_by_scene(reference, snapshot))
    if found and exposure is None:
        exposure = pictures.exposure_for(list(found[0][1].values())[-1][0])
    return found, reference, exposure


def draw(scenes, given_exposure, note):
    """The figure of [(scene, methods, reference, exposure)], with a note in small print below."""
    style.use()
    style.pyplot.rcParams["axes.grid"] = False
    passes = sorted({number for _, methods, *_ in scenes for _, images in methods for number in images})
    has_reference = any(reference is not None for _, _, reference, _ in scenes)
    columns = len(passes) + has_reference
    width = LEFT + columns * (CELL + GAP)
    rows = sum(len(methods) for _, methods, *_ in scenes)
    height = TOP + rows * (CELL + TEXT) + len(scenes) * SCENE_GAP + (TEXT if note else 0)
    figure = style.pyplot.figure(figsize=(width, height))

    def add_picture(image, x, y, scale):
        axes = figure.add_axes([x / width, 1 - (y + CELL) / height, CELL / width, CELL / height])
        axes.imshow(pictures.to_srgb(image, scale))
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(True)
        return axes

    for column, name in enumerate([f"pass {number}" for number in passes] + ["reference"] * has_reference):
        figure.text((LEFT + column * (CELL + GAP) + CELL / 2) / width, 1 - 0.2 / height, name, ha="center", fontsize=9)
    y = TOP
    for scene, methods, reference, exposure in scenes:
        scale = given_exposure or exposure
        for row, (label, images) in enumerate(methods):
            figure.text(0.24 / width, 1 - (y + CELL / 2) / height, f"{scene}\n{label}", rotation=90, ha="right",
                        va="center", fontsize=7.5, linespacing=1.1)
            for column, number in enumerate(passes):
                if number not in images:
                    continue
                image, text = images[number]
                axes = add_picture(image, LEFT + column * (CELL + GAP), y, scale)
                axes.set_xlabel(text, fontsize=7, labelpad=2)
            if reference is not None and row == 0:
                add_picture(reference, LEFT + len(passes) * (CELL + GAP), y, scale)
            y += CELL + TEXT
        y += SCENE_GAP
    figure.text(LEFT / width, 0.06 / height, note, fontsize=7, color="#333333")
    return figure


@files.command
def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Writes RESULTS_DIR/figures/gallery.png and .pdf.\n\n" +
                                     __doc__.split("\n\n", 1)[1])
    parser.add_argument("results", metavar="RESULTS_DIR", type=Path,
                        help="folder of an experiment's results: iterations.csv and runs/ are in it")
    parser.add_argument("--exposure", type=style.positive, metavar="E",
                        help="factor on radiance (default: for each scene, 97%% of what its lights light is below white)")
    options = parser.parse_args(arguments)
    results = records.read(options.results)
    rows = results.rows
    labels = records.methods_in_order(rows)
    scenes = []
    for scene, scene_rows in rows.groupby("scene", sort=False):
        methods, reference, exposure = collect(results, scene, scene_rows, labels)
        if methods:
            scenes.append((scene, methods, reference, exposure))
    if not scenes:
        raise InputError(f"{results.folder}: no snapshots; expected some in the experiment file")
    for file in style.save(draw(scenes, options.exposure, records.noise_note(rows)), results.folder, "gallery", results.hash):
        print(file)
    return 0


if __name__ == "__main__":
    files.run(main)
