"""Scenes by name: the entry points of the group `continuation.scenes`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from continuation.arguments import plugins
from continuation.arguments.plugins import SCENES, Factory, Plugin


def available() -> dict[str, Plugin]:
    """All registered names, sorted, without importing any scene.

    Returns
    -------
    dict of str to Plugin
    """
    return plugins.available(SCENES)


def find(name: str) -> Factory:
    """The class of a scene.

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
        If there is none by that name, or it cannot be loaded.
    """
    return plugins.find(name, SCENES)


def make(name: str, values: Mapping[str, Any] | None = None) -> Any:
    """The scene of that name.

    Parameters
    ----------
    name : str
        A registered name, or ``module:Class``.
    values : mapping, optional
        Its parameters by name.

    Returns
    -------
    Scene

    Raises
    ------
    PluginError
        As `find`.
    TypeError, ValueError
        For a parameter that it does not have, or a value that it refuses.
    """
    return plugins.called(name, find(name), values)
