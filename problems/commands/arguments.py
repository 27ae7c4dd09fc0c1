"""What the commands share: the file formats in words, and library errors as complaints about an argument."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from continuation.cli import UsageError

PROBLEM_FORMATS = ".npz, .json, .mat or .h5 with A and q, or A alone as .mtx, .npy, .txt, .csv"


@contextmanager
def named(arguments: Mapping[str, str]) -> Iterator[None]:
    """Turn a ValueError about a parameter of the library into a UsageError about the argument behind it.

    Parameters
    ----------
    arguments : mapping of str to str
        Parameter name, with which the library's message begins, to the argument as the user types it. An error about
        anything else is a defect and passes.
    """
    try:
        yield
    except (ValueError, TypeError, OSError) as error:
        parameter, _, complaint = str(error).partition(":")
        if parameter not in arguments:
            raise
        raise UsageError(arguments[parameter], complaint) from error
