"""Entry points of installed packages: homotopies (`continuation.homotopies`), scenes (`continuation.scenes`).

In the ``pyproject.toml`` of a package::

    [project.entry-points."continuation.homotopies"]
    truss = "snapthrough:VonMisesTruss"

The object is a class or function that returns a homotopy; its parameters are the options, its docstring's first line
the summary, its attributes `problem_class` and `references` purpose and sources. It is imported on use.
"""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from attrs import NOTHING, frozen

GROUP = "continuation.homotopies"
SCENES = "continuation.scenes"
STUDIES = "continuation.studies"
COMMANDS = "continuation.commands"

_KINDS = {GROUP: "homotopy", SCENES: "scene", STUDIES: "study", COMMANDS: "command"}

Factory = Callable[..., Any]


class PluginError(LookupError):
    """A plug-in's name is unknown or ambiguous, or its import fails."""


@frozen
class Option:
    """A parameter of a plug-in.

    `default`: None if required, `attrs.NOTHING` if computed.
    """

    name: str
    required: bool
    default: Any
    annotation: str

    def __str__(self) -> str:
        if self.required:
            return self.name
        return f"{self.name}={'(computed)' if self.default is NOTHING else repr(self.default)}"


@frozen
class Plugin:
    """A registered name.

    Attributes
    ----------
    name : str
    points : tuple of EntryPoint
        Several if packages share the name.
    kind : str
        "homotopy", "scene", "study" or "command".
    """

    name: str
    points: tuple[EntryPoint, ...]
    kind: str = _KINDS[GROUP]

    @property
    def origin(self) -> str:
        """Distribution and object of each entry point."""
        return " and ".join(f"{owner(point)} ({point.value})" for point in self.points)

    def load(self) -> Factory:
        """Import the class or function.

        Raises
        ------
        PluginError
            If packages share the name, or the import fails.
        """
        if len(self.points) > 1:
            raise PluginError(f"{self.name}: expected one package that provides it, found {self.origin}")
        (point,) = self.points
        try:
            factory: Factory = point.load()
        except (Exception, SystemExit) as error:  # Imports may raise anything.
            who = f"{self.origin} " if point.value != self.name else ""
            reason = f"{type(error).__name__}: {error}"
            raise PluginError(f"{self.name}: {who}cannot be loaded: {reason}") from error
        found = type(factory).__name__
        if not callable(factory):
            raise PluginError(f"{self.name}: expected a class or function that makes a {self.kind}, found {found}")
        try:
            inspect.signature(factory)
        except (TypeError, ValueError):
            raise PluginError(f"{self.name}: expected something with known parameters, found {factory!r:.80}") from None
        return factory


@frozen
class Description:
    """A plug-in's description.

    `summary`: first line of the docstring. `references`: BibTeX.
    """

    summary: str
    options: tuple[Option, ...]
    problem_class: str
    references: tuple[str, ...]


def available(group: str = GROUP) -> dict[str, Plugin]:
    """All registered names, sorted, without imports.

    Parameters
    ----------
    group : str
        `GROUP`, `SCENES`, `STUDIES` or `COMMANDS`.
    """
    points = grouped(entry_points(group=group))
    return {name: Plugin(name, tuple(points[name]), _KINDS[group]) for name in sorted(points)}


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
    """The description; attributes come from the result of a function without arguments."""
    found = options(factory)
    source: Any = factory
    if not isinstance(factory, type) and not any(option.required for option in found):
        try:
            source = factory()
        except Exception:  # A description must not fail.
            source = factory
    references = getattr(source, "references", ())
    return Description(
        (inspect.getdoc(factory) or "").partition("\n")[0],
        found,
        str(getattr(source, "problem_class", "")),
        tuple(references) if isinstance(references, (tuple, list)) else (),
    )


def options(factory: Factory) -> tuple[Option, ...]:
    """Named parameters."""
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return tuple(
        Option(p.name, p.default is p.empty, None if p.default is p.empty else p.default, _written(p.annotation))
        for p in inspect.signature(factory).parameters.values()
        if p.kind in named
    )


def make(name: str, values: Mapping[str, Any] | None = None) -> Any:
    """The homotopy of that name.

    Raises
    ------
    PluginError, TypeError
        As `find` and `called`.
    """
    return called(name, find(name), values)


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
    values = dict(values or {})
    known = options(factory)
    names = [option.name for option in known]
    listed = ", ".join(map(str, known)) or "none"
    for key in values:
        if key not in names:
            raise TypeError(f"{key}: expected an option of {name} ({listed}), found none of this name")
    for option in known:
        if option.required and option.name not in values:
            raise TypeError(f"{option.name}: expected a value, since {name} has no default for it, found none")
    return factory(**values)


def grouped(points: Iterable[EntryPoint]) -> dict[str, list[EntryPoint]]:
    """Entry points by name, without duplicates."""
    found: dict[str, list[EntryPoint]] = defaultdict(list)
    for point in points:
        if all(point.value != other.value for other in found[point.name]):
            found[point.name].append(point)
    return dict(found)


def owner(point: EntryPoint) -> str:
    """Distribution and version of an entry point, or its object."""
    return f"{point.dist.name} {point.dist.version}" if point.dist else point.value


def _written(annotation: Any) -> str:
    if annotation is inspect.Parameter.empty:
        return ""
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
