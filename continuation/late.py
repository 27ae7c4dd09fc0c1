"""Functions of modules that stand above the caller's: found by name, when they are asked for.

A path is plotted, saved and shown by modules that know what a path is; with imports it would be a circle.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any


def late(module: str, name: str) -> Any:
    """The function `name` of ``continuation.<module>``."""
    return getattr(import_module(f"continuation.{module}"), name)
