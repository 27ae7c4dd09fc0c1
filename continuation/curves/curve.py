"""The curve of an event in a second parameter, as a homotopy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, complain
from continuation.arguments.labels import Labels
from continuation.arrays import SIX_DIGITS, Array
from continuation.citation.bibliography import GOVAERTS
from continuation.curves.beginning import as_event, as_point, as_size, corrected, frequency_at
from continuation.curves.calculus import Calculus, calculus_at
from continuation.curves.conditions import Eigenvalue
from continuation.curves.here import CurvePoint
from continuation.curves.monitors import Vanishing, plainly, without_tangent
from continuation.curves.written import WrittenOut
from continuation.events import Event, Monitor
from continuation.events.singularity import full_derivative
from continuation.homotopy import SupportsPieces
from continuation.linear import BorderedSystem
from continuation.status import Kind

POINTS_KEPT = 6
"""Points and members kept for reuse."""


@frozen(eq=False, slots=False, init=False)
class Curve:
    """The curve of an event in a second parameter: H(y, lam; mu) = 0 and g(y, lam; mu) = 0, a homotopy in mu.

    The unknowns are (y, lam), and the frequency for Hopf points; mu is the parameter of a trace.

    ===========================  =======================================================================
    event                        what holds along the curve
    ===========================  =======================================================================
    a turning point (fold)       H_y is singular
    a branch point               H' = [H_y, H_lam] loses a rank, in symmetric problems for every mu
    a Hopf point                 H_y has a pair of eigenvalues +- i omega
    a kink                       the same switch vanishes
    ``TargetValue(value, k)``    the unknown k, or lam, keeps its value
    ``TurningPoint(k)``          the unknown k turns
    ``Monitor(function)``        the function of point and tangent vanishes
    ===========================  =======================================================================

    Fold curves locate cusps (both parameters turn) and Bogdanov-Takens points; where only mu turns, two branches cross
    or a closed one shrinks to a point. Hopf curves end at Bogdanov-Takens points and locate "zero-Hopf" points (H_y
    singular).

    Factorisations are the family's, or of H_y with a border, and stay sparse. Second derivatives come from jets (up to
    128 unknowns) or two Jacobians.

    Parameters
    ----------
    family : callable
        Maps mu to a homotopy: ``Family(homotopy, "attribute")``, a class, a function. It may refuse jets by TypeError
        or ValueError.
    event : LocatedEvent, Kind or Event
        A point on a member's path, its kind (`Kind.TURNING_POINT`, BRANCH_POINT, HOPF, KINK), or an event's monitor.
    at : LocatedEvent, Step or (y, lam), optional
        Approximate start; by default the event.
    mu : float, optional
        By default the `Family`'s value.
    frequency : float, optional
        Approximate Hopf frequency; by default from eigenvalues of H_y.
    size : array_like, shape (N + 1,), optional
        Scales of y and lam; by default from the event's metric, or their sizes.

    Raises
    ------
    TypeError, ValueError
        If there is no start or mu, or the event has no function.

    References
    ----------
    W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, chapters 3, 4 and 8.
    """

    family: Any
    event: Any = field(converter=as_event)
    at: tuple[Array, float] = field(repr=False)
    mu: float = field(validator=FINITE)
    frequency: float | None
    size: Array = field(repr=False)
    target: None = field(default=None, init=False, repr=False)

    def __init__(
        self,
        family: Any,
        event: Any,
        at: Any = None,
        mu: float | None = None,
        frequency: float | None = None,
        size: Any = None,
    ) -> None:
        if not callable(family):
            raise complain(TypeError, "family", "a function from mu to a homotopy, or a Family", family)
        at = event if at is None else at
        if mu is None and (mu := getattr(family, "value", None)) is None:
            raise complain(ValueError, "mu", "a number, since the family has no value of its own", mu)
        y, lam = as_point(at)
        self.__attrs_init__(family, event, (y, lam), mu, frequency, as_size(size, at, np.append(y, lam)))

    def __attrs_post_init__(self) -> None:
        member = self.family(self.mu)
        unknowns = np.size(member.start()[0])
        if unknowns != self.at[0].size:
            raise ValueError(f"at: expected {unknowns} unknowns, as the family has, found {self.at[0].size}")
        if self.event == Kind.KINK and not isinstance(member, SupportsPieces):
            raise complain(TypeError, "family", "piecewise smooth homotopies, with `switches` and `piece`", member)
        if hasattr(member, "observe"):
            object.__setattr__(self, "observe", self._observed)
        if hasattr(member, "max_step"):
            object.__setattr__(self, "max_step", self._room)

    def __reduce__(self) -> Any:
        return Curve, (self.family, self.event, self.at, self.mu, self.frequency, self.size)

    def start(self) -> tuple[Array, float]:
        """The start, brought onto the curve: unknowns and mu.

        Raises
        ------
        ValueError
            If the family's branch points do not persist.
        """
        y = self._corrected.copy()
        if self.event == Kind.BRANCH_POINT:
            here = self._at(y, self.mu)
            found = abs(float(here.base.solve(here.by_parameter, 0.0)[-1])) * np.abs(here.column).max()
            # Branch points persist if mu has no effect on H along the left null vector.
            if found > SIX_DIGITS * np.abs(here.by_parameter).max():
                raise ValueError("family: expected branch points for every mu, as in symmetric problems; these part")
        return y, self.mu

    @cached_property
    def _corrected(self) -> Array:
        beside = [self._frequency] if self.event == Kind.HOPF else []
        return corrected(self, np.array([*self.at[0], self.at[1], *beside, self.mu]))

    @property
    def extents(self) -> Array:
        """Scales of the unknowns and mu."""
        beside = [abs(self._frequency) or 1.0] if self.event == Kind.HOPF else []
        return np.array([*self.size, *beside, abs(self.mu) or 1.0])

    @cached_property
    def _frequency(self) -> float:
        if self.frequency is not None:
            return float(self.frequency)
        u = np.append(*self.at)
        return frequency_at(full_derivative(self._calculus.evaluator(self.mu), u)[:, :-1])

    @cached_property
    def _signs(self) -> Array | None:
        member = self.family(self.mu)
        return np.where(member.switches(*self.at) >= 0.0, 1, -1) if isinstance(member, SupportsPieces) else None

    @cached_property
    def _switch(self) -> int | None:
        return int(np.argmin(np.abs(self.family(self.mu).switches(*self.at)))) if self.event == Kind.KINK else None

    def _member(self, mu: Any) -> Any:
        return self._members(mu) if isinstance(mu, float) else self._made(mu)

    @cached_property
    def _members(self) -> Callable[[float], Any]:
        return lru_cache(POINTS_KEPT)(self._made)

    def _made(self, mu: Any) -> Any:
        member = self.family(mu)
        return member if self._signs is None else member.piece(self._signs)

    @cached_property
    def _calculus(self) -> Calculus:
        return calculus_at(self._member, np.append(*self.at), self.mu, self.size)

    @cached_property
    def _condition(self) -> Eigenvalue | Vanishing:
        calculus, event = self._calculus, self.event
        if event in (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.HOPF):
            return Eigenvalue.at_start(calculus, event, self._frequency if event == Kind.HOPF else 0.0)
        plain = self._plain
        return Vanishing.at_start(calculus, plain or (lambda x: plainly(event)(*np.split(x, 2))), plain is None)

    @cached_property
    def _plain(self) -> Callable[[Any], Any] | None:
        k = self._switch
        if k is not None:
            return lambda U: self.family(U[-1]).switches(U[:-2], U[-2])[k]
        return None if isinstance(self.event, Kind) else without_tangent(self.event, np.append(*self.at))

    def residual(self, y: Array, lam: float) -> Array:
        """H and the conditions; shape (N + 1,), or (N + 2,) for Hopf points.

        Parameters
        ----------
        y : ndarray
            Unknowns: y and lam of the family, and the frequency.
        lam : float
            The second parameter, mu.

        Raises
        ------
        TypeError
            For jets and intervals, if the condition needs a factorisation.
        """
        if not isinstance(y, np.ndarray) or y.dtype == object:
            if self._plain is None:
                what = self.event.name.lower().replace("_", " ") if isinstance(self.event, Kind) else "tangent's"
                raise TypeError(f"the residual of a {what} curve is not plain arithmetic: it takes a factorisation")
            U = np.concatenate([y, np.stack([lam])])
            return np.concatenate([self._calculus.residual(U), np.stack([self._plain(U)])])
        return self._at(y, lam).residual()

    def written_out(self, points: Array) -> WrittenOut | None:
        """Equations without factorisations, for `certify`; None if not needed.

        Parameters
        ----------
        points : ndarray, shape (m, N + 2) or (m, N + 3)
            The path's.
        """
        eliminates = self._plain is None and self.event != Kind.BRANCH_POINT
        return WrittenOut.of(self._condition, points) if eliminates else None

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """The derivative times a direction."""
        return self._at(y, lam).times(v)

    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Bordered derivative, factored by elimination."""
        return self._at(y, lam).bordered(border)

    def _at(self, y: Array, lam: float) -> CurvePoint:
        return self._points(np.append(y, lam).tobytes())

    @cached_property
    def _points(self) -> Callable[[bytes], CurvePoint]:
        def at(coordinates: bytes) -> CurvePoint:
            u, beside, mu = np.split(np.frombuffer(coordinates).copy(), [self.size.size, -1])
            with np.errstate(all="ignore"):
                return self._condition.at(u, float(beside.sum()), float(mu[0]))

        return lru_cache(POINTS_KEPT)(at)

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Degenerate points: cusps, Bogdanov-Takens and zero-Hopf points, zeros of other switches."""
        names = {Kind.HOPF: ("zero-Hopf",), Kind.TURNING_POINT: ("cusp", "Bogdanov-Takens")}.get(self.event, ())
        found: list[Event] = [Monitor(_frequency, "Bogdanov-Takens", 1)] if self.event == Kind.HOPF else []
        found += [Monitor(partial(self._sign, name), name) for name in names]
        others = [i for i in range(np.size(self._signs)) if i != self._switch] if self._signs is not None else []
        return (*found, *(Monitor(partial(self._other, i), f"switch {i} vanishes", 1) for i in others))

    def _sign(self, name: str, u: Array, v: Array) -> float:
        here = self._at(u[:-1], float(u[-1]))
        return here.signs[name](here)

    def _other(self, i: int, u: Array, v: Array) -> float:
        n = self.size.size - 1
        return float(self.family(float(u[-1])).switches(u[:n], float(u[n]))[i])

    @property
    def parameter_name(self) -> str:
        """Parameter name of the family."""
        return getattr(self.family, "parameter_name", None) or "mu"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns, if any."""
        labels = Labels.of(self.family(self.mu))
        beside = (labels.parameter_name or "lambda", *self._condition.beside)
        return (*labels.names, *beside) if labels.names else ()

    @property
    def units(self) -> Mapping[str, str]:
        """The member's units."""
        return Labels.of(self.family(self.mu)).units

    @property
    def references(self) -> tuple[str, ...]:
        """References of member and method."""
        return (*getattr(self.family(self.mu), "references", ()), GOVAERTS)

    def _observed(self, y: Array, lam: float) -> dict[str, float]:
        n = self.size.size - 1
        return dict(self.family(lam).observe(y[:n], float(y[n])))

    def _room(self, u: Array, v: Array) -> float:
        return float(self._member(u[-1]).max_step(u[: self.size.size], v[: self.size.size]))


def _frequency(u: Array, v: Array) -> float:
    return float(u[-2])
