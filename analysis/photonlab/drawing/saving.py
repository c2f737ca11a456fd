"""Figures as files, which say in their metadata which records they were made from."""

import io
import shutil
import struct
from dataclasses import dataclass
from pathlib import Path

from matplotlib import pyplot
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from photonlab.drawing.style import CAPTION
from photonlab.records import files
from photonlab.records.files import InputError

RECORDS = "photonlab.records"    # what the metadata has the hash of the records under
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# What a file is written with, whatever a figure was drawn with.
WRITING = {"savefig.dpi": 300, "pdf.fonttype": 42, "pgf.texsystem": "pdflatex", "pgf.rcfonts": False}


@dataclass
class Drawn:
    """A figure and the name that its files have."""
    name: str
    figure: Figure


def save(drawn, results, folder=None, formats=("png", "pdf"), caption=True):
    """Writes NAME.png and so on, in figures/ of the folder of results, which are anything with a folder and a hash, or in another
    folder; yields the names. The same records give the same bytes: no date. Without its caption a figure ends above it, and the text
    is yielded."""
    box, text = (None, "") if caption else above_caption(drawn.figure)
    data = {kind: data_of(drawn.figure, kind, results.hash, box) for kind in formats}
    pyplot.close(drawn.figure)
    for kind, written in data.items():
        yield files.replace_file(Path(folder or results.folder / "figures") / f"{drawn.name}.{kind}", written)
    if text:
        yield f"caption: {text}"


def data_of(figure, kind, records, box):
    """The bytes of a figure's file."""
    metadata = {"png": {"metadata": {"Software": None, RECORDS: records}},
                "pdf": {"metadata": {"CreationDate": None, "Creator": None, "Producer": None, "Keywords": f"{RECORDS} {records}"}},
                "pgf": {}}[kind]    # which has a comment in place of metadata
    if kind == "pgf" and not shutil.which(WRITING["pgf.texsystem"]):
        raise InputError("--format pgf: there is no pdflatex, which measures its text; expected LaTeX with PGF (on Debian: "
                         "texlive-latex-base and texlive-pictures)")
    stream = io.BytesIO()
    with pyplot.rc_context(WRITING):
        figure.savefig(stream, format=kind, bbox_inches=box, **metadata)
    return (f"% {RECORDS} {records}\n".encode() if kind == "pgf" else b"") + stream.getvalue()


def above_caption(figure):
    """(what is above a figure's caption, in inches; the text of the caption). The caption is taken away."""
    width, height = figure.get_size_inches()
    captions = [text for text in figure.texts if text.get_gid() == CAPTION]
    for caption in captions:
        caption.remove()
    top = max((caption.get_position()[1] * height for caption in captions), default=0.0)
    return Bbox.from_extents(0, top, width, height), " ".join(" ".join(caption.get_text().split("\n")) for caption in captions)


def drawn_of_scenes(name, figures, nothing="", ending=""):
    """Figures, pairs of a scene's name and its figure, as NAME-SCENE, with the ending; where there is no figure of a scene, that there
    is `nothing`."""
    for scene, figure in figures:
        if figure is None:
            yield f"{scene}: {nothing}"
        else:
            yield Drawn(f"{name}-{files.as_file_name(scene)}{ending}", figure)


def records_of_png(data):
    """The hash of the records that a figure says it was made from; None where it says nothing."""
    place = len(PNG_SIGNATURE)
    while data.startswith(PNG_SIGNATURE) and place + 8 <= len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        keyword, _, text = data[place + 8:place + 8 + length].partition(b"\0")
        if kind == b"tEXt" and keyword == RECORDS.encode():
            return text.decode("latin-1")
        place += length + 12    # with the checksum behind it
    return None
