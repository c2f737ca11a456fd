#!/usr/bin/python3
"""Which of a folder's Mitsuba scenes open, and do PPM and path tracing agree on them: one page.

    scenes/survey.py FOLDER -o PAGE_FOLDER [--program build/release/src/app/photonlab] [--resolution 96x64]

Every .xml that is a scene is given to `photonlab info`. What opens is rendered shortly by both methods, with the same
hit points, and the page says the means of each layer, the time and the picture; of what is refused it says why. Nothing
of the scenes but small pictures goes into the page: one file of all, line by line in the order of its rows.
"""

import argparse
import collections
import pathlib
import re
import subprocess
import time
import xml.etree.ElementTree

import numpy
import OpenImageIO

LAYERS = ("direct", "gathered")
PICTURES, PICTURES_A_LINE = "pictures.jpg", 12
METHODS = {
    "path": ["--integrator", "path", "--passes", "64"],
    "ppm": ["--integrator", "ppm", "--passes", "16", "--photons", "100000", "--direct-samples", "4"],
}


def is_scene(file):
    """True for a whole scene: those that others include have no sensor or no shape of their own."""
    try:
        root = xml.etree.ElementTree.parse(file).getroot()
    except (xml.etree.ElementTree.ParseError, UnicodeDecodeError):
        return False
    tags = {child.tag for child in root}
    return root.tag == "scene" and bool(tags & {"sensor", "include"}) and bool(tags & {"shape", "include"})


def run(words, seconds):
    """The program's answer: whether it went well, its last line, and the time it took."""
    begin = time.monotonic()
    try:
        result = subprocess.run(words, capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return False, f"took more than {seconds} s", seconds
    said = (result.stderr if result.returncode else result.stdout).strip().splitlines() or [""]
    return result.returncode == 0, said[-1].removeprefix("photonlab: "), time.monotonic() - begin


def layer_means(file):
    """Mean of each layer's green channel."""
    image = OpenImageIO.ImageInput.open(str(file))
    spec = image.spec()
    names = list(spec.channelnames)
    pixels = numpy.asarray(image.read_image(OpenImageIO.FLOAT)).reshape(spec.height, spec.width, spec.nchannels)
    return {layer: float(pixels[:, :, names.index(f"{layer}.G")].mean()) for layer in LAYERS}


def reason_of(message, folder):
    """Why a scene was refused, without where: so that the same reasons are counted together."""
    message = message.replace(f"{folder}/", "")
    message = re.sub(r"^\S*:\d+: ", "", message)
    return re.split(r"[;?] ?[Kk]nown here", message)[0]


def render_both(arguments, file, number):
    """One row of the page for a scene that opens."""
    row = {"": str(number + 1), "scene": str(file.relative_to(arguments.folder))}
    for method, options in METHODS.items():
        image = arguments.output / f"{number}-{method}.exr"
        picture = arguments.output / f"{number}.png"
        words = [arguments.program, "render", str(file), "-o", str(image), "--png", str(picture), *options]
        done, said, seconds = run([*words, "--resolution", arguments.resolution], arguments.seconds)
        row[f"{method} s"] = f"{seconds:.1f}"
        if done:
            for layer, mean in layer_means(image).items():
                row[f"{method} {layer}"] = mean
            image.unlink()
        else:
            row.setdefault("note", f"{method}: {reason_of(said, arguments.folder)}")
    for layer in LAYERS:
        path, ppm = row.get(f"path {layer}"), row.get(f"ppm {layer}")
        if path and ppm:
            row[f"{layer} ppm/path"] = f"{ppm / path:.3f}"
    return row


def join_pictures(arguments, count):
    """The pictures of the rows in one, where there are any; a place stays black where neither method could render."""
    width, height = map(int, arguments.resolution.split("x"))
    lines = -(-count // PICTURES_A_LINE)
    sheet = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(PICTURES_A_LINE * width, lines * height, 3, OpenImageIO.UINT8))
    for number in range(count):
        picture = arguments.output / f"{number}.png"
        if picture.is_file():
            OpenImageIO.ImageBufAlgo.paste(sheet, number % PICTURES_A_LINE * width, number // PICTURES_A_LINE * height, 0, 0,
                                           OpenImageIO.ImageBuf(str(picture)))
            picture.unlink()
    sheet.write(str(arguments.output / PICTURES))


def write_page(arguments, rows, refused):
    """What opened, row by row, and what did not, reason by reason."""
    columns = ["", "scene", "direct ppm/path", "gathered ppm/path", "path s", "ppm s", "note"]
    total = len(rows) + sum(len(files) for files in refused.values())
    lines = [f"{len(rows)} of {total} scenes open. Means are of the green channel at {arguments.resolution}.", "",
             f"![The pictures of all that open, {PICTURES_A_LINE} a line]({PICTURES})", ""]
    lines += ["| " + " | ".join(columns) + " |", "| " + " | ".join("---" for _ in columns) + " |"]
    lines += ["| " + " | ".join(str(row.get(column, "")) for column in columns) + " |" for row in rows]
    lines += ["", "| refused | why | for example |", "| --- | --- | --- |"]
    for reason, files in sorted(refused.items(), key=lambda item: -len(item[1])):
        lines.append(f"| {len(files)} | {reason} | {files[0].relative_to(arguments.folder)} |")
    (arguments.output / "README.md").write_text("\n".join(lines) + "\n")


def main():
    """Looks at every scene of the folder."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("-o", dest="output", type=pathlib.Path, required=True)
    parser.add_argument("--program", default="build/release/src/app/photonlab")
    parser.add_argument("--resolution", default="96x64")
    parser.add_argument("--seconds", type=float, default=120.0, help="that a render may take")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows, refused = [], collections.defaultdict(list)
    for file in sorted(filter(is_scene, arguments.folder.rglob("*.xml"))):
        opens, said, _ = run([arguments.program, "info", str(file), "--resolution", "16x16"], arguments.seconds)
        if opens:
            rows.append(render_both(arguments, file, len(rows)))
        else:
            refused[reason_of(said, arguments.folder)].append(file)
        write_page(arguments, rows, refused)
    join_pictures(arguments, len(rows))
    print(f"wrote {arguments.output / 'README.md'}: {len(rows)} scenes open")


if __name__ == "__main__":
    main()
