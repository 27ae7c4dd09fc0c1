"""What can be wrong with a file, each as one clear line."""

from __future__ import annotations


class ArchiveError(OSError):
    """A file that cannot be read, written or resumed; the message is one line that names the file and the reason."""


class ArchiveExistsError(ArchiveError, FileExistsError):
    """The file to be written exists already; an archive is never overwritten."""
