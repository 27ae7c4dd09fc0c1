"""Periodic orbits by orthogonal collocation."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import Factory, evolve, field, fields_dict, frozen

from continuation.arguments.checks import FINITE, POSITIVE_FINITE, expect, real_vector
from continuation.arrays import Array, generic_vector
from continuation.curves.beginning import as_point
from continuation.evaluation.products import sizes
from continuation.events import Event, Monitor
from continuation.metric import Weighted
from continuation.step.extent import REPLACED
from problems.bibliography import DE_BOOR_SWARTZ, WRIGHT
from problems.options import quiet
from problems.orbits.arguments import DEGREES, Asked, as_mesh, as_table, check_times, spread
from problems.orbits.equations import PHASE_COSINE, Equations
from problems.orbits.field import field_of
from problems.orbits.grid import Grid
from problems.orbits.models import Model
from problems.orbits.multipliers import Multipliers
from problems.orbits.newton import newton
from problems.orbits.starts import MESHES, circle_at, explained, one_period, units_at_rest


@frozen(eq=False, slots=False)
class PeriodicOrbit:
    """Periodic orbits of x' = f(x, p): X' = T f(X, p), X(0) = X(1), and a phase condition.

    X is a continuous piecewise polynomial of degree m, collocated at m Gauss points of N intervals. Its error is of
    order m + 1 in their lengths, 2 m at mesh points and in the period (de Boor and Swartz, SIAM J. Numer. Anal. 10,
    1973). Unknowns are X at N m nodes, T, and N - 1 inner mesh points, which equations fix. The phase condition is int
    <X, X_ref'> = 0, X_ref the given orbit.

    Parameters
    ----------
    f : callable
        ``f(x, p)`` or ``f(x, p, second)``, n numbers. It may accept x of shape (n, k).
    states : array_like, shape (N m, n)
        Approximate orbit at each interval's Chebyshev-Lobatto points but the last.
    period : float
    parameter : float
    mesh : int or array_like, shape (N + 1,)
        Number of equal intervals, or points from 0 to 1.
    degree : int
    jacobian : callable, optional
        ``jacobian(x, p)`` gives (f_x, f_p), shapes (n, n) and (n,), or (n, n, k) and (n, k). Default: complex steps,
        else differences.
    second : float, optional
        Passed after p, varied by curves of bifurcations.
    smallest : float
        Amplitude over `scale` at which the path ends at a Hopf point.
    scale : array_like, shape (n,), optional
        Default: standard deviations.
    heading : array_like, shape (N m, n), optional
        Change of X along a new branch.
    """

    f: Model | Callable[..., Any]
    states: Array = field(converter=as_table, repr=False)
    period: float = field(validator=POSITIVE_FINITE)
    parameter: float = field(validator=FINITE)
    mesh: Array = field(default=20, converter=as_mesh, repr=False)
    degree: int = field(default=4, validator=DEGREES)
    jacobian_of_f: Callable[..., Any] | None = field(default=None, alias="jacobian")
    second: Any = None
    smallest: float = field(default=1e-3, validator=POSITIVE_FINITE)
    scale: Array = field(
        default=Factory(lambda self: spread(self.states), takes_self=True), converter=np.asarray, repr=False
    )
    heading: Array | None = field(default=None, repr=False)
    target: ClassVar[None] = None
    renewed_at: ClassVar[tuple[str, ...]] = ("phase condition fails",)
    parameter_name: ClassVar[str] = "p"
    problem_class: ClassVar[str] = "periodic orbits"
    references: ClassVar[tuple[str, ...]] = (DE_BOOR_SWARTZ, WRIGHT)

    def __attrs_post_init__(self) -> None:
        (rows, n), wanted = self.states.shape, (self.mesh.size - 1) * self.degree
        expect(rows == wanted, "states", f"{wanted} rows, one a node", rows)
        expect(self.scale.shape == (n,) and (self.scale > 0.0).all(), "scale", f"{n} positive numbers", self.scale)
        assert self.equations

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in fields_dict(PeriodicOrbit)}

    @cached_property
    def equations(self) -> Equations:
        """The collocation equations."""
        f = field_of(self.f, self.jacobian_of_f, self.second, self.states[0], self.scale, self.parameter)
        return Equations(f, Grid(self.mesh, self.degree), self.scale, self.states)

    @classmethod
    def from_hopf(
        cls, f: Any, point: Any, *, radius: float = 1e-2, intervals: int = 20, degree: int = 4, **beside: Any
    ) -> PeriodicOrbit:
        """Small orbit near a Hopf point; trace from `leaving`.

        Parameters
        ----------
        f : callable
        point : LocatedEvent or (x, p)
            See `continuation.Stability`.
        radius : float
            Relative to the size at which f is no longer linear.
        intervals, degree : int
        **beside
            `jacobian` and `second`.

        Raises
        ------
        ValueError, ArithmeticError
            If there is no Hopf point or Newton's method fails.
        """
        x, p = as_point(point, "point")
        grid = Asked(intervals, degree, radius).grid
        field = field_of(f, beside.get("jacobian"), beside.get("second"), x, sizes(x), p)
        x, motion, period, scale = circle_at(field, x, p, grid)
        given = cls(
            f, x + radius * motion, period, p, grid.mesh, degree, smallest=radius / 4.0, scale=scale, heading=motion,
            **beside,
        )  # fmt: skip
        return given._corrected(motion)

    @classmethod
    def from_solution(
        cls, f: Any, t: Any, x: Any, parameter: float, *, intervals: int = 20, degree: int = 4, **beside: Any
    ) -> PeriodicOrbit:
        """The orbit on which a simulation settles.

        Parameters
        ----------
        f : callable
        t : array_like, shape (k,)
        x : array_like, shape (k, n)
            A settled simulation, at least one period.
        parameter : float
        intervals, degree : int
        **beside
            `jacobian` and `second`.

        Raises
        ------
        ValueError, ArithmeticError
            If the simulation does not return or Newton's method fails.
        """
        times, states = real_vector("t", t), as_table(x)
        check_times(times, states)
        field = field_of(f, beside.get("jacobian"), beside.get("second"), states[-1], spread(states), parameter)
        states = explained(field, times, states, parameter)
        cut, period, grid = one_period(field, times, states, parameter, Asked(intervals, degree).grid)
        found = cls(f, cut, period, parameter, grid.mesh, degree, **beside)._corrected()
        # A simulation's errors at zero give no size.
        changed = np.abs(found.states - cut).max(axis=0)
        rest = (changed > REPLACED * np.abs(cut).max(axis=0)) | (found.scale > np.abs(cut - cut[0]).max(axis=0))
        if rest.any():
            units = units_at_rest(field, found.states, parameter, found.period, found.scale, rest)
            found = evolve(found, scale=units)
        for _ in range(MESHES):
            found = cls.from_orbit(found)
        return found

    @classmethod
    def from_point(cls, f: Any, point: Any, components: int, *, degree: int = 4, **beside: Any) -> PeriodicOrbit:
        """Orbit at a path's point.

        Parameters
        ----------
        f, degree, **beside
            As for the class.
        point : LocatedEvent, Step or (y, p)
        components : int
            n.
        """
        y, p = as_point(point, "point")
        N, left = divmod(y.size, components * degree + 1)
        expect(N > 1 and not left, "point", f"N ({components} x {degree} + 1) unknowns", y.size)
        size = N * degree * components
        mesh = np.concatenate([[0.0], y[size + 1 :], [1.0]])
        return cls(f, y[:size].reshape(-1, components), y[size], p, mesh, degree, **beside)

    @classmethod
    def from_orbit(
        cls, orbit: PeriodicOrbit, at: Any = None, *, intervals: int | None = None, degree: int | None = None
    ) -> PeriodicOrbit:
        """An orbit on an adapted mesh.

        Parameters
        ----------
        orbit : PeriodicOrbit
        at : LocatedEvent, Step or (y, p), optional
            Point of its path, default its start.
        intervals, degree : int, optional
            Default: unchanged.
        """
        given, tangent = orbit._remeshed(at, intervals, degree, getattr(at, "tangent", None))
        return given._corrected(tangent)

    def _remeshed(
        self, at: Any, intervals: int | None = None, degree: int | None = None, v: Array | None = None
    ) -> tuple[PeriodicOrbit, Array | None]:
        y, lam = self.start() if at is None else as_point(at)
        old, X, T = self.equations.unknowns(y)
        new, times = old.suited(X / self.scale, intervals or old.intervals, degree or self.degree)
        given = evolve(self, states=old.at(X, times), mesh=new.mesh, degree=new.degree, heading=None)
        given = evolve(given, period=T, parameter=lam)
        if v is None or not np.isfinite(v).all():
            return given, None
        way = old.at(v[: X.size].reshape(X.shape), times)
        return given, np.concatenate([way.ravel(), v[X.size : X.size + 1], np.zeros(new.intervals - 1), v[-1:]])

    def doubled(self, at: Any = None, radius: float = 1e-2) -> PeriodicOrbit:
        """The orbit of twice the period at a period doubling; trace from `leaving`.

        Parameters
        ----------
        at : LocatedEvent, Step or (y, p), optional
            Default: the start.
        radius : float
            Distance in units of `scale`; at 0 a `continuation.Curve` of branch points begins.
        """
        y, lam = self.start() if at is None else as_point(at)
        grid, X, T = self.equations.unknowns(y)
        mode = evolve(self, mesh=grid.mesh, states=X).equations.here(y, lam).mode(-1.0)
        mode = mode / np.sqrt(np.mean((mode / self.scale) ** 2))
        twice, way = np.tile(X, (2, 1)), np.concatenate([mode, -mode])
        mesh = np.append(0.5 * grid.mesh[:-1], 0.5 + 0.5 * grid.mesh)
        given = evolve(self, states=twice, period=2.0 * T, parameter=lam, mesh=mesh, heading=way)
        return given._corrected(way, radius) if radius else given

    def _corrected(self, heading: Array | None = None, ahead: float = 0.0) -> PeriodicOrbit:
        """Newton's orbit at fixed p, or across `heading` at distance `ahead`."""
        u = np.append(*self.start())
        weights, border = self.metric.weights(u, u, None), np.append(np.zeros(u.size - 1), 1.0)
        if heading is not None:
            way = heading if heading.shape == u.shape else self._direction(heading)
            u, border = u + ahead * way, weights * way
        u = newton(self, u, weights, border)
        _, X, T = self.equations.unknowns(u[:-1])
        return evolve(self, states=X, period=T, parameter=float(u[-1]))

    def start(self) -> tuple[Array, float]:
        """The given orbit's unknowns and p."""
        return np.concatenate([self.states.ravel(), [self.period], self.mesh[1:-1]]), self.parameter

    @property
    def period_index(self) -> int:
        """Index of T, for ``TargetValue(50.0, component=orbit.period_index)``."""
        return self.states.size

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """X' - T f(X, p), phase condition and mesh equations; shape (N m n + N,)."""
        if not isinstance(y, np.ndarray) or y.dtype == object:
            raise TypeError("the residual of periodic orbits runs on arrays of floats alone")
        return self.equations.here(y, lam).residual()

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[sp.csc_array, Array]:
        """Derivatives by the unknowns, sparse, and by p."""
        return self.equations.here(y, lam).matrices

    def multipliers(self, y: Array, lam: float) -> Multipliers:
        """The Floquet multipliers.

        Parameters
        ----------
        y, lam : ndarray and float
        """
        return self.equations.here(y, lam).multipliers

    def at(self, y: Array, t: Any) -> Array:
        """Orbit at times of [0, 1], shape (len(t), n).

        Parameters
        ----------
        y, t : array_like
            Unknowns, and times in periods.
        """
        grid, X, _ = self.equations.unknowns(y)
        return grid.at(X, np.asarray(t, dtype=float))

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Period, extreme values, unstable multipliers, error estimates."""
        return self.equations.here(y, lam).observed()

    @property
    def events(self) -> tuple[Event, ...]:
        """Period doubling, torus, Hopf point, failure of the phase condition."""

        def watched(quantity: str, name: str, value: float = 0.0, **how: int) -> Monitor:
            def seen(u: Array, v: Array) -> float:
                return float(attrgetter(quantity)(self.equations.here(u[:-1], float(u[-1])))) - value

            return Monitor(seen, name, **how)

        return (
            watched("multipliers.doubling", "period doubling"),
            watched("multipliers.torus", "torus"),
            watched("amplitude", "Hopf point", self.smallest, terminal=1, direction=-1),
            watched("phase_cosine", "phase condition fails", PHASE_COSINE, terminal=1),
        )

    def renewed(self, u: Array, v: Array) -> tuple[PeriodicOrbit, Array, Array]:
        """An orbit on an adapted mesh; see `continuation.tracing`."""
        given, tangent = self._remeshed((u[:-1], float(u[-1])), v=v)
        assert tangent is not None
        new = given._corrected(tangent)
        return new, np.append(*new.start()), tangent

    @cached_property
    def metric(self) -> Weighted:
        """Mean square of scaled X, relative T, and p by its effect on X, or beside X, as p may move no symmetric X."""
        X = np.tile(self.scale, len(self.states)) * np.sqrt(self.states.size)
        size = np.concatenate([X, [self.period], np.ones(self.mesh.size - 2)])
        aside = self.states + self.scale * generic_vector(self.states.size).reshape(self.states.shape)
        moved = [self.equations.flow.derivatives(x.T, self.parameter)[1] / self.scale for x in (self.states, aside)]
        reach = self.period * float(np.sqrt(np.mean(np.square(moved), axis=(1, 2)).max()))
        return Weighted(size**-2.0, reach**2 if reach > 0.0 else 1.0)

    @property
    def leaving(self) -> tuple[Array, Array]:
        """Start and direction for ``trace(orbit, start=orbit.leaving)``."""
        y, lam = self.start()
        away = self.states - self.states.mean(axis=0) if self.heading is None else self.heading
        return np.append(y, lam), self._direction(away)

    def _direction(self, motion: Array) -> Array:
        return np.append(motion, np.zeros(self.mesh.size))
