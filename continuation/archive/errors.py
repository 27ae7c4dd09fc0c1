"""What can be wrong with a file, each as one clear line."""

from __future__ import annotations


class ArchiveError(OSError):
    """A file that cannot be read, written or resumed; the message is one line that names the file and the reason.

    What the file itself says is in it, so that what cannot be printed, as a terminal's control codes, is a "?".
    """

    def __init__(self, message: str) -> None:
        super().__init__("".join(c if c.isprintable() else "?" for c in message))


class ArchiveExistsError(ArchiveError, FileExistsError):
    """The file to be written exists already; an archive is never overwritten."""
