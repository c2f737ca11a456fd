"""Figures as files, which say in their metadata which records they were made from."""

import io
import struct

from matplotlib import pyplot

from photonlab.records import files

RECORDS = "photonlab.records"    # what the metadata has the hash of the records under
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def save(figure, results, name):
    """Writes figures/NAME.png and .pdf in the folder of results, which are anything with a folder and a hash; returns both names.
    The same records give the same bytes: no date."""
    drawn = {"png": io.BytesIO(), "pdf": io.BytesIO()}
    figure.savefig(drawn["png"], format="png", metadata={"Software": None, RECORDS: results.hash})
    figure.savefig(drawn["pdf"], format="pdf", metadata={"CreationDate": None, "Creator": None, "Producer": None,
                                                         "Keywords": f"{RECORDS} {results.hash}"})
    pyplot.close(figure)
    return [files.replace_file(results.folder / "figures" / f"{name}.{kind}", data.getvalue()) for kind, data in drawn.items()]


def save_scenes(results, name, figures, nothing="", ending=""):
    """Saves figures, pairs of a scene's name and its figure, as figures/NAME-SCENE, with the ending; yields the files' names, and
    where there is no figure of a scene, that there is `nothing`."""
    for scene, figure in figures:
        if figure is None:
            yield f"{scene}: {nothing}"
        else:
            yield from save(figure, results, f"{name}-{files.as_file_name(scene)}{ending}")


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
