"""Counted evaluations of a homotopy at u = (y, lam)."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np
from attrs import frozen
from scipy.linalg.blas import dasum, dscal

from continuation.arguments.checks import instance_with, real_vector
from continuation.arrays import Array, Matrix, finite, largest
from continuation.counts import Counts
from continuation.evaluation.derivatives import Derivative, check_derivative, from_residual, given_pattern
from continuation.evaluation.errors import EvaluationError, NotFiniteError, SingularPointError, unevaluated
from continuation.evaluation.noise import LOOK, noise_along
from continuation.evaluation.pattern import Pattern, generic
from continuation.evaluation.pieces import WholeMap
from continuation.evaluation.products import given
from continuation.homotopy import (
    SupportsBordered,
    SupportsDifferential,
    SupportsJacobian,
    SupportsPieces,
    SupportsSparsity,
    offers,
)
from continuation.linear import BorderedSystem, SingularError, factor_bordered
from continuation.linear.dense import Dense
from continuation.linear.silence import Silence, silent

POINT_ULPS = 4.0
"""Round-off assumed in a point, in ulps."""

DERIVATIVES_KEPT = 2
"""Both ends of an arc."""


@frozen(eq=False, slots=False)
class CountedSystem:
    """A bordered factorisation with counted solves."""

    system: BorderedSystem
    counts: Counts

    def solve(self, r: Array, rho: float, approximate: bool = False) -> Array:
        """Bordered solve; EvaluationError if not finite."""
        self.counts.solves += 1
        system: Any = self.system
        try:
            z: Array = system.approximate(r, rho) if approximate else system.solve(r, rho)
        except SingularError as error:
            raise EvaluationError(str(error)) from error
        if type(self.system) is not Dense and not finite(z):
            raise EvaluationError("a bordered solve gave values that are not finite")
        return z

    def approximate(self, r: Array, rho: float) -> Array:
        """Solve without refinement, for iterations that measure their residual."""
        return self.solve(r, rho, self.approximates)

    @cached_property
    def sign(self) -> int:
        """Sign of the determinant; 0 if unknown."""
        return self.system.sign

    @cached_property
    def approximates(self) -> bool:
        """Whether `approximate` differs from `solve`."""
        return hasattr(self.system, "approximate")


class Evaluator:
    """Counted access to one homotopy; `TypeError` or `ValueError` if it is wrong.

    `methods`: BibTeX of derivatives that replace missing ones. `noise`: of H where above the effect of round-off in u,
    else 0, shape (N,); None if all are 0.
    """

    def __init__(self, homotopy: Any, counts: Counts) -> None:
        if isinstance(homotopy, type):
            name = homotopy.__name__
            raise TypeError(f"homotopy: expected an object, found the class {name}; make one, {name}(...)")
        self.counts = counts
        self.methods: set[str] = set()
        self.noise: Array | None = None
        self.bindings = 0
        self.bind(homotopy)
        if offers(homotopy, SupportsPieces):
            self.bind(WholeMap(homotopy, self.start()))

    def bind(self, homotopy: Any) -> None:
        """Evaluate this homotopy; `TypeError` if a method is missing."""
        for name in ("start", "residual"):
            if not callable(getattr(homotopy, name, None)):
                raise TypeError(f"homotopy: expected a method `{name}`, found none on {type(homotopy).__name__}")
        for name in ("jacobian", "bordered", "differential"):
            found = getattr(homotopy, name, None)
            if not (found is None or callable(found)):
                raise TypeError(f"homotopy: expected `{name}` to be a method, found {found!r}")
        self.homotopy = homotopy
        self.bindings += 1
        self.followed = True  # by jets
        self._checked = False
        self._kept: dict[bytes, tuple[Matrix, Array, Callable[[Array], Array]]] = {}
        self._bordered = homotopy.bordered if offers(homotopy, SupportsBordered) else None
        self._differential = homotopy.differential if offers(homotopy, SupportsDifferential) else None
        self._derivative: Callable[[Array, float], tuple[Matrix, Array]] | None = None
        if offers(homotopy, SupportsJacobian):
            self._derivative = homotopy.jacobian

    def _given(self) -> Array:
        answer = self.homotopy.start()
        if not isinstance(answer, tuple) or len(answer) != 2:
            raise ValueError(f"start: expected a tuple (y0, lam0), found {type(answer).__name__}")
        y0, lam0 = np.atleast_1d(real_vector("start", answer[0])), real_vector("start", answer[1])
        if lam0.size != 1:
            raise ValueError(f"start: expected lam0 to be one number, found shape {lam0.shape}")
        if y0.ndim != 1 or y0.size == 0:
            raise ValueError(f"start: expected y0 to be a vector of at least one number, found shape {y0.shape}")
        u: Array = np.append(y0, lam0)
        if not np.isfinite(u).all():
            raise ValueError("start: expected finite numbers, found NaN or infinity")
        return u

    def start(self) -> Array:
        """Checked start (y0, lam0) as one vector."""
        u = self._given()
        y0 = u[:-1]
        self._sparsity(y0.size)
        r = np.asarray(self.called(y0.copy(), float(u[-1])))
        if r.shape != y0.shape:
            raise ValueError(f"residual: expected shape {y0.shape}, that of y0, found {r.shape}")
        if r.dtype.kind not in "fiu":
            names = {"c": "complex ones", "b": "truth values"}
            found = names.get(r.dtype.kind, f"an array of the type {r.dtype}")
            raise ValueError(f"residual: expected real numbers, found {found}")
        return u

    def _sparsity(self, n: int) -> Pattern | None:
        return given_pattern(self.homotopy.sparsity, n) if offers(self.homotopy, SupportsSparsity) else None

    def called(self, y: Any, lam: Any) -> Any:
        """The plug-in's residual, counted; accepts jets."""
        self.counts.residuals += 1
        return self.homotopy.residual(y, lam)

    def residual(self, u: Array) -> Array:
        """H(u), shape (N,); EvaluationError if not finite."""
        if not silent():
            with Silence():
                return self.residual(u)
        self.counts.residuals += 1
        try:
            # Plug-ins may reuse their arrays.
            r: Array = np.array(self.homotopy.residual(u[:-1], u.item(-1)), float)
        except (ArithmeticError, ValueError) as error:
            raise unevaluated("residual", error) from error
        if not isfinite(dasum(r)):
            raise NotFiniteError("the residual is not finite")
        return r

    def residual_norm(self, u: Array) -> float:
        """Largest component of H(u), or nan."""
        try:
            return largest(self.residual(u))
        except EvaluationError:
            return math.nan

    def round_off(self, u: Array, residual: Array, least: float | Array = 0.0) -> Array:
        """The effect of round-off in u on H(u) = `residual`, shape (N,), by two perturbations: in one, terms may
        cancel.
        """
        terms: Array = np.maximum(self.look(u, residual, 1, least), self.look(u, residual, -1, least))
        return terms

    def look(self, u: Array, residual: Array, order: int = 1, least: float | Array = 0.0) -> Array:
        """`round_off` by one perturbation, of at least `least` in each component; order -1 takes another."""
        change = self.residual(u + np.maximum(np.spacing(np.abs(u)), least) * LOOK * generic(u.size)[::order])
        change -= residual
        dscal(POINT_ULPS / LOOK, change)
        np.abs(change, out=change)
        return change if self.noise is None else np.maximum(change, self.noise)

    def measure_noise(self, u: Array, w: Array, residual: Array) -> Array:
        """Measure and keep the noise; return it, or one ulp's effect if larger, shape (N,).

        `w`: a direction of change, shape (N + 1,). `residual`: H(u).
        """
        self.noise = None
        terms = self.round_off(u, residual)
        try:
            noise = noise_along(self.residual, u, w, residual, POINT_ULPS * terms)
        except EvaluationError:
            return terms
        # Noise above the round-off of u has another source, of which `look` sees the share POINT_ULPS / LOOK.
        self.noisy(np.where(noise > POINT_ULPS * terms, noise, 0.0))
        return np.maximum(terms / POINT_ULPS, noise)

    def noisy(self, noise: Array) -> None:
        """Set the noise, shape (N,); zeros: none."""
        self.noise = noise if noise.any() else None
        if noise.size and isinstance(self._derivative, Derivative):
            self._derivative.know(noise)

    @property
    def derivative(self) -> Callable[[Array, float], tuple[Matrix, Array]]:
        """The plug-in's `jacobian`, else one made from the residual."""
        if self._derivative is None:
            u = self._given()
            start = u[:-1], float(u[-1])
            products = None if self._differential is None else given(self._differential)
            derivative = from_residual(self.called, start, self._sparsity(u.size - 1), self.counts.notes, products)
            self.methods.update(derivative.products.references)
            if self.noise is not None:
                derivative.know(self.noise)
            self._derivative = derivative
        return self._derivative

    def differential(self, u: Array) -> Callable[[Array], Array] | None:
        """The map v -> H'(u) v, or None if only a structured factorisation exists."""
        if self._differential is not None:
            apply, y, lam = self._differential, u[:-1], float(u[-1])
            return lambda v: np.asarray(apply(y, lam, v), dtype=float)
        if self._bordered is not None:
            return None
        return self._evaluated(u)[2]

    def _evaluated(self, u: Array) -> tuple[Matrix, Array, Callable[[Array], Array]]:
        """H_y, H_lam, and the map v -> H' v."""
        place = u.tobytes()
        if place in self._kept:
            return self._kept[place]
        if not silent():
            with Silence():
                return self._evaluated(u)
        self.counts.jacobians += 1
        try:
            answer = (self._derivative or self.derivative)(u[:-1], float(u[-1]))
        except (ArithmeticError, ValueError) as error:
            raise unevaluated("derivative", error) from error
        if not self._checked:
            check_derivative(answer, u.size - 1)
            self._checked = True
        while len(self._kept) >= DERIVATIVES_KEPT:
            del self._kept[next(iter(self._kept))]
        # Plug-ins may reuse their arrays.
        H_y, column = answer[0], np.array(answer[1], dtype=float)
        if isinstance(H_y, np.ndarray):
            whole = np.concatenate((H_y, column[:, None]), axis=1)
            self._kept[place] = whole[:, :-1], column, whole.dot
        else:
            self._kept[place] = H_y, column, lambda v: np.asarray(H_y @ v[:-1] + column * v[-1], dtype=float)
        return self._kept[place]

    def matrix(self, u: Array) -> Matrix:
        """H_y at u."""
        return self._evaluated(u)[0]

    def factor(self, u: Array, border: Array) -> CountedSystem:
        """Factor [[H_y, H_lam], [border']] at u, or raise EvaluationError."""
        self.counts.factorizations += 1
        # Factorisations may keep views; correctors move points in place.
        u, dense = u.copy(), False
        try:
            if self._bordered is not None:
                self.counts.jacobians += 1
                with Silence():
                    system = self._bordered(u[:-1], float(u[-1]), border)
                instance_with("bordered", system, ("solve", "sign"), "a factorisation")
            else:
                H_y, column, _ = self._evaluated(u)
                dense = isinstance(H_y, np.ndarray)
                if not (dense or finite(column)):
                    raise NotFiniteError("the derivative is not finite")
                system = factor_bordered(H_y, column, border)
        except EvaluationError:
            raise
        except ArithmeticError as error:
            if dense and not (finite(column) and finite(H_y.ravel("K"))):
                raise NotFiniteError("the derivative is not finite") from error
            raise SingularPointError(f"the bordered matrix could not be factored: {error}") from error
        return CountedSystem(system, self.counts)
