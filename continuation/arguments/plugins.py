"""Entry points of installed packages: homotopies (`continuation.homotopies`), scenes (`continuation.scenes`).

In the ``pyproject.toml`` of a package::

    [project.entry-points."continuation.homotopies"]
    truss = "snapthrough:VonMisesTruss"

The object is a class or function that returns a homotopy; its parameters are the options, its docstring's first line
the summary, its attributes `problem_class` and `references` purpose and sources.
"""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable, Mapping
from contextlib import suppress
from difflib import get_close_matches
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from attrs import frozen

GROUP = "continuation.homotopies"
SCENES = "continuation.scenes"
STUDIES = "continuation.studies"
COMMANDS = "continuation.commands"

_KINDS = {GROUP: "homotopy", SCENES: "scene", STUDIES: "study", COMMANDS: "command"}

Factory = Callable[..., Any]


class PluginError(LookupError):
    """A plug-in's name is unknown or ambiguous, or its import fails."""


@frozen
class Plugin:
    """A registered name; several `points` if packages share it.

    `kind`: "homotopy", "scene", "study" or "command".
    """

    name: str
    points: tuple[EntryPoint, ...]
    kind: str = _KINDS[GROUP]

    @property
    def origin(self) -> str:
        """Distribution and object of each entry point."""
        owners = [f"{point.dist.name} {point.dist.version}" if point.dist else point.value for point in self.points]
        return " and ".join(f"{owner} ({point.value})" for owner, point in zip(owners, self.points))

    def load(self) -> Factory:
        """Import the class or function; `PluginError` if packages share the name, or the import fails."""
        if len(self.points) > 1:
            raise PluginError(f"{self.name}: expected one package that provides it, found {self.origin}")
        (point,) = self.points
        try:
            factory: Factory = point.load()
            inspect.signature(factory)
        except (Exception, SystemExit) as error:  # Imports may raise anything.
            who = f"{self.origin} " if point.value != self.name else ""
            reason = f"{type(error).__name__}: {error}"
            raise PluginError(f"{self.name}: {who}cannot be loaded: {reason}") from error
        return factory


@frozen
class Description:
    """A plug-in's summary (first line of its docstring), options as ``name=default``, and references in BibTeX."""

    summary: str
    options: tuple[str, ...]
    problem_class: str
    references: tuple[str, ...]


def available(group: str = GROUP) -> dict[str, Plugin]:
    """All registered names, sorted, without imports.

    Parameters
    ----------
    group : str
        `GROUP`, `SCENES`, `STUDIES` or `COMMANDS`.
    """
    points: dict[str, dict[str, EntryPoint]] = defaultdict(dict)
    for point in entry_points(group=group):
        points[point.name].setdefault(point.value, point)
    return {name: Plugin(name, tuple(points[name].values()), _KINDS[group]) for name in sorted(points)}


def find(name: str, group: str = GROUP) -> Factory:
    """The class or function of a name.

    Parameters
    ----------
    name : str
        Registered, or ``module:object``.
    group : str

    Raises
    ------
    PluginError
        If it cannot be found or loaded.
    """
    if ":" in name:
        return Plugin(name, (EntryPoint(name, name, group),), _KINDS[group]).load()
    known = available(group)
    if name not in known:
        near = get_close_matches(name, known, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(known) or 'none'}"
        raise PluginError(f"{name}: no {_KINDS[group]} of this name is installed; {hint}")
    return known[name].load()


def describe(factory: Factory) -> Description:
    """The description; a function without arguments is called for its attributes."""
    found = options(factory)
    source: Any = factory
    if not isinstance(factory, type) and all(option.default is not option.empty for option in found.values()):
        # A description must not fail.
        with suppress(Exception):
            source = factory()
    references = getattr(source, "references", ())
    return Description(
        (inspect.getdoc(factory) or "").partition("\n")[0],
        tuple(map(_shown, found.values())),
        str(getattr(source, "problem_class", "")),
        tuple(references) if isinstance(references, (tuple, list)) else (),
    )


def options(factory: Factory) -> dict[str, inspect.Parameter]:
    """Named parameters."""
    found = inspect.signature(factory).parameters.values()
    return {one.name: one for one in found if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)}


def _shown(option: inspect.Parameter) -> str:
    """``name=default``; some defaults are computed by attrs."""
    default = "" if option.default is option.empty else f"={option.default!r}"
    return option.name + default.replace("=NOTHING", "=(computed)")


def called(name: str, factory: Factory, values: Mapping[str, Any] | None = None) -> Any:
    """The factory's result.

    Parameters
    ----------
    name : str
        For messages.
    factory : callable
    values : mapping, optional
        Options by name.

    Raises
    ------
    TypeError
        If an option is unknown or missing.
    """
    values, known = dict(values or {}), options(factory)
    listed = ", ".join(map(_shown, known.values())) or "none"
    for key in values:
        if key not in known:
            raise TypeError(f"{key}: expected an option of {name} ({listed}), found none of this name")
    for key, option in known.items():
        if option.default is option.empty and key not in values:
            raise TypeError(f"{key}: expected a value, since {name} has no default for it, found none")
    return factory(**values)
