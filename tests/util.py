"""What tests of several rooms have in common."""

import importlib.util
import io
import re
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES, Status, trace
from continuation.archive import ArchiveError
from continuation.linear import Banded


def by_preset(*presets):
    return pytest.mark.parametrize("preset", presets, ids=lambda preset: preset.name)


@cache
def load(file):
    """A module by its file, which may import from its own folder."""
    name = "_".join(file.with_suffix("").parts[-2:])
    spec = importlib.util.spec_from_file_location(name, file)
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(file.parent))
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(file.parent))
    return module


def benchmark(name):
    """A module of the benchmarks, by its path below them."""
    return load(Path(__file__).parents[1] / "examples" / "benchmarks" / name)


def path_of(homotopy, status=Status.REACHED_TARGET, **options):
    """A homotopy's path, whose status is as expected."""
    path = trace(homotopy, **options)
    assert path.status is status, path.message
    return path


def tridiagonal(A):
    """The matrix in bands."""
    return Banded(np.array([[0.0, *A.diagonal(1)], A.diagonal(), [*A.diagonal(-1), 0.0]]), 1, 1)


def share(examples):
    """So many of a hundred examples of the profile: a hundred times as many in the nightly one."""
    return settings(max_examples=settings.default.max_examples * examples // 100)


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def interrupt():
    """Ctrl-C is pressed."""
    raise KeyboardInterrupt


every_preset = by_preset(FAST, DEFAULT, CONSERVATIVE)
for_interior_paths = by_preset(DEFAULT, CONSERVATIVE, SERIES)


def refused(argument, call, words=""):
    """The call is refused with a line about the argument, or the file of that name, which has these words."""
    with pytest.raises((TypeError, ValueError, LookupError, ArchiveError)) as caught:
        call()
    text = str(caught.value.args[0] if isinstance(caught.value, KeyError) else caught.value)
    assert "\n" not in text
    assert text.startswith(f"{argument}: "), text
    assert re.search(words, text), text
    assert len(text) < 400
