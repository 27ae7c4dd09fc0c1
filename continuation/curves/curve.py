"""The curve that an event draws when a second parameter moves, as a homotopy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arrays import Array, Matrix
from continuation.bibliography import GOVAERTS
from continuation.checks import FINITE, complain, real_vector
from continuation.curves.calculus import Calculus, calculus_at
from continuation.curves.conditions import AlongTangent, Condition, HopfPoint, Local, Singular, Vanishing
from continuation.curves.elimination import Eliminated, eliminated
from continuation.curves.frequency import frequency_at
from continuation.evaluation.derivatives import sizes
from continuation.evaluation.evaluator import EvaluationError
from continuation.events import Event, Monitor, TargetValue
from continuation.events.singularity import full_derivative
from continuation.homotopy import SupportsPieces
from continuation.labels import Labels
from continuation.linear import SingularError
from continuation.status import Kind
from continuation.steps import LocatedEvent

LAST = 6
"""Points whose factorisations are kept: a corrector asks for the residual and the derivative at one, and events that
lie on an arc look at its ends again."""

PERSISTS = 1e-6
"""What mu may do to H at a branch point, along the vector that H' does not reach, beside what it does to H at all: more,
and branch points do not persist. The root of round-off and of the differences behind it."""

NEWTON = 20
"""At most so many increments for the start; they end where they no longer shrink."""

KINDS = (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.KINK, Kind.HOPF)
"""What an event can be by its kind alone; of others the function is needed."""


def _event(value: Any) -> Any:
    """The event itself, of a located one its kind."""
    kind = value.kind if isinstance(value, LocatedEvent) else value
    if kind == Kind.TURNING_POINT and isinstance(value, LocatedEvent) and value.name != "turning point":
        raise ValueError(f"event: a {value.name} is no fold; give TurningPoint(component), and the point as `at`")
    if not isinstance(value, LocatedEvent) and not isinstance(value, Kind) and hasattr(value, "monitor"):
        return value
    if kind not in KINDS:
        expected = "a turning point, branch point, Hopf point or kink, located or as a Kind, or an event with a monitor"
        raise complain(TypeError, "event", expected, value)
    return Kind(kind)


def _point(at: Any) -> tuple[Array, float]:
    if hasattr(at, "u"):
        at = (at.u[:-1], float(at.u[-1]))
    if not isinstance(at, tuple | list) or len(at) != 2 or np.ndim(at[1]):
        raise complain(TypeError, "at", "a located event, a step, or a pair (y, lam)", at)
    y, lam = np.atleast_1d(real_vector("at", at[0])), float(real_vector("at", at[1]))
    if y.ndim != 1 or not (np.isfinite(y).all() and np.isfinite(lam)):
        raise complain(ValueError, "at", "finite numbers", at)
    return y, lam


@frozen(eq=False, slots=False, init=False)
class Curve:
    """The curve of an event in a second parameter: H(y, lam; mu) = 0 and g(y, lam; mu) = 0, a homotopy in mu.

    Its unknowns are (y, lam), and beside them the frequency of Hopf points, and an imperfection at branch points, which
    stays zero. It is traced, stored, plotted and watched like any other; mu is what a trace calls the parameter.

    ===========================  =======================================================================
    event                        what holds along the curve
    ===========================  =======================================================================
    a turning point (fold)       H_y is singular
    a branch point               H' = [H_y, H_lam] loses a rank, as it does in symmetric problems for every mu
    a Hopf point                 H_y has a pair of eigenvalues +- i omega
    a kink                       the switch that vanished there vanishes
    ``TargetValue(value, k)``    the unknown k, or lam, keeps its value
    ``TurningPoint(k)``          the unknown k turns
    ``Monitor(function)``        the function of point and tangent vanishes
    ===========================  =======================================================================

    Along fold curves cusps and Bogdanov-Takens points are located; a Hopf curve ends where its frequency is zero, which
    is a Bogdanov-Takens point. A cusp is a turning point of both parameters; where mu alone turns on a fold curve, two
    branches cross in the family's member there, or a closed curve of it shrinks to a point.

    Nothing is densified: the system is solved by elimination with the family's own factorisation, or, where H_y is
    singular, one of H_y with a border of its own; second derivatives come from jets (up to 128 unknowns), or from two
    Jacobians. A border that becomes nearly orthogonal to the null vector that it is to see is replaced by that vector,
    at every point anew: nothing is remembered, so a path that is resumed is the one that was never stopped.

    Parameters
    ----------
    family : callable
        From mu to a homotopy: ``Family(homotopy, "attribute")``, a class, a function. Called with a jet, it gives a
        homotopy whose residual runs on jets, or raises TypeError or ValueError.
    event : LocatedEvent, Kind or Event
        A point located on a path of a member of the family, or what kind of point it is (`Kind.TURNING_POINT`,
        BRANCH_POINT, HOPF, KINK), or an event with a monitor.
    at : LocatedEvent, Step or (y, lam), optional
        Where the curve begins, about; by default the located event.
    mu : float, optional
        The second parameter there; by default the value that a `Family` has.
    frequency : float, optional
        Of a Hopf point, about; by default that of the eigenvalues of H_y which are nearest to the imaginary axis.
    size : array_like, shape (N + 1,), optional
        How far y and lam go, about; by default the metric of the located event, or the size of y and lam.

    Raises
    ------
    TypeError, ValueError
        If there is no point or no mu to begin with, or the event has no function that could vanish elsewhere.

    References
    ----------
    W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, chapters 3, 4 and 8.
    """

    family: Any
    event: Any
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
        y, lam = _point(at)
        if size is None:
            weights = getattr(at, "weights", None)
            size = sizes(np.append(y, lam)) if weights is None else 1.0 / np.sqrt(weights)
        size = real_vector("size", size)
        if size.shape != (y.size + 1,) or not (size > 0.0).all():
            raise complain(ValueError, "size", f"{y.size + 1} positive numbers", size)
        self.__attrs_init__(family, _event(event), (y, lam), mu, frequency, size)  # type: ignore[attr-defined]
        object.__setattr__(self, "_recent", {})
        member = family(self.mu)
        if hasattr(member, "observe"):
            object.__setattr__(self, "observe", self._observed)
        if hasattr(member, "max_step"):
            object.__setattr__(self, "max_step", self._room)

    def __reduce__(self) -> Any:
        return Curve, (self.family, self.event, self.at, self.mu, self.frequency, self.size)

    def start(self) -> tuple[Array, float]:
        """The point (y, lam), with the frequency or the imperfection 0, and mu.

        Raises
        ------
        ValueError
            If branch points of the family do not persist when mu moves.
        """
        return self._corrected.copy(), self.mu

    @cached_property
    def _corrected(self) -> Array:
        """The point brought onto the curve at its mu, if Newton's method does that; a path that is straight to
        infinity, as some curves are, gives a trace no length to measure by how far off its start is."""
        y = np.append(np.append(*self.at), self._beside)
        unit = np.append(np.zeros(y.size), 1.0)
        best, least = y, np.inf
        for _ in range(NEWTON):
            try:
                with np.errstate(all="ignore"):
                    z = self.bordered(y, self.mu, unit).solve(self.residual(y, self.mu), 0.0)[:-1]
            except ArithmeticError:
                break
            size = float(np.abs(z / np.append(self.size, np.ones(y.size - self.size.size))).max())
            if not size < least:
                break
            y, best, least = y - z, y, size
        return best

    @cached_property
    def _beside(self) -> Array:
        if self.event == Kind.HOPF:
            return np.array([self._frequency])
        if self.event != Kind.BRANCH_POINT:
            return np.empty(0)
        condition, calculus = self._condition, self._calculus
        local = condition.at(calculus.u0[:-1], 0.0, self.mu)
        H_mu = calculus.by_parameter(calculus.u0[:-1], self.mu)
        found = abs(float(local.base.solve(H_mu, 0.0)[-1])) * float(np.abs(local.column).max())
        if found > PERSISTS * float(np.abs(H_mu).max()):
            raise ValueError(
                "family: expected branch points for every mu, as in symmetric problems; here they part when mu moves "
                "(the turning points beside it are curves)"
            )
        return np.zeros(1)

    @cached_property
    def _frequency(self) -> float:
        if self.frequency is not None:
            return float(self.frequency)
        u = np.append(*self.at)
        return frequency_at(full_derivative(self._calculus.evaluator(self.mu), u)[:, :-1])

    @cached_property
    def _signs(self) -> Array | None:
        """Of the switches, at the start: the piece that the curve lies on."""
        member = self.family(self.mu)
        if not isinstance(member, SupportsPieces):
            return None
        signs = np.where(member.switches(*self.at) >= 0.0, 1, -1)
        if self._switch is not None:
            signs[self._switch] = 1
        return signs

    @cached_property
    def _switch(self) -> int | None:
        """Which of the switches vanishes along a curve of kinks."""
        if self.event != Kind.KINK:
            return None
        return int(np.argmin(np.abs(self.family(self.mu).switches(*self.at))))

    def _member(self, mu: Any) -> Any:
        member = self.family(mu)
        return member if self._signs is None else member.piece(self._signs)

    @cached_property
    def _calculus(self) -> Calculus:
        return calculus_at(self._member, np.append(*self.at), self.mu, self.size)

    @cached_property
    def _condition(self) -> Condition:
        calculus, event = self._calculus, self.event
        if event in (Kind.TURNING_POINT, Kind.BRANCH_POINT):
            return Singular.at_start(calculus, event == Kind.BRANCH_POINT)
        if event == Kind.HOPF:
            return HopfPoint.at_start(calculus, self._frequency)
        if self._plain is not None:
            return Vanishing.at_start(calculus, self._plain)
        return AlongTangent.at_start(calculus, lambda x: self.event.monitor(*np.split(x, 2)))

    @cached_property
    def _plain(self) -> Callable[[Any], Any] | None:
        """The function that vanishes, of (y, lam, mu) as one vector or jet; None where it looks at the tangent too."""
        event, k = self.event, self._switch
        if k is not None:
            return lambda U: self.family(U[-1]).switches(U[:-2], U[-2])[k]
        if isinstance(event, Kind):
            return None
        if isinstance(event, TargetValue):
            place = event.component if event.component >= 0 else event.component + self.size.size
            return lambda U: U[place] - event.value
        unknown = np.full(self.size.size, np.nan)
        if not np.isfinite(event.monitor(np.append(*self.at), unknown)):
            return None
        function = event.function if isinstance(event, Monitor) else event.monitor
        return lambda U: function(U[:-1], unknown)

    def residual(self, y: Array, lam: float) -> Array:
        """H, with the imperfection if there is one, and what is to vanish; shape (N + 1,) or (N + 2,).

        Parameters
        ----------
        y : ndarray
            The unknowns: y and lam of the family, and what is beside them.
        lam : float
            The second parameter, mu.
        """
        if not isinstance(y, np.ndarray) and self._plain is not None:
            # Jets and intervals.
            U = np.concatenate([y, np.stack([lam])])
            return np.concatenate([self._calculus.residual(U), np.stack([self._plain(U)])])
        local, u = self._at(y, lam), y[: self.size.size]
        H = np.array(self._member(lam).residual(u[:-1].copy(), float(u[-1])), dtype=float)
        return np.concatenate([H + local.column @ y[u.size :], local.values])

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """The derivative by the unknowns, dense or sparse as the family's, and by mu.

        Parameters
        ----------
        y : ndarray
        lam : float
        """
        local, u = self._at(y, lam), y[: self.size.size]
        full = full_derivative(self._calculus.evaluator(lam), u)
        last = np.append(self._calculus.by_parameter(u, lam), local.rows[:, -1])
        if sp.issparse(full):
            top = sp.hstack([full, sp.csc_array(local.column)])
            return sp.vstack([top, sp.csc_array(local.rows[:, :-1])], format="csc"), last
        return np.vstack([np.hstack([full, local.column]), local.rows[:, :-1]]), last

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """The derivative applied to a direction.

        Parameters
        ----------
        y : ndarray
        lam : float
        v : ndarray
            One longer than y.
        """
        local, u = self._at(y, lam), y[: self.size.size]
        apply = self._calculus.evaluator(lam).differential(u)
        if apply is None:
            raise EvaluationError("the family has a factorisation of its own and no `differential`")
        H = apply(v[: u.size]) + local.column @ v[u.size : -1] + v[-1] * self._calculus.by_parameter(u, lam)
        return np.concatenate([H, local.rows @ v])

    def bordered(self, y: Array, lam: float, border: Array) -> Eliminated:
        """The derivative with a border, factored by elimination.

        Parameters
        ----------
        y : ndarray
        lam : float
        border : ndarray
            One longer than y.
        """
        local, u = self._at(y, lam), y[: self.size.size]
        calculus = self._calculus
        apply = calculus.evaluator(lam).differential(u)
        if apply is None:
            raise EvaluationError("the family has a factorisation of its own and no `differential`")
        H_lam = apply(np.arange(u.size) == u.size - 1.0)
        columns = np.column_stack([H_lam, local.column, calculus.by_parameter(u, lam)])
        try:
            return eliminated(local.base, columns, np.vstack([local.rows, border]))
        except np.linalg.LinAlgError as error:
            raise SingularError(str(error)) from error

    def _at(self, y: Array, lam: float) -> Local:
        """The condition at a point, kept for a while."""
        recent: dict[bytes, Local] = self.__dict__["_recent"]
        key = np.append(y, lam).tobytes()
        if key not in recent:
            beside = float(y[-1]) if self._condition.beside else 0.0
            with np.errstate(all="ignore"):
                recent[key] = self._condition.at(y[: self.size.size].copy(), beside, float(lam))
            if len(recent) > LAST:
                del recent[next(iter(recent))]
        return recent[key]

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Degenerate points: cusps and Bogdanov-Takens points; where another switch of a piecewise map vanishes."""
        found: list[Event] = []
        if self.event == Kind.TURNING_POINT:
            found = [Sign(self, name) for name in ("cusp", "Bogdanov-Takens")]
        if self.event == Kind.HOPF:
            found = [Monitor(lambda u, v: u[-2], "Bogdanov-Takens", terminal=1)]
        if self._signs is not None:
            found += [OtherSwitch(self, i) for i in range(self._signs.size) if i != self._switch]
        return tuple(found)

    @property
    def parameter_name(self) -> str:
        """What the family calls its parameter."""
        return getattr(self.family, "parameter_name", None) or "mu"

    @property
    def names(self) -> tuple[str, ...]:
        """Those of the member's unknowns, if it names them, of its parameter, and of what is beside."""
        labels = Labels.of(self.family(self.mu))
        if not labels.names:
            return ()
        return (*labels.names, labels.parameter_name or "lambda", *self._condition.beside)

    @property
    def units(self) -> Mapping[str, str]:
        """Those of the member."""
        return Labels.of(self.family(self.mu)).units

    @property
    def references(self) -> tuple[str, ...]:
        """Those of the member, and of the method."""
        return (*getattr(self.family(self.mu), "references", ()), GOVAERTS)

    def _observed(self, y: Array, lam: float) -> dict[str, float]:
        """What the member observes."""
        n = self.size.size - 1
        observed: dict[str, float] = self.family(lam).observe(y[:n], float(y[n]))
        return observed

    def _room(self, u: Array, v: Array) -> float:
        """How far the member's path may go: mu stands still for it."""
        n = self.size.size
        return float(self._member(u[-1]).max_step(u[:n], v[:n]))


@frozen(eq=False)
class Sign:
    """Where a number changes its sign that a condition gives along with its values."""

    curve: Curve = field(repr=False)
    name: str
    terminal: int = field(default=0, init=False)
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.EVENT, init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """The number."""
        return self.curve._at(u[:-1], float(u[-1])).sign(self.name)


@frozen(eq=False)
class OtherSwitch:
    """Where another switch of a piecewise smooth map vanishes: there the curve leaves the piece that it was begun on."""

    curve: Curve = field(repr=False)
    index: int
    terminal: int = field(default=1, init=False)
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.EVENT, init=False)

    @property
    def name(self) -> str:
        """Which of them."""
        return f"switch {self.index} vanishes"

    def monitor(self, u: Array, v: Array) -> float:
        """The switch."""
        n = self.curve.size.size - 1
        return float(self.curve.family(float(u[-1])).switches(u[:n], float(u[n]))[self.index])
