"""Files that appear under their name whole: written beside it, brought to the disk, then named.

What is written beside is called ``.NAME.xxxxxxxx.part``; a kill may leave it, and the next writer of
that name removes it.
"""

from __future__ import annotations

import errno
import os
import re
import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.archive.errors import ArchiveError, ArchiveExistsError
from continuation.archive.locks import is_held
from continuation.arguments.checks import complain

_ABANDONED = 60.0
"""Seconds after which a part that nobody holds a lock on is litter: it is locked right after it is made."""


@contextmanager
def beside(target: File) -> Iterator[File]:
    """A new name beside `target`, to be written and then published; what is left under it in the end is removed.

    Raises `ArchiveError` for whatever the operating system says while it is written.
    """
    _tidy(target)
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
    except ArchiveError as error:
        # The name that people know.
        raise type(error)(str(error).replace(str(part), str(target))) from error
    except (OSError, RuntimeError) as error:
        raise ArchiveError(f"{target}: could not be written ({short(error)})") from error
    finally:
        with suppress(OSError):
            part.unlink()


def publish(part: File, target: File, *, replace: bool = False) -> None:
    """Give a complete file its name in the same directory, in one step; `replace` takes the place of an old one.

    Raises `ArchiveExistsError` if there is one and it is not to be replaced, `OSError` for anything else.
    """
    if replace:
        os.replace(part, target)
    else:
        _named(part, target)
    sync_directory(target.parent)


def _named(part: File, target: File) -> None:
    try:
        os.link(part, target)
        return
    except FileExistsError:
        raise exists(target) from None
    except OSError as error:
        if error.errno not in (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS):
            raise
    # A file system without links: the name is taken first, so that nobody else can.
    try:
        os.close(os.open(target, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        raise exists(target) from None
    os.replace(part, target)


def like(part: File, original: File) -> None:
    """Give a new file the mode of the one that it replaces, and its owner where that is allowed."""
    status = original.stat()
    with suppress(PermissionError):
        os.chown(part, status.st_uid, status.st_gid)
    part.chmod(status.st_mode & 0o7777)


def sync_directory(directory: File) -> None:
    """Bring the names in a directory to the disk, where the file system can."""
    with suppress(OSError):
        descriptor = os.open(directory, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _tidy(target: File) -> None:
    """Remove what killed writers of the same name left beside it; a part of theirs was never anything but a copy."""
    pattern = re.compile(rf"\.{re.escape(target.name)}\.[0-9a-f]{{8}}\.part")
    try:
        names = [name for name in os.listdir(target.parent) if pattern.fullmatch(name)]
    except OSError:
        return
    for name in names:
        part = target.with_name(name)
        with suppress(OSError):
            if time.time() - part.stat().st_mtime > _ABANDONED and not is_held(part):
                part.unlink()


def as_file(argument: str, value: Any) -> File:
    """The path that an argument is; `TypeError` if it is no name of a file."""
    if not isinstance(value, (str, PathLike)) or isinstance(os.fspath(value), bytes):
        raise complain(TypeError, argument, "the name of a file", value)
    return File(value)


def check_new(file: File) -> None:
    """Whether a file can be made there, asked before any work is done.

    Raises `ArchiveError` if it exists, or its directory does not, or may not be written.
    """
    try:
        if "\0" in str(file):
            raise ValueError("it holds a NUL")
        if os.path.lexists(file):
            raise exists(file)
        if not file.parent.is_dir():
            raise ArchiveError(f"{file}: there is no directory {file.parent}")
    except ValueError as error:
        raise ArchiveError(f"{str(file)!r}: is no name for a file ({error})") from None
    if len(os.fsencode(file.name)) > _NAME_BYTES:
        raise ArchiveError(f"{file}: the name is too long, expected at most {_NAME_BYTES} bytes")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written")


_NAME_BYTES = 255 - len("..xxxxxxxx.part")
"""Linux' limit, less what the name of a part adds."""


def exists(file: File) -> ArchiveExistsError:
    """The error for a file that is there already."""
    return ArchiveExistsError(f"{file}: exists already, and is never overwritten; choose another name or remove it")


def short(error: BaseException) -> str:
    """The reason of an error, with the operating system's own words where HDF5 has buried them."""
    text = " ".join(str(error).split())
    found = re.search(r"errno = \d+, error message = '([^']*)'", text)
    if found:
        return found[1]
    return (error.strerror if isinstance(error, OSError) and error.strerror else text)[:200]
