"""A scene is data: a question with its parameters, the smallest problem that answers it, what is known, a picture.

A function of the parameters makes it, in which all its parts share what the parameters determine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial, wraps
from importlib import import_module
from inspect import signature
from typing import Annotated, Any, ParamSpec, get_type_hints

import numpy as np
from attrs import asdict, evolve, field, frozen, make_class

from continuation.arguments.checks import FINITE, NOT_NEGATIVE, POSITIVE_FINITE, Validator, integer
from continuation.arrays import Array
from continuation.tracing import trace
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.search.solver import solve as solve_problem
from problems.options import finite_vector
from problems.scenes.pictures import Picture

Quantities = Mapping[str, Any]
"""Named numbers, or arrays of them."""

Units = Mapping[str, str]
"""Of the answer, by the names of its quantities."""


@frozen
class Unknown:
    """Unknowns of one kind.

    Attributes
    ----------
    name : str
    count : int
    why : str
        What the answer would lack without them.
    """

    name: str
    count: int
    why: str


@frozen(eq=False)
class Rival:
    """A method that the field uses for the same question.

    Attributes
    ----------
    name : str
    module : str
        What must be installed; empty where nothing beyond scipy is needed.
    run : callable
        A scene to quantities with the names of its answer, some or all.
    """

    name: str
    module: str
    run: Callable[[Any], Quantities]

    @property
    def installed(self) -> bool:
        """Whether it can be asked."""
        try:
            return not self.module or bool(import_module(self.module))
        except ImportError:
            return False


@frozen
class Point:
    """What `Scene.answer` looks at of a solution, for a method that returns a vector only."""

    x: Array
    success: bool = True


@frozen(eq=False)
class Scene:
    """A question, for parameters that are chosen; any object with these attributes can be registered as a scene.

    Attributes
    ----------
    units : mapping
        Of the answer, by the names of its quantities.
    unknowns : tuple of Unknown
        What is modelled, and why: together as many as the problem has unknowns.
    problem : callable
        ``problem()``: the smallest problem that answers the question: an `LCP`, a `MixedLCP`, a `Program`, or a
        homotopy.
    answer : callable
        What `solve` returns for this scene to physical quantities by name.
    picture : callable
        What `solve` returns for this scene to a `Picture`.
    exact : callable
        ``exact()``: those quantities that have a closed form, or are published, for these parameters; perhaps none.
    solve : callable, optional
        ``solve()``, where the answer takes more than one solution of the problem: steps in time, a path, all
        equilibria.
    rivals : tuple of Rival
        What the field uses.
    parameters : object
        The parameters, by name: a frozen value that can be compared.
    """

    units: Units
    unknowns: tuple[Unknown, ...]
    problem: Callable[[], Any]
    answer: Callable[[Any], Quantities]
    picture: Callable[[Any], Picture]
    exact: Callable[[], Quantities] = dict
    solve: Callable[[], Any] | None = None
    rivals: tuple[Rival, ...] = ()
    parameters: Any = None

    def draw(self, solution: Any, axes: Any) -> None:
        """Draw the solution.

        Parameters
        ----------
        solution : Solution, Path or other
            What `solve` returns for this scene.
        axes : matplotlib Axes
        """
        self.picture(solution).on(axes)


@frozen
class Kind:
    """What a parameter may be: `check` validates it, `convert` makes what is kept of its name and its value."""

    check: Validator | None = None
    convert: Callable[[str, Any], Any] | None = None


def at_least(least: int) -> Kind:
    """An integer.

    Parameters
    ----------
    least : int
    """
    return Kind(integer(least))


Positive = Annotated[float, Kind(POSITIVE_FINITE)]
NotNegative = Annotated[float, Kind(NOT_NEGATIVE)]
Finite = Annotated[float, Kind(FINITE)]
Seed = Annotated[int, at_least(0)]
Numbers = Annotated[Sequence[float], Kind(convert=lambda name, value: tuple(finite_vector(name, value).tolist()))]
"""A tuple of finite numbers, so that parameters can be compared."""

P = ParamSpec("P")


def with_parameters(build: Callable[P, Scene]) -> Callable[P, Scene]:
    """A function that makes a scene, with its arguments checked by their annotations; the scene keeps them.

    Parameters
    ----------
    build : callable
        Its arguments are annotated by ``Annotated[type, Kind(...)]``, as `Positive` is, or not checked.
    """
    hints = get_type_hints(build, include_extras=True)
    parts = {}
    for name, parameter in signature(build).parameters.items():
        kind = getattr(hints.get(name), "__metadata__", (Kind(),))[0]
        parts[name] = field(default=parameter.default, validator=kind.check,
                            converter=kind.convert and partial(kind.convert, name))  # fmt: skip
    of_values: Callable[..., Scene] = build
    checked: Any = make_class(build.__name__, parts, frozen=True)

    @wraps(build)
    def made(*args: P.args, **kwargs: P.kwargs) -> Scene:
        parameters = checked(*args, **kwargs)
        return evolve(of_values(**asdict(parameters, recurse=False)), parameters=parameters)

    return made


def solve(scene: Any) -> Any:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Solution, Path or other
        By ``scene.solve()`` where there is one; else `problems.lcp.solve` of the problem, or the path of a homotopy.
    """
    own = getattr(scene, "solve", None)
    if own is not None:
        return own()
    problem = scene.problem()
    return solve_problem(problem) if isinstance(problem, MixedLCP | Program) else trace(problem)


def conditions(problem: Any) -> Any:
    """The complementarity problem that is solved: of a program its optimality conditions, else the problem itself."""
    return problem.problem if isinstance(problem, Program) else problem


def order(problem: Any) -> int:
    """The number of unknowns.

    Parameters
    ----------
    problem : LCP, MixedLCP, Program or homotopy

    Returns
    -------
    int
    """
    found = conditions(problem)
    return int(found.n) if isinstance(found, MixedLCP) else len(found.start()[0])


def error(found: Quantities, true: Quantities) -> float:
    """The largest difference of quantities that both have, relative to the size of the true one, or to 1 where it is 0.

    Parameters
    ----------
    found, true : mapping
    """
    off = []
    for name, value in true.items():
        if name in found:
            size = float(np.max(np.abs(value), initial=0.0)) or 1.0
            off.append(float(np.max(np.abs(np.asarray(found[name], dtype=float) - value), initial=0.0)) / size)
    return max(off, default=math.nan)
