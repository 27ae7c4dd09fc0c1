"""Stability along a path: eigenvalues and Hopf points.

A point is stable in dy/dt = side H(y, lam) if all eigenvalues of side H_y have negative real parts. Complex pairs cross
the axis at Hopf points, real eigenvalues at turning points and branch points.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import astuple, define, field, frozen
from attrs.validators import optional

from continuation.arguments.checks import integer, one_of, sign
from continuation.arrays import SIX_DIGITS, Array
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.locate import root
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.spectrum import Spectrum, spectrum
from continuation.path import LocatedEvent, Step
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.status import Kind

SMALL, ARC_QUARTERS = 31, (0.25, 0.5, 0.75)
"""Up to 30 unknowns arcs are sampled inside: a pair may cross, become real, and return through a turning point
(MatCont's catalyst)."""

EVENT_MARGIN = 0.02
"""Distance, in arc lengths, of events that may change an interval's count."""

CROSSING = {Kind.HOPF: 2, Kind.TURNING_POINT: 1, Kind.BRANCH_POINT: 1, Kind.SINGULAR_POINT: 4}
"""Largest number of eigenvalues crossing at an event."""

SPECTRA_KEPT = 12
"""Spectra kept: enough for an arc and an event."""


@frozen
class HopfPoint:
    """A Hopf point: a complex pair of eigenvalues of H_y crosses the imaginary axis.

    Parameters
    ----------
    side : {1, -1}, default 1
        In dy/dt = side H(y, lam); affects stored counts only.
    k : int, optional
        Number of rightmost eigenvalues, by Arnoldi's method. Default: all up to 100 unknowns, else 6.
    terminal : int, default 0
        End at the k-th occurrence; 0: never.
    direction : int, default 0
        +1: only pairs that become unstable; -1: stable.
    """

    side: int = field(default=1, validator=one_of(1, -1))
    k: int | None = field(default=None, validator=optional(integer(1)))
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.HOPF, init=False)
    name: str = field(default="Hopf point", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """Return 1, since only the `bound` event sees H_y."""
        return 1.0

    def bound(self, evaluator: Evaluator) -> BoundHopf:
        """Return the event for one path.

        Parameters
        ----------
        evaluator : Evaluator
        """
        return BoundHopf(evaluator, *astuple(self))


@frozen
class Stability:
    """An observer that stores the stability of each point and locates Hopf points.

    ``observed["unstable"]`` is the number of unstable eigenvalues; ``"rightmost"``, the largest real part;
    ``"frequency"``, the imaginary part of the pair nearest to the axis, or nan; ``"covered"``, 1 if no unstable
    eigenvalue can be missing.

    Parameters
    ----------
    side, k, terminal
        As for `HopfPoint`.
    """

    side: int = field(default=1, validator=one_of(1, -1))
    k: int | None = field(default=None, validator=optional(integer(1)))
    terminal: int = field(default=0, validator=integer(0))

    @property
    def events(self) -> tuple[HopfPoint, ...]:
        """Watched events; ``trace_both(homotopy, events=Stability().events)`` does the same."""
        return (HopfPoint(self.side, self.k, self.terminal),)

    def step(self, tracer: Any, step: Step) -> None:
        """Do nothing."""

    def event(self, tracer: Any, event: LocatedEvent) -> None:
        """Do nothing."""

    def end(self, tracer: Any) -> None:
        """Do nothing."""


@define(eq=False)
class BoundHopf:
    """`HopfPoint` on the path of one homotopy."""

    evaluator: Evaluator
    side: int
    k: int | None
    terminal: int
    direction: int
    kind: Kind
    name: str
    _known: dict[Any, Spectrum] = field(factory=dict, init=False)

    def at(self, u: Array) -> Spectrum:
        """The eigenvalues at a point."""
        key = self.evaluator.bindings, u.tobytes()
        if key not in self._known:
            while len(self._known) >= SPECTRA_KEPT:
                del self._known[next(iter(self._known))]
            self._known[key] = self._computed(u)
        return self._known[key]

    def _computed(self, u: Array) -> Spectrum:
        counts = self.evaluator.counts
        H_y = self.evaluator.matrix(u)
        counts.factorizations += 1
        try:
            found = spectrum(H_y, self.side, self.k)
            counts.solves += found.solves
            return found
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise EvaluationError(str(error)) from error

    def monitor(self, u: Array, v: Array) -> float:
        """Real part of the pair nearest to the axis."""
        pairs = self.at(u).pairs
        return float(pairs.real[np.argmin(np.abs(pairs.real))]) if pairs.size else np.nan

    def observe(self, u: Array) -> dict[str, float]:
        """A point's stored scalars."""
        found = self.at(u)
        pairs = found.pairs
        frequency = float(pairs.imag[np.argmin(np.abs(pairs.real))]) if pairs.size else np.nan
        known = (float(found.unstable), found.rightmost, frequency, float(found.covered))
        return dict(zip(("unstable", "rightmost", "frequency", "covered"), known))

    def found_on(self, solver: PathSolver, arc: Arc) -> list[Linearization]:
        """An arc's Hopf points, in order."""
        found: list[Linearization] = []
        for (left, before), (right, after) in pairwise(self._looks(arc)):
            p, q = before.unstable_pairs, after.unstable_pairs
            if p == q or before.unstable == after.unstable or (q - p) * self.direction < 0:
                continue
            points = [self._located(solver, arc, left, right, rank) for rank in range(min(p, q), max(p, q))]
            found += sorted((at for at in points if at is not None), key=lambda point: position(arc, point.u))
        return found

    def _looks(self, arc: Arc) -> list[tuple[float, Spectrum]]:
        inside = ARC_QUARTERS if arc.a.u.size <= SMALL else ()
        found = ((t, self.at(arc.segment.at(t))) for t in inside)
        return [(0.0, self.at(arc.a.u)), *found, (1.0, self.at(arc.b.u))]

    def _real_part(self, u: Array, rank: int) -> float:
        found = self.at(u)
        if rank >= found.pairs.size:
            return -found.size
        pair = found.pairs[rank]
        return float(pair.real) if abs(pair.real) > BACKWARD_ERROR * abs(pair) else 0.0

    def _located(self, solver: PathSolver, arc: Arc, left: float, right: float, rank: int) -> Linearization | None:
        ends = {0.0: arc.a.u, 1.0: arc.b.u}

        def real_part(t: float) -> float:
            return self._real_part(
                ends[t] if t in ends else solver.project(arc.a, arc.segment.at(t), arc.border)[0], rank
            )

        a, b = (left, real_part(left)), (right, real_part(right))
        t = None if a[1] * b[1] > 0.0 else root(real_part, a, b, solver.noise(arc.a) / arc.length)
        if t is None:
            return None
        at = solver.project_and_linearize(arc.a if t < 0.5 else arc.b, arc.segment.at(t), arc.border)
        pairs = self.at(at.u).pairs
        return at if (np.abs(pairs.real) <= SIX_DIGITS * np.abs(pairs)).any() else None

    def accounts_for(self, arc: Arc, found: Sequence[tuple[Kind, Linearization]]) -> bool:
        """Whether an arc's events explain its change in unstable eigenvalues."""
        length = position(arc, arc.b.u)
        places = [(kind, position(arc, point.u) / length) for kind, point in found]
        for (left, before), (right, after) in pairwise(self._looks(arc)):
            sure = before.covered and after.covered and not (before.critical or after.critical)
            near = [CROSSING.get(kind, 0) for kind, t in places if left - EVENT_MARGIN <= t <= right + EVENT_MARGIN]
            if sure and abs(after.unstable - before.unstable) > sum(near):
                return False
        return True
