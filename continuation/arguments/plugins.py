"""What installed packages offer under a name: homotopies, the entry points of the group `continuation.homotopies`, and
scenes, those of `continuation.scenes`.

In the ``pyproject.toml`` of a package::

    [project.entry-points."continuation.homotopies"]
    truss = "snapthrough:VonMisesTruss"

The object is a class, or a function, whose call gives a homotopy; its parameters are the options. The first line of its
docstring is its summary, its attributes `problem_class` and `references` say what it is for and where it is from.
Nothing is imported before it is asked for, and what cannot be imported hides nothing else.
"""

from __future__ import annotations

import importlib
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
"""What an entry point names: options to homotopy."""


class PluginError(LookupError):
    """A name that gives no homotopy; the sentence says which name, and why."""


@frozen
class Option:
    """A parameter of a plug-in's constructor.

    `default`: None where it is required, `attrs.NOTHING` where it is worked out from the other options. `annotation`:
    Its type as written; empty where there is none.
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
    """A name and what is registered under it.

    Attributes
    ----------
    name : str
    points : tuple of EntryPoint
        One; more where several packages register the name.
    kind : str
        What is made: a homotopy, a scene.
    """

    name: str
    points: tuple[EntryPoint, ...]
    kind: str = _KINDS[GROUP]

    @property
    def origin(self) -> str:
        """Distribution and object, of each that has the name."""
        return " and ".join(f"{owner(point)} ({point.value})" for point in self.points)

    def load(self) -> Factory:
        """The class or function; imports its module.

        Raises
        ------
        PluginError
            If two packages have the name, or the import fails with whatever error, or gives nothing to call.
        """
        if len(self.points) > 1:
            raise PluginError(f"{self.name}: expected one package that provides it, found {self.origin}")
        point = self.points[0]
        try:
            factory: Any = point.load()
        except (Exception, SystemExit) as error:  # Whatever a foreign module raises while it is imported.
            reason = f"{type(error).__name__}: {error}"
            raise PluginError(f"{self.name}: {self.origin} cannot be loaded: {reason}") from error
        return _callable(self.name, factory, self.kind)


@frozen
class Description:
    """What a plug-in says of itself.

    `summary`: First line of the docstring. `problem_class`: The problems that it is for; empty where it does not say.
    `references`: BibTeX entries.
    """

    summary: str
    options: tuple[Option, ...]
    problem_class: str
    references: tuple[str, ...]


def available(group: str = GROUP) -> dict[str, Plugin]:
    """All registered names, sorted, without importing anything.

    Parameters
    ----------
    group : str
        `GROUP`, `SCENES`, `STUDIES` or `COMMANDS`.
    """
    points = grouped(entry_points(group=group))
    return {name: Plugin(name, tuple(points[name]), _KINDS[group]) for name in sorted(points)}


def find(name: str, group: str = GROUP) -> Factory:
    """The class or function behind a name.

    Parameters
    ----------
    name : str
        A registered name, or ``module:object`` for one that is not registered.
    group : str
        `GROUP`, `SCENES`, `STUDIES` or `COMMANDS`.

    Raises
    ------
    PluginError
        If there is none by that name, or it cannot be loaded.
    """
    if ":" in name:
        return _imported(name, _KINDS[group])
    known = available(group)
    if name not in known:
        near = get_close_matches(name, known, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else f"known are {', '.join(known) or 'none'}"
        raise PluginError(f"{name}: no {_KINDS[group]} of this name is installed; {hint}")
    return known[name].load()


def describe(factory: Factory) -> Description:
    """Summary, options, class of problems and references.

    A function has no attributes of its own to look at; those of what it makes without arguments are taken instead.
    """
    found = options(factory)
    source: Any = factory
    if not isinstance(factory, type) and not any(option.required for option in found):
        try:
            source = factory()
        except Exception:  # A description is no place to fail: what it cannot say stays empty.
            source = factory
    references = getattr(source, "references", ())
    return Description(
        (inspect.getdoc(factory) or "").partition("\n")[0],
        found,
        str(getattr(source, "problem_class", "")),
        tuple(references) if isinstance(references, (tuple, list)) else (),
    )


def options(factory: Factory) -> tuple[Option, ...]:
    """The parameters that can be given by name."""
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return tuple(
        Option(p.name, p.default is p.empty, None if p.default is p.empty else p.default, _written(p.annotation))
        for p in inspect.signature(factory).parameters.values()
        if p.kind in named
    )


def make(name: str, values: Mapping[str, Any] | None = None) -> Any:
    """The homotopy of that name, with options by name.

    Raises
    ------
    PluginError
        As `find`.
    TypeError
        As `called`.
    """
    return called(name, find(name), values)


def called(name: str, factory: Factory, values: Mapping[str, Any] | None = None) -> Any:
    """What a factory makes of options by name.

    Parameters
    ----------
    name : str
        Of the factory, for messages.
    factory : callable
    values : mapping, optional

    Raises
    ------
    TypeError
        If an option is unknown or missing, naming it and those that there are.
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
    """Entry points by name; one that is found twice with the same meaning counts once."""
    found: dict[str, list[EntryPoint]] = defaultdict(list)
    for point in points:
        if all(point.value != other.value for other in found[point.name]):
            found[point.name].append(point)
    return dict(found)


def owner(point: EntryPoint) -> str:
    """Distribution and version that an entry point comes from, or its object where that is not known."""
    return f"{point.dist.name} {point.dist.version}" if point.dist else point.value


def _imported(path: str, kind: str) -> Factory:
    module, _, attribute = path.partition(":")
    try:
        found: Any = importlib.import_module(module)
        for part in attribute.split("."):
            found = getattr(found, part)
    except (Exception, SystemExit) as error:  # Whatever a foreign module raises while it is imported.
        raise PluginError(f"{path}: cannot be loaded: {type(error).__name__}: {error}") from error
    return _callable(path, found, kind)


def _callable(name: str, factory: Any, kind: str) -> Factory:
    if not callable(factory):
        raise PluginError(f"{name}: expected a class or function that makes a {kind}, found {type(factory).__name__}")
    try:
        inspect.signature(factory)
    except (TypeError, ValueError):
        raise PluginError(f"{name}: expected something with known parameters, found {factory!r:.80}") from None
    loaded: Factory = factory
    return loaded


def _written(annotation: Any) -> str:
    if annotation is inspect.Parameter.empty:
        return ""
    return annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
