"""What holds along a curve, beside H = 0: equations in (y, lam), in mu, and perhaps in one unknown more.

Each condition gives, at a point, its values and their gradients, and a bordered factorisation with H_y in it, from which
`continuation.curves.elimination` solves for the whole. Vectors that have units are scaled by those of the start.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.curves.calculus import AGREE, Calculus
from continuation.curves.nullspace import LONG, REFRESHED, Factors, bordered, factor, null_vectors
from continuation.evaluation.derivatives import by_differences, difference_along, sizes
from continuation.events.singularity import full_derivative, row_sizes


class Base(Protocol):
    """A factorisation of [[H_y, b], [c', d]] for some border."""

    @property
    def sign(self) -> int:
        """Sign of its determinant."""
        ...

    def solve(self, r: Array, rho: float) -> Array:
        """(x, s), shape (N + 1,), of H_y x + b s = r, c'x + d s = rho.

        Parameters
        ----------
        r : ndarray, shape (N,)
        rho : float
        """
        ...


@frozen(eq=False, slots=False)
class Local:
    """A condition at a point; what a residual does not need is worked out when it is asked for.

    Attributes
    ----------
    values : ndarray, shape (k,)
    gradients : callable
        Makes `rows`.
    factored : callable
        Makes `base`.
    column : ndarray, shape (N, k - 1)
        Derivative of the equations H = 0 by the unknown beside.
    signs : mapping of str to callable
        Numbers whose signs tell degenerate points, from the rows.
    """

    values: Array
    gradients: Callable[[], Array]
    factored: Callable[[], Base]
    column: Array
    signs: Mapping[str, Callable[[Array], float]] = field(factory=dict)

    @cached_property
    def rows(self) -> Array:
        """Gradients over (y, lam), the unknown beside them if there is one, and mu: shape (k, N + 1 + k)."""
        return self.gradients()

    @cached_property
    def base(self) -> Base:
        """The factorisation."""
        return self.factored()

    def sign(self, name: str) -> float:
        """One of the signs."""
        return self.signs[name](self.rows)


class Condition(Protocol):
    """What holds along the curve: at a point (u, extra, mu)."""

    @property
    def beside(self) -> tuple[str, ...]:
        """The name of the unknown beside (y, lam), if there is one."""
        ...

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point.

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
        beside : float
        mu : float
        """
        ...


@frozen(eq=False, slots=False)
class Scaled:
    """H_y in units of the start: columns multiplied by extents, rows divided by what they are made of."""

    calculus: Calculus
    rows: Array

    @classmethod
    def at_start(cls, calculus: Calculus) -> Scaled:
        """Measured where the calculus was decided."""
        u0 = calculus.u0
        sizes = row_sizes(calculus.evaluator(float(u0[-1])), calculus.extent, (u0[:-1],))
        return cls(calculus, sizes)

    @property
    def extent(self) -> Array:
        """Of y, shape (N,)."""
        return self.calculus.extent[:-1]

    def times(self, matrix: Matrix) -> Matrix:
        """The scaled matrix."""
        if sp.issparse(matrix):
            return sp.csc_array(sp.diags_array(1.0 / self.rows) @ matrix @ sp.diags_array(self.extent))
        return matrix * self.extent / self.rows[:, None]

    def first(self, matrix: Matrix) -> tuple[Array, Array]:
        """Borders for a matrix: its null vectors, about, by inverse iteration from vectors in general position."""
        n = self.rows.size
        b, c = generic_vector(n), generic_vector(2 * n)[n:]
        for _ in range(2):
            near = null_vectors(matrix, b / np.linalg.norm(b), c / np.linalg.norm(c))
            b, c = near.left, near.right
        return b / np.linalg.norm(b), c / np.linalg.norm(c)


@frozen(eq=False)
class ScaledBase:
    """The factors of a scaled matrix, as those of the matrix."""

    factors: Factors
    scaled: Scaled

    @property
    def sign(self) -> int:
        """Sign of the determinant: scaling is by positive numbers."""
        return self.factors.sign

    def solve(self, r: Array, rho: float) -> Array:
        """(x, s), shape (N + 1,)."""
        x = self.factors.solve(np.append(r / self.scaled.rows, rho))
        x[:-1] *= self.scaled.extent
        return x


@frozen(eq=False)
class Singular:
    """H_y is singular: a fold; with `branches`, H' = [H_y, H_lam] loses a rank: a branch point.

    Folds: s = 0 in [[H_y, b], [c', 0]] (v, s) = (0, 1) (Griewank and Reddien, SIAM J. Numer. Anal. 21, 1984).

    Branch points: w'H_lam = 0 besides, and one unknown more, beta: H + beta b = 0. With it the system is regular at
    every simple branch point whose branches cross at an angle, pitchforks among them, and no symmetry has to be named.
    Where the family keeps its branch points, as symmetric ones do, beta is zero all along. (Moore, SIAM J. Numer. Anal.
    17, 1980; Govaerts, Section 8.1.)
    """

    scaled: Scaled
    b: Array
    c: Array
    branches: bool

    @property
    def beside(self) -> tuple[str, ...]:
        """The imperfection, beta."""
        return ("imperfection",) if self.branches else ()

    @classmethod
    def at_start(cls, calculus: Calculus, branches: bool) -> Singular:
        """With borders made for the start."""
        scaled = Scaled.at_start(calculus)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        b, c = scaled.first(scaled.times(full_derivative(calculus.evaluator(mu), u)[:, :-1]))
        return cls(scaled, b, c, branches)

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        scaled, calculus = self.scaled, self.scaled.calculus
        full = full_derivative(calculus.evaluator(mu), u)
        near = null_vectors(scaled.times(full[:, :-1]), self.b, self.c)
        base = ScaledBase(near.factors, scaled)
        sign = base.sign
        v, w = np.append(scaled.extent * near.right, 0.0), near.left / scaled.rows

        def gradient() -> Array:
            return -sign * calculus.second(u, mu, v, w)

        if not self.branches:
            signs = {"cusp": lambda rows: float(-sign * rows[0, :-1] @ v), "Bogdanov-Takens": lambda _: float(w @ v[:-1])}
            return Local(np.array([sign * near.s.real]), lambda: gradient()[None, :], lambda: base, np.empty((w.size, 0)), signs)
        z = base.solve(last_column(full), 0.0)

        def gradients() -> Array:
            other = calculus.second(u, mu, np.append(-z[:-1], 1.0), w)
            return np.insert(np.array([gradient(), other]), u.size, 0.0, axis=1)

        column = (scaled.rows * near.border)[:, None]
        return Local(np.array([sign * near.s.real, z[-1]]), gradients, lambda: base, column)


def last_column(full: Matrix) -> Array:
    """H_lam of [H_y, H_lam], dense."""
    column: Array = full[:, [-1]].toarray().ravel() if sp.issparse(full) else full[:, -1]
    return column


@frozen(eq=False)
class Tangential:
    """[H_y, H_lam] bordered by a row that its kernel is not orthogonal to: one of the start's, or the kernel itself."""

    calculus: Calculus
    row: Array

    @classmethod
    def at_start(cls, calculus: Calculus) -> Tangential:
        """With the kernel of the start for a row."""
        first = cls(calculus, generic_vector(calculus.u0.size - 1) / calculus.extent)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        t = first.factored(u, mu)[1] / calculus.extent
        return cls(calculus, t / float(np.linalg.norm(t)) / calculus.extent)

    def factored(self, u: Array, mu: float) -> tuple[Any, Array]:
        """The family's own factorisation, and the kernel, of length one in the extents of the start, oriented."""
        extent, row = self.calculus.extent, self.row
        evaluator = self.calculus.evaluator(mu)
        for _ in range(REFRESHED):
            system = evaluator.factor(u, row)
            t = system.solve(np.zeros(u.size - 1), 1.0)
            size = float(np.linalg.norm(t / extent))
            if size * float(np.linalg.norm(row * extent)) <= LONG:
                break
            row = t / extent**2 / size
        return system, t / size * (system.sign or 1)


@frozen(eq=False)
class HopfPoint:
    """i omega is an eigenvalue of H_y; omega is an unknown.

    s = 0 in [[H_y - i omega I, b], [c*, 0]] (v, s) = (0, 1): two equations, the real and the imaginary part (Griewank and
    Reddien, IMA J. Numer. Anal. 3, 1983). No square of H_y is formed, so it stays sparse.
    """

    scaled: Scaled
    b: Array
    c: Array
    tangential: Tangential

    @property
    def beside(self) -> tuple[str, ...]:
        """The frequency, omega."""
        return ("frequency",)

    @classmethod
    def at_start(cls, calculus: Calculus, frequency: float) -> HopfPoint:
        """With borders made for the start."""
        scaled, empty = Scaled.at_start(calculus), np.empty(0)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        found = cls(scaled, empty, empty, Tangential.at_start(calculus))
        b, c = scaled.first(found._matrix(u, frequency, mu))
        return cls(scaled, b, c, found.tangential)

    def _matrix(self, u: Array, omega: float, mu: float) -> Matrix:
        full = full_derivative(self.scaled.calculus.evaluator(mu), u)[:, :-1]
        eye = sp.eye_array(u.size - 1) if sp.issparse(full) else np.eye(u.size - 1)
        return self.scaled.times(full - 1j * omega * eye)

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        scaled, calculus = self.scaled, self.scaled.calculus
        near = null_vectors(self._matrix(u, beside, mu), self.b, self.c)
        v, w = scaled.extent * near.right, near.left.conj() / scaled.rows

        def gradients() -> Array:
            real, imaginary = (calculus.second(u, mu, np.append(part, 0.0), w) for part in (v.real, v.imag))
            row = np.insert(-(real + 1j * imaginary), u.size, 1j * (w @ v))
            return np.array([row.real, row.imag])

        values = np.array([near.s.real, near.s.imag])
        return Local(values, gradients, lambda: self.tangential.factored(u, mu)[0], np.zeros((w.size, 1)))


@frozen(eq=False)
class Vanishing:
    """A function of (y, lam), and of mu, vanishes: a target value, a switch, a monitor of the caller's.

    Attributes
    ----------
    function : callable
        Of (y, lam, mu) as one vector, or jet.
    gradient : callable
        Of the vector.
    """

    tangential: Tangential
    function: Callable[[Any], Any]
    gradient: Callable[[Array], Array]

    @property
    def beside(self) -> tuple[str, ...]:
        """No unknown beside."""
        return ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any]) -> Vanishing:
        """With a gradient that is right at the start."""
        return cls(Tangential.at_start(calculus), function, gradient_of(function, calculus.u0))

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        U = np.append(u, mu)
        values, empty = np.array([float(self.function(U))]), np.empty((u.size - 1, 0))
        return Local(values, lambda: self.gradient(U)[None, :], lambda: self.tangential.factored(u, mu)[0], empty)


@frozen(eq=False)
class AlongTangent:
    """A function of (y, lam) and of the tangent there vanishes: where an unknown turns, say.

    The tangent's derivative comes from M dt = -H''[t, .], M = [H_y, H_lam] with a border, by one solve with M'.

    Attributes
    ----------
    function : callable
        Of u and v as one vector.
    gradient : callable
        Of the vector.
    """

    scaled: Scaled
    tangential: Tangential
    function: Callable[[Array], float]
    gradient: Callable[[Array], Array]

    @property
    def beside(self) -> tuple[str, ...]:
        """No unknown beside."""
        return ()

    @classmethod
    def at_start(cls, calculus: Calculus, function: Callable[[Any], Any]) -> AlongTangent:
        """With a gradient that is right at the start."""
        tangential, u, mu = Tangential.at_start(calculus), calculus.u0[:-1], float(calculus.u0[-1])
        gradient = gradient_of(function, np.append(u, tangential.factored(u, mu)[1]))
        return cls(Scaled.at_start(calculus), tangential, function, gradient)

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        calculus, extent, rows = self.scaled.calculus, self.scaled.calculus.extent, self.scaled.rows
        system, t = self.tangential.factored(u, mu)

        def gradients() -> Array:
            by_u, by_t = np.split(self.gradient(np.append(u, t)), 2)
            full, border = full_derivative(calculus.evaluator(mu), u), t / extent
            H_lam = extent[-1] * last_column(full) / rows
            M = bordered(self.scaled.times(full[:, :-1]), H_lam, border[:-1], float(border[-1]))
            across = extent * by_t - float(by_t @ t) * border
            left = factor(M).solve(across, adjoint=True)[:-1] / rows
            return np.asarray(np.append(by_u, 0.0) - calculus.second(u, mu, t, left))[None, :]

        values = np.array([self.function(np.append(u, t))])
        return Local(values, gradients, lambda: system, np.empty((rows.size, 0)))


def gradient_of(function: Callable[[Any], Any], x0: Array) -> Callable[[Array], Array]:
    """The gradient of a function of a vector: by jets where they agree with a difference at x0, else by differences."""
    w = sizes(x0) * generic_vector(x0.size)

    def at(x: Array, last: float) -> Array:
        return np.array([function(np.append(x, last))], dtype=float)

    try:
        from continuation import jets

        found, wanted = jets.jacobian(function, x0), difference_along(at, x0, w)[0]
        if found.shape == x0.shape and abs(found @ w - wanted[0]) <= AGREE * float(np.abs(found) @ np.abs(w)):
            return lambda x: jets.jacobian(function, x)
    except (TypeError, ArithmeticError, ValueError, AttributeError):
        pass
    plain = by_differences(at, x0)
    return lambda x: np.hstack(plain(x[:-1], float(x[-1]))).ravel()
