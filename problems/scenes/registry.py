"""Scenes by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from continuation.arguments import plugins
from continuation.arguments.plugins import SCENES, Factory, Plugin


def available() -> dict[str, Plugin]:
    """All registered names, without importing scenes."""
    return plugins.available(SCENES)


def find(name: str) -> Factory:
    """Find a scene's class.

    Parameters
    ----------
    name : str
        A registered name, or ``module:Class``.

    Raises
    ------
    PluginError
        If it is unknown or does not load.
    """
    return plugins.find(name, SCENES)


def make(name: str, values: Mapping[str, Any] | None = None) -> Any:
    """Make a scene.

    Parameters
    ----------
    name : str
        As for `find`.
    values : mapping, optional
        Parameters by name.

    Raises
    ------
    PluginError
        As `find`.
    TypeError, ValueError
        For invalid parameters.
    """
    return plugins.called(name, find(name), values)
