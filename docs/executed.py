"""The Python blocks of a page, run one after another as one program: the test runs them, the build shows what they say.

A block is fenced with ```` ```python ````. What it prints, and the pictures it writes, follow it on the page; what is
printed as a Markdown table becomes one.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import NamedTuple
from unittest.mock import patch

_BLOCK = re.compile(r"^```python\n(.*?)^```\n?", re.MULTILINE | re.DOTALL)
_PICTURES = (".png", ".svg")
_COLUMNS = re.compile(r"^.*\S {2,}\S", re.MULTILINE)


class Shown(NamedTuple):
    """What a block printed, the pictures that it wrote, and where it ends in the page."""

    output: str
    pictures: tuple[Path, ...]
    end: int


def run(text: str, folder: Path, name: str) -> Iterator[Shown]:
    """Run the blocks of a page in a folder; an exception is raised with the page's name and lines."""
    module = ModuleType("__main__")
    module.__dict__["__file__"] = name
    for found in _BLOCK.finditer(text):
        # Line numbers in tracebacks are those of the page.
        lines_before = text.count("\n", 0, found.start(1))
        code = compile("\n" * lines_before + found.group(1), name, "exec")
        before = _pictures(folder)
        printed = io.StringIO()
        # What the page changes in the environment ends with it; help texts are as wide as a page.
        surroundings = patch.dict(os.environ, {"COLUMNS": "92", "MPLBACKEND": "Agg"})
        with surroundings, _as_main(module), contextlib.chdir(folder), contextlib.redirect_stdout(printed):
            exec(code, module.__dict__)
        after = _pictures(folder)
        new = tuple(sorted(path for path, written in after.items() if before.get(path) != written))
        if "Traceback" in printed.getvalue():
            raise ValueError(f"{name}: a block printed {printed.getvalue()}")
        yield Shown(printed.getvalue(), new, found.end())


@contextlib.contextmanager
def _as_main(module: ModuleType) -> Iterator[None]:
    """Make the page the program that runs, so that what it defines can be pickled, and is a script's to an archive."""
    kept = sys.modules["__main__"]
    sys.modules["__main__"] = module
    try:
        yield
    finally:
        sys.modules["__main__"] = kept


def _pictures(folder: Path) -> dict[Path, int]:
    return {file: os.stat(file).st_mtime_ns for file in folder.iterdir() if file.suffix in _PICTURES}


def with_results(text: str, folder: Path, name: str, where: str) -> str:
    """The page with results after its blocks; `where` is the folder as the page refers to it."""
    parts, done = [], 0
    for shown in run(text, folder, name):
        parts.append(text[done : shown.end])
        if shown.output.startswith("|"):
            parts.append(f"\n{shown.output}\n")
        elif shown.output.strip():
            # Sentences may be wrapped on a narrow screen, columns may not.
            looks = "printed aligned" if len(_COLUMNS.findall(shown.output)) > 1 else "printed"
            parts.append(f"\n```{{code-block}} text\n:class: {looks}\n\n{shown.output.rstrip()}\n```\n")
        parts += [f"\n![{picture.stem.replace('_', ' ')}]({where}/{picture.name})\n" for picture in shown.pictures]
        done = shown.end
    return "".join([*parts, text[done:]])
