"""Script ``continuation``: prints its version without importing the library."""

from __future__ import annotations

import importlib.util
import runpy
import sys
from pathlib import Path


def main() -> int:
    """Run the command line."""
    found = importlib.util.find_spec("continuation")
    if sys.argv[1:] == ["--version"] and found is not None and found.origin is not None:
        print(f"continuation {runpy.run_path(str(Path(found.origin).with_name('version.py')))['__version__']}")
        return 0
    from continuation.cli import main as command_line

    return command_line()
