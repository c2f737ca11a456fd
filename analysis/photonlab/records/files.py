"""Every file that the analysis reads or writes.

Only an ordinary file is opened to be read: a pipe would wait for a writer, and a device may have no end. A file is written under
a random name beside its own, brought to the disk and renamed, so that a full disk or a kill at any instant leaves the old file or
the new one, never a half. What goes wrong is an InputError, which names the file.
"""

import contextlib
import errno
import fcntl
import json
import os
import re
import secrets
import stat
import struct
from pathlib import Path

LARGEST_TEXT = 2 ** 31    # bytes


class InputError(Exception):
    """What cannot be used, read or written. The message names the file and says what was expected."""


def reason(error):
    """Why the system refused."""
    return error.strerror or str(error) if isinstance(error, OSError) else str(error)


# Reading.

@contextlib.contextmanager
def opened(file):
    """The file as a stream of bytes."""
    try:
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    except (OSError, ValueError) as error:    # ValueError: a NUL in the name
        raise InputError(f"{file}: cannot be read: {reason(error)}") from error
    kind = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(kind):
        os.close(descriptor)
        raise InputError(f"{file}: expected a file, this is a {'folder' if stat.S_ISDIR(kind) else 'pipe or a device'}")
    with open(descriptor, "rb") as stream:
        yield stream


def read_bytes(file):
    """As many bytes as the file has: a file of the kernel's has none, and would be waited for."""
    with opened(file) as stream:
        size = os.fstat(stream.fileno()).st_size
        if size > LARGEST_TEXT:
            raise InputError(f"{file}: expected at most {LARGEST_TEXT} bytes, got {size}")
        try:
            return stream.read(size)
        except OSError as error:
            raise InputError(f"{file}: cannot be read: {reason(error)}") from error


def read_piece(file, stream, size):
    """The next bytes of a file by the stream that `opened` gives, at most so many."""
    try:
        return stream.read(size)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {reason(error)}") from error


def read_text(file):
    return text_in(file, read_bytes(file))


def read_json(file):
    return json_in(file, read_bytes(file))


def text_in(file, data):
    """The bytes of a file as text."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not text in UTF-8: byte {error.start + 1} is no part of it") from error


def json_in(file, data):
    """What the bytes of a file are in JSON. Its texts can be written again."""
    text = text_in(file, data)
    try:
        value = json.loads(text)
        json.dumps(value, ensure_ascii=False).encode("utf-8")    # which half a surrogate pair is not
        return value
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: is not JSON: {error}") from error


def is_there(file):
    """True when there is anything of that name, be it what cannot be read."""
    try:
        os.lstat(file)
        return True
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: cannot be read: {reason(error)}") from error


# Writing. Temporary names, and the lock by which one that is being written is told from one that a killed process left, are those
# of the program (src/core/files/temporary_file.h), so that each removes what the other left.

INFIX = ".partial-"    # followed by random digits
DIGITS = 16            # hexadecimal
LONGEST_NAME = 255     # bytes
LOCK = struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, 1 << 62, 1, 0)    # of a byte that nobody writes


def replace_file(file, data):
    """Replaces the file, or makes it with its folder, by `data`: text or bytes."""
    file = Path(file)
    if isinstance(data, str):
        data = data.encode("utf-8", errors="backslashreplace")    # of a name that is not UTF-8
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(file.parent)
        temporary, stream = new_temporary(file)
        try:
            with stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
                os.replace(temporary, file)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: cannot be written: {reason(error)}") from error
    return file


def new_temporary(file):
    """(name, stream) of a new file beside this one, held until it is closed."""
    while True:
        start = os.fsencode(file.name)[:LONGEST_NAME - len(INFIX) - DIGITS].decode("utf-8", errors="ignore")
        temporary = file.parent / f"{start}{INFIX}{secrets.token_hex(DIGITS // 2)}"
        stream = open(os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666), "wb")
        # Who looks for leftovers may have been there between the two, and then removes it.
        if is_held_by_us(stream.fileno()) is not False and is_named(stream.fileno(), temporary):
            return temporary, stream
        stream.close()


def remove_leftovers(folder):
    """Removes the temporary files in a folder that no process is writing."""
    for entry in os.scandir(folder):
        if re.fullmatch(f".*{re.escape(INFIX)}[0-9a-f]{{{DIGITS}}}", entry.name, re.DOTALL):
            with contextlib.suppress(OSError):
                descriptor = os.open(entry.path, os.O_RDWR | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
                try:
                    # Its writer may have renamed it, and let go of it, since the folder was read.
                    if is_held_by_us(descriptor) and is_named(descriptor, entry.path):
                        os.unlink(entry.path)
                finally:
                    os.close(descriptor)


def is_held_by_us(descriptor):
    """True once it is locked, as long as it is open; False when somebody else has it; None where there are no locks."""
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, LOCK)
        return True
    except OSError as error:
        return False if error.errno in (errno.EAGAIN, errno.EACCES) else None


def is_named(descriptor, file):
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(file, follow_symlinks=False))
    except FileNotFoundError:
        return False


def remove_file(file):
    """Removes what an earlier call wrote, if it is there."""
    try:
        Path(file).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{file}: cannot be removed: {reason(error)}") from error


def as_file_name(text):
    """A scene's name as part of a file's name."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in text)
