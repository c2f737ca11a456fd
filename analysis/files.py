"""Every file that the analysis reads or writes.

Only an ordinary file is opened to be read: a pipe would wait for a writer, and a device may have no end. A file is written under
a random name beside its own, brought to the disk and renamed, so that a full disk or a kill at any instant leaves the old file or
the new one, never a half. What goes wrong is an InputError, which names the file; `command` makes of it the one line and the exit
code that a command ends with.
"""

import contextlib
import functools
import json
import os
import secrets
import signal
import stat
import sys
import warnings
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


def read_text(file):
    try:
        return read_bytes(file).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not text in UTF-8: byte {error.start + 1} is no part of it") from error


def read_json(file):
    """What the file holds, whose texts can be written again."""
    text = read_text(file)
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


# Writing.

def replace_file(file, data):
    """Replaces the file, or makes it with its folder, by `data`: text or bytes."""
    file = Path(file)
    if isinstance(data, str):
        data = data.encode("utf-8", errors="backslashreplace")    # of a name that is not UTF-8
    temporary = file.parent / f".photonlab-{secrets.token_hex(16)}.partial"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        try:
            with open(descriptor, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(descriptor)
            os.replace(temporary, file)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: cannot be written: {reason(error)}") from error
    return file


def remove_file(file):
    """Removes what an earlier call wrote, if it is there."""
    try:
        Path(file).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{file}: cannot be removed: {reason(error)}") from error


# Commands.

def command(main):
    """A command's `main`, which ends with an exit code and at most one line of error: 2 for what the user can mend."""
    @functools.wraps(main)
    def ended(arguments):
        try:
            return main(arguments)
        except InputError as error:
            return complain(str(error))
        except OSError as error:
            if error.filename is None:
                raise
            return complain(f"{os.fsdecode(error.filename)}: {reason(error)}")
        except MemoryError:
            return complain("what is to be drawn does not fit into memory")
    return ended


def complain(message):
    with contextlib.suppress(OSError):
        print(" ".join(message.split("\n")), file=sys.stderr)
    return 2


def end_by_signal(number, _):
    raise SystemExit(128 + number)    # so that what is half written is removed


def run(main):
    """Calls a command with the arguments of the command line, and ends."""
    for stream in filter(None, [sys.stdout, sys.stderr]):
        stream.reconfigure(errors="backslashreplace")    # names that are not UTF-8, and terminals that are not
    for number in [signal.SIGTERM, signal.SIGHUP, signal.SIGINT]:
        signal.signal(number, end_by_signal)
    warnings.filterwarnings("ignore", "Glyph .* missing")    # a box is drawn for it
    try:
        code = main(sys.argv[1:])
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        # Of the standard output: files have their own messages. A reader that has enough is no mistake.
        code = 0 if isinstance(error, BrokenPipeError) else complain(f"the standard output cannot be written: {reason(error)}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)    # for what is left of it
    sys.exit(code)
