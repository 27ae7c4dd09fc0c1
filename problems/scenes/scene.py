"""What a scene is: a question of physics, economics or data, the smallest problem that answers it, and its picture."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE_FINITE
from continuation.arrays import Array
from continuation.tracing import trace
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.search.solver import solve as solve_problem
from problems.options import finite_vector

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


class Scene(Protocol):
    """A frozen class of physical parameters, each with a default; `solve` solves it.

    A scene may also have ``solve()``, where its answer takes more than one solution of its problem: steps in time, a
    path, all equilibria.
    """

    units: ClassVar[Units]

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """What is modelled, and why: together as many as the problem has unknowns."""
        ...

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """What the field uses."""
        ...

    def problem(self) -> Any:
        """The smallest problem that answers the question: an `LCP`, a `MixedLCP`, a `Program`, or a homotopy."""
        ...

    def answer(self, solution: Any) -> Quantities:
        """Physical quantities by name, in the units of `units`.

        Parameters
        ----------
        solution : Solution, Path or other
            What `solve` returns for this scene.
        """
        ...

    def exact(self) -> Quantities:
        """Those quantities that have a closed form, or are published, for these parameters; perhaps none."""
        ...

    def draw(self, solution: Any, axes: Any) -> None:
        """Draw the solution.

        Parameters
        ----------
        solution : Solution, Path or other
            What `solve` returns for this scene.
        axes : matplotlib Axes
        """
        ...


@runtime_checkable
class SupportsSolve(Protocol):
    """Capability: a solution that is more than one solution of one problem."""

    def solve(self) -> Any:
        """What `answer` and `draw` take."""
        ...


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
    if isinstance(scene, SupportsSolve):
        return scene.solve()
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


def memory(problem: Any) -> int:
    """Bytes of the matrix and the vectors of the model.

    Parameters
    ----------
    problem : LCP, MixedLCP, Program or homotopy

    Returns
    -------
    int
        Of a homotopy those of its unknowns; no matrix is stored with it.
    """
    found = conditions(problem)
    if not isinstance(found, MixedLCP):
        return 8 * order(problem)
    A: Any = found.A
    parts = (A.data, A.indices, A.indptr) if found.sparse else (A,)
    bounds = () if found.standard else (found.lower, found.upper)
    return sum(int(part.nbytes) for part in (*parts, found.q, *bounds))


def numbers(name: str, default: tuple[float, ...]) -> Any:
    """A field with a tuple of finite numbers, so that a scene is a value that can be compared."""

    def convert(value: Any) -> tuple[float, ...]:
        return tuple(finite_vector(name, value).tolist())

    return field(default=default, converter=convert)


def positive(default: float) -> Any:
    """A field with a positive number."""
    return field(default=default, validator=POSITIVE_FINITE)


def mismatch(scene: Any, solution: Any) -> float:
    """How far an answer is from the exact one, relative to each quantity; NaN where none is known."""
    return error(scene.answer(solution), scene.exact())


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
