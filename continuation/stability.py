"""Stability along a path: eigenvalues, Hopf points, and a check of the eigenvalue count.

Equilibria of dy/dt = side H(y, lam) are stable if all eigenvalues of side H_y lie left of the imaginary axis. A real
eigenvalue crosses it at turning points and branch points, a complex pair at Hopf points.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import astuple, define, field, frozen
from attrs.validators import optional

from continuation.arguments.checks import integer, one_of, sign
from continuation.arrays import Array
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.locate import root
from continuation.linear.spectrum import Spectrum, spectrum
from continuation.path import LocatedEvent, Step
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.status import Kind

SMALL, ARC_QUARTERS = 31, (0.25, 0.5, 0.75)
"""Up to 30 unknowns eigenvalues cost less than a step, and arcs are examined inside: a pair may cross, become real, and
one return (MatCont's catalyst)."""

EVENT_MARGIN = 0.02
"""Distance, in arcs, at which an event may explain a change."""

CROSSING = {Kind.HOPF: 2, Kind.TURNING_POINT: 1, Kind.BRANCH_POINT: 1, Kind.SINGULAR_POINT: 4}
"""Most eigenvalues that change sides."""

SPECTRA_KEPT = 12
"""An arc's spectra and one event's."""

ON_AXIS = 1e-6
"""Largest relative real part of a Hopf pair; beyond, a pair appeared or vanished without crossing."""

ZERO_RESOLVED = 1e-14
"""Relative real part that is round-off."""


@frozen
class HopfPoint:
    """A complex pair of eigenvalues of H_y crosses the imaginary axis.

    Parameters
    ----------
    side : {1, -1}, default 1
        Of dy/dt = side H(y, lam). Stored numbers depend on it, Hopf points do not.
    k : int, optional
        Rightmost eigenvalues to compute, by Arnoldi's method. Default: all if at most 100, else 6.
    terminal : int, default 0
        The trace ends at the k-th occurrence; 0: never.
    direction : int, default 0
        +1: only if a pair becomes unstable; -1: only if stable.
    """

    side: int = field(default=1, validator=one_of(1, -1))
    k: int | None = field(default=None, validator=optional(integer(1)))
    terminal: int = field(default=0, validator=integer(0))
    direction: int = field(default=0, validator=sign)
    kind: Kind = field(default=Kind.HOPF, init=False)
    name: str = field(default="Hopf point", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """A constant: the `bound` event watches."""
        return 1.0

    def bound(self, evaluator: Evaluator) -> BoundHopf:
        """The event for one path.

        Parameters
        ----------
        evaluator : Evaluator
            Of the homotopy.
        """
        evaluator.keeping = True
        return BoundHopf(evaluator, *astuple(self))


@frozen
class Stability:
    """An observer that stores stability and locates Hopf points.

    Points and events have ``observed["unstable"]``, the number of unstable eigenvalues; ``"rightmost"``, the largest
    real part; ``"frequency"``, the imaginary part of the complex pair nearest to the axis, or nan; ``"covered"``, 1 if
    none can be missing. Pictures are solid where stable, else dashed. A `Symmetric` H_y has ``"unstable"`` only.

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
        """Hopf points: ``trace_both(homotopy, events=Stability().events)`` does the same."""
        return (HopfPoint(self.side, self.k, self.terminal),)

    def step(self, tracer: Any, step: Step) -> None:
        """The event stores the numbers."""

    def event(self, tracer: Any, event: LocatedEvent) -> None:
        """The event stores the numbers."""

    def end(self, tracer: Any) -> None:
        """Nothing is left to do."""


@define(eq=False)
class BoundHopf:
    """`HopfPoint` on one path."""

    evaluator: Evaluator
    side: int
    k: int | None
    terminal: int
    direction: int
    kind: Kind
    name: str
    _known: dict[Any, Spectrum] = field(factory=dict, init=False)

    def at(self, u: Array) -> Spectrum:
        """Eigenvalues at a point, on the path's present piece."""
        key = (id(self.evaluator.homotopy), u.tobytes())
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
        """Numbers to store."""
        found = self.at(u)
        if not found.values.size:
            return {"unstable": float(found.unstable)}
        pairs = found.pairs
        frequency = float(pairs.imag[np.argmin(np.abs(pairs.real))]) if pairs.size else np.nan
        known = (float(found.unstable), found.rightmost, frequency, float(found.covered))
        return dict(zip(("unstable", "rightmost", "frequency", "covered"), known))

    def found_on(self, solver: PathSolver, arc: Arc) -> list[Linearization]:
        """Hopf points of an arc, in order."""
        found: list[Linearization] = []
        for (left, before), (right, after) in pairwise(self._looks(arc)):
            p, q = before.unstable_pairs, after.unstable_pairs
            # A pair that becomes real, or the reverse, changes no other number.
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
        """Real part of a pair, rightmost first; smooth if it crosses alone."""
        found = self.at(u)
        if rank >= found.pairs.size:
            return -found.size
        pair = found.pairs[rank]
        return float(pair.real) if abs(pair.real) > ZERO_RESOLVED * abs(pair) else 0.0

    def _located(self, solver: PathSolver, arc: Arc, left: float, right: float, rank: int) -> Linearization | None:
        """The zero of a pair's real part on the path, or None."""
        ends = {0.0: arc.a.u, 1.0: arc.b.u}

        def real_part(t: float) -> float:
            return self._real_part(
                ends[t] if t in ends else solver.project(arc.a, arc.segment.at(t), arc.border)[0], rank
            )

        a, b = (left, real_part(left)), (right, real_part(right))
        # The segment may differ from the path.
        t = None if a[1] * b[1] > 0.0 else root(real_part, a, b, solver.noise(arc.a) / arc.length)
        if t is None:
            return None
        at = solver.project_and_linearize(arc.a if t < 0.5 else arc.b, arc.segment.at(t), arc.border)
        pairs = self.at(at.u).pairs
        return at if (np.abs(pairs.real) <= ON_AXIS * np.abs(pairs)).any() else None

    def accounts_for(self, arc: Arc, found: Sequence[tuple[Kind, Linearization]]) -> bool:
        """Whether the events explain the change in the number of unstable eigenvalues."""
        length = position(arc, arc.b.u)
        places = [(kind, position(arc, point.u) / length) for kind, point in found]
        for (left, before), (right, after) in pairwise(self._looks(arc)):
            sure = before.covered and after.covered and not (before.critical or after.critical)
            near = [CROSSING.get(kind, 0) for kind, t in places if left - EVENT_MARGIN <= t <= right + EVENT_MARGIN]
            if sure and abs(after.unstable - before.unstable) > sum(near):
                return False
        return True
