"""The homotopy under test, with points and a path."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from attrs import field, frozen
from attrs.validators import optional

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.evaluation.derivatives import from_residual
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Automatic
from continuation.path import Path
from continuation.path.steps import Located
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.status import Kind, Status
from continuation.step.presets import CONSERVATIVE
from continuation.step.start import StartError, first_point
from continuation.step.tracer import Tracer
from continuation.step.verdict import refused_start
from continuation.tolerance import Tolerance

LONGEST_PATH = 60
"""Steps of the traced path."""

STEPS_WITHOUT_TARGET = 12
"""Steps without a target, after which the path may leave the homotopy's region."""


class CheckFailure(AssertionError):
    """A broken promise of a homotopy."""


def require(fine: bool, sentence: str) -> None:
    """End a check unless `fine`."""
    if not fine:
        raise CheckFailure(sentence)


@contextmanager
def reporting(method: str, where: str) -> Iterator[None]:
    """Report an exception as a failed check."""
    try:
        with np.errstate(all="ignore"):
            yield
    except CheckFailure:
        raise
    except Exception as error:  # Plug-ins may raise anything.
        raise CheckFailure(f"{method}: {where} it raises {type(error).__name__}: {error}") from error


@frozen(eq=False)
class TestedPoint(Located):
    """A point and its name in messages."""

    where: str
    u: Array

    @property
    def y(self) -> Array:
        """A copy of the unknowns, shape (N,)."""
        return self.u[:-1].copy()


@frozen(eq=False, slots=False)
class Subject:
    """A homotopy under test, with shared results."""

    homotopy: Any
    steps: int | None = field(default=None, validator=optional(integer(1)))

    def has(self, capability: str) -> bool:
        """Whether the attribute is not None."""
        return getattr(self.homotopy, capability, None) is not None

    @cached_property
    def evaluator(self) -> Evaluator:
        """Counted access."""
        with reporting("homotopy", "looked at"):
            return Evaluator(self.homotopy, Counts())

    @cached_property
    def start(self) -> TestedPoint:
        """The start, checked as by a trace."""
        with reporting("start", "called without arguments"):
            return TestedPoint("at the start", self.evaluator.start())

    @cached_property
    def places(self) -> tuple[TestedPoint, ...]:
        """The start, a point beside it, and up to two points of the path."""
        start = self.start
        aside = 1e-2 * (1.0 + np.abs(start.u)) * random_directions(start.u.size, 1, 8)[0]
        if self.has("max_step"):
            with reporting("max_step", "near the start"):
                aside *= np.clip(0.5 * float(self.homotopy.max_step(start.u.copy(), aside.copy())), 0.0, 1.0)
        beside = TestedPoint("beside the start", start.u + aside)
        return (start, *([beside] if np.isfinite(self.evaluator.residual_norm(beside.u)) else []), *self._sampled)

    @cached_property
    def _sampled(self) -> dict[TestedPoint, Array]:
        """Two inner steps, since the end may be singular, and their tangents."""
        try:
            last = len(self.regular) - 1
        except CheckFailure:
            return {}
        steps = [self.path.steps[k] for k in sorted({last // 2, last - 1}) if k > 0]
        return {TestedPoint(f"at step {s.index} of the path (lam = {s.lam:.6g})", s.u): s.tangent for s in steps}

    @cached_property
    def first(self) -> Linearization:
        """The path's first point."""
        metric = self.homotopy.metric if self.has("metric") else Automatic()
        target = getattr(self.homotopy, "target", 0.0)
        with reporting("start", "linearized"):
            try:
                return first_point(PathSolver(self.evaluator, Tolerance()), self.start.u, metric, 0, target)[0]
            except StartError as error:
                verdict = refused_start(error)
                raise CheckFailure(f"{verdict.status.name}: {verdict}") from error

    @property
    def limits(self) -> Budget:
        """Budget of a traced path."""
        usual = LONGEST_PATH if getattr(self.homotopy, "target", 0.0) is not None else STEPS_WITHOUT_TARGET
        return Budget(steps=self.steps or usual)

    @cached_property
    def path(self) -> Path:
        """The path, perhaps only its first steps."""
        with reporting("trace", "from the start"):
            path = self.traced()
        bad = (Status.STEP_TOO_SMALL, Status.LEFT_DOMAIN, Status.RAISED, Status.PREDICTOR_FAILED)
        said = f"trace: the path ended after {max(len(path) - 1, 0)} steps, {path.status.name}: {path.message}"
        require(path.status not in bad and len(path) >= 2, said)
        return path

    def traced(self, **options: Any) -> Path:
        """A trace within the limits."""
        tracer = Tracer(self.homotopy, **{"preset": CONSERVATIVE, "budget": self.limits, **options})
        for _ in tracer:
            pass
        return tracer.path

    @cached_property
    def regular(self) -> Path:
        """The path without a perhaps singular end."""
        path = self.path
        end = path.endpoint
        if end.kind != Kind.TARGET or not (self.has("max_step") or path.winding_number or end.segment is None):
            return path
        events = [event for event in path.events if event.step < end.index]
        return Path(steps=path.steps[:-1], events=events, status=Status.BUDGET_EXHAUSTED, counts=path.counts)

    def points(self) -> Iterator[tuple[TestedPoint, Linearization]]:
        """Places on the path, linearized."""
        yield self.start, self.first.with_weights(np.ones_like(self.start.u))
        for place, tangent in self._sampled.items():
            border = tangent / float(np.linalg.norm(tangent))
            with reporting("bordered" if self.has("bordered") else "jacobian", place.where):
                yield place, linearize(self.evaluator, place.u, np.ones_like(border), border)

    def derivative(self, place: TestedPoint) -> Array:
        """The matrix [[H_y, H_lam]], dense, shape (N, N + 1)."""
        if self.has("jacobian"):
            with reporting("jacobian", place.where):
                H_y, H_lam = self.homotopy.jacobian(place.y, place.lam)
        else:
            H_y, H_lam = from_residual(self.homotopy.residual, self.homotopy.start())(place.y, place.lam)
        return np.column_stack([dense(H_y, place.u.size - 1), np.asarray(H_lam, dtype=float)])


def compare(name: str, place: TestedPoint, what: str, found: Any, expected: Any, allowed: Array | float = 0.0) -> None:
    """End a check unless two arrays have one shape and agree, by default bit for bit."""
    found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    shapes = f"expected shape {expected.shape}, found {found.shape}"
    require(found.shape == expected.shape, f"{name}: {place.where} {shapes}")
    with np.errstate(all="ignore"):
        error = np.where((found == expected) | (np.isnan(found) & np.isnan(expected)), 0.0, np.abs(found - expected))
        excess = np.where(np.isfinite(error), error / np.maximum(allowed, np.finfo(float).tiny), np.inf)
    if excess.max(initial=0.0) > 1.0:
        i = int(np.argmax(excess))
        values = f"is {found.flat[i]:.10g}, expected {expected.flat[i]:.10g}, a difference of {error.flat[i]:.3g}"
        raise CheckFailure(f"{name}: {place.where} {what} {i} {values}")


def dense(H_y: Any, n: int) -> Array:
    """A matrix as an array."""
    return np.asarray(H_y @ np.eye(n), dtype=float)


def random_directions(n: int, count: int, seed: int) -> list[Array]:
    """Random unit vectors."""
    generator = np.random.default_rng(seed)
    vectors = [generator.standard_normal(n) for _ in range(count)]
    return [v / float(np.linalg.norm(v)) for v in vectors]


Examination = Callable[[Subject], None]
