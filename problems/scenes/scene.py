"""A scene: a question with parameters, its smallest problem, known answers, a picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial, wraps
from importlib.util import find_spec
from inspect import signature
from typing import Annotated, Any, ParamSpec, get_type_hints

import numpy as np
from attrs import asdict, evolve, field, frozen, make_class

from continuation.arguments.checks import FINITE, NOT_NEGATIVE, POSITIVE_FINITE, integer
from continuation.tracing import trace
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.search.solver import solve as solve_problem
from problems.options import finite_vector
from problems.scenes.pictures import Picture, draw

Quantities = Mapping[str, Any]

Units = Mapping[str, str]


@frozen
class Unknown:
    """Unknowns of one kind.

    Attributes
    ----------
    name : str
    count : int
    why : str
        Their purpose for the answer.
    """

    name: str
    count: int
    why: str


@frozen(eq=False)
class Rival:
    """A method of the field for the same question.

    Attributes
    ----------
    name : str
    module : str
        Package required beyond scipy, or empty.
    run : callable
        Maps a scene to some of its quantities.
    """

    name: str
    module: str
    run: Callable[[Any], Quantities]

    @property
    def installed(self) -> bool:
        """Whether the module is there."""
        return not self.module or find_spec(self.module) is not None


@frozen(eq=False)
class Scene:
    """Any object with these attributes can be a scene.

    Attributes
    ----------
    units : mapping
        Unit of each quantity.
    unknowns : tuple of Unknown
    problem : callable
        Makes the smallest problem that answers the question: an `LCP`, `MixedLCP`, `Program`, or homotopy.
    answer, picture : callable
        Map the result of `solve` to quantities, and to a `Picture`.
    exact : callable
        Gives quantities known in closed form or published.
    solve : callable, optional
        For time steps, paths, or all equilibria.
    rivals : tuple of Rival
    parameters : object
        Set by `with_parameters`; comparable.
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
        """Draw a solution.

        Parameters
        ----------
        solution : Solution, Path or other
            Result of `solve`.
        axes : matplotlib Axes
        """
        draw(self.picture(solution), axes)


Positive = Annotated[float, POSITIVE_FINITE]
NotNegative = Annotated[float, NOT_NEGATIVE]
Finite = Annotated[float, FINITE]
Seed = Annotated[int, integer(0)]
Numbers = Annotated[Sequence[float], None, lambda name, value: tuple(finite_vector(name, value).tolist())]
"""Tuples can be compared."""

P = ParamSpec("P")


def with_parameters(build: Callable[P, Scene]) -> Callable[P, Scene]:
    """Check a scene's arguments by their annotations, and keep them in the scene.

    Parameters
    ----------
    build : callable
        Its arguments are annotated as ``Annotated[type, validator, converter]``, both of them optional: a validator of
        attrs or None, a function of (name, value).
    """
    hints = get_type_hints(build, include_extras=True)
    parts = {}
    for name, parameter in signature(build).parameters.items():
        check, convert = (*getattr(hints.get(name), "__metadata__", ()), None, None)[:2]
        parts[name] = field(default=parameter.default, validator=check, converter=convert and partial(convert, name))
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
        From ``scene.solve()``, `problems.lcp.solve`, or `trace` (homotopies).
    """
    own = getattr(scene, "solve", None)
    if own is not None:
        return own()
    problem = scene.problem()
    return solve_problem(problem) if isinstance(problem, MixedLCP | Program) else trace(problem)


def conditions(problem: Any) -> Any:
    """A program's optimality conditions, or the problem itself."""
    return problem.problem if isinstance(problem, Program) else problem


def order(problem: Any) -> int:
    """Number of unknowns.

    Parameters
    ----------
    problem : LCP, MixedLCP, Program or homotopy
    """
    found = conditions(problem)
    return int(found.n) if isinstance(found, MixedLCP) else len(found.start()[0])


def error(found: Quantities, true: Quantities) -> float:
    """Largest relative error of common quantities; absolute where the true one is 0.

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
