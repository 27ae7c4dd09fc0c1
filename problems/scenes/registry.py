"""Scenes by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from continuation.arguments import plugins
from continuation.arguments.plugins import SCENES, Factory, Plugin


def available() -> dict[str, Plugin]:
    """All registered names, sorted; imports no scene.

    Returns
    -------
    dict of str to Plugin
    """
    return plugins.available(SCENES)


def find(name: str) -> Factory:
    """Find a scene's class.

    Parameters
    ----------
    name : str
        A registered name, or ``module:Class``.

    Returns
    -------
    type

    Raises
    ------
    PluginError
        If the name is unknown or cannot be loaded.
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

    Returns
    -------
    Scene

    Raises
    ------
    PluginError
        As `find`.
    TypeError, ValueError
        For an unknown parameter or an invalid value.
    """
    return plugins.called(name, find(name), values)
