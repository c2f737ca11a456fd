"""How a results folder's files are known again: by their size and the hash of their bytes, XXH3 of 128 bits, which the program wrote
down where it names them (src/core/files/kept_files.h). What is read here is what was written, or is refused.

Folders of programs before this was so have no stamps; theirs are read as they are.
"""

import contextlib
import os
from dataclasses import dataclass
from pathlib import Path

import xxhash

from photonlab.records import files
from photonlab.records.files import InputError

BEFORE_CHECKSUM, AFTER_CHECKSUM = b',\n  "checksum": "', b'"\n}\n'    # of a JSON file, in which it stands last
PIECE = 1 << 20    # bytes
RUN_AGAIN = "run the experiment again, which makes nothing anew that is as it was"


def hash_of(data):
    return xxhash.xxh3_128_hexdigest(data)


def running_hash(start):
    """The hash of bytes that come in pieces, which update() takes."""
    return xxhash.xxh3_128(start)


def hash_of_stream(file, stream):
    hashed = running_hash(b"")
    while piece := files.read_piece(file, stream, PIECE):
        hashed.update(piece)
    return hashed.hexdigest()


def hash_of_file(file):
    with files.opened(file) as stream:
        return hash_of_stream(file, stream)


@dataclass(frozen=True)
class KeptFile:
    """A file as it was written, and what to do where it is another one now."""
    path: Path
    size: int    # bytes; None where it is not known
    hash: str
    advice: str

    def __str__(self):
        return str(self.path)

    def __fspath__(self):
        return os.fspath(self.path)


def kept_file(path, stamp, advice):
    """The file with its stamp in JSON; as it is where there is no such stamp."""
    if not (isinstance(stamp, dict) and isinstance(stamp.get("bytes"), int) and isinstance(stamp.get("hash"), str)):
        raise InputError(f"{path}: expected to be listed with its bytes and hash; {advice}")
    return KeptFile(path, stamp["bytes"], stamp["hash"], advice)


@contextlib.contextmanager
def opened(file):
    """As files.opened(); of a KeptFile, checked."""
    with files.opened(file) as stream:
        if isinstance(file, KeptFile):
            size = os.fstat(stream.fileno()).st_size
            if file.size not in [None, size]:
                raise InputError(f"{file}: has {size} bytes, and had {file.size} when it was written; {file.advice}")
            if hash_of_stream(file, stream) != file.hash:
                raise InputError(f"{file}: is not what was written: its checksum is another; {file.advice}")
            stream.seek(0)
        yield stream


SEAL_START, SEAL_DIGITS = b"photonlab.checksum\0string\0", 32    # of an EXR that knows its own checksum, 4 bytes between them
LARGEST_HEADER = 1 << 24


def require_seal(file, stream, advice):
    """Throws InputError unless an EXR is what the checksum in its own attributes was taken of, with zeros in its place
    (src/image/exr.h)."""
    start = stream.read(LARGEST_HEADER)
    place = start.find(SEAL_START) + len(SEAL_START) + 4
    stored = start[place:place + SEAL_DIGITS]
    hashed = running_hash(start[:place] + SEAL_DIGITS * b"0" + start[place + SEAL_DIGITS:])
    while piece := stream.read(PIECE):
        hashed.update(piece)
    if stored != hashed.hexdigest().encode():
        raise InputError(f"{file}: is not what was written: its checksum is another; {advice}")
    stream.seek(0)


def read_json(file, advice, must_be_checked):
    """What the file holds, which is what was written where it ends with its checksum, as it must unless it is of an earlier
    program."""
    data = files.read_bytes(file)
    before, found, after = data.rpartition(BEFORE_CHECKSUM)
    is_checked = after == hash_of(before).encode() + AFTER_CHECKSUM
    if not is_checked and (found or must_be_checked):
        raise InputError(f"{file}: is not what was written: its checksum is another; {advice}")
    return files.json_in(file, data)
