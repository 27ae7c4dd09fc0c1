"""The linear complementarity problem: its data, validated, and the error measure used everywhere."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arrays import Array, Matrix
from problems.options import finite_vector, real_array, sound_sparse


def _q(value: Any) -> Array:
    nothing = np.ndim(value) == 1 and np.size(value) == 0
    return np.zeros(0) if nothing else finite_vector("q", value)


def _matrix(value: Any) -> Matrix:
    """A finite square float matrix, dense or CSR."""
    if sp.issparse(value):
        matrix = sound_sparse("A", value)
        entries: Array = matrix.data
    else:
        matrix = entries = real_array("A", value)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError(f"A: expected a square matrix, found shape {matrix.shape}")
    if not np.isfinite(entries).all():
        raise ValueError(f"A: expected finite numbers, found {entries[~np.isfinite(entries)].flat[0]}")
    return matrix


@frozen(eq=False)
class LCP:
    """LCP(q, A): find x with x >= 0, w = A x + q >= 0 and x_i w_i = 0 for all i.

    Parameters
    ----------
    A : array_like or scipy sparse, shape (n, n)
        Any real matrix. Integers and float32 are converted; sparse input stays sparse (CSR).
    q : array_like, shape (n,)
        n may be 0, as where nothing touches in a time step: such a problem is solved.

    Raises
    ------
    ValueError
        If an argument is not numeric, not finite, not square, or of a shape that disagrees.

    References
    ----------
    Cottle, Pang and Stone, The Linear Complementarity Problem, 1992.
    """

    A: Matrix = field(converter=_matrix)
    q: Array = field(converter=_q)
    known: dict[str, Any] = field(factory=dict, init=False, repr=False)
    """What was found out about A and is asked for again, by name (`data.scaling.units`)."""

    @q.validator
    def _same_order(self, attribute: object, q: Array) -> None:
        if q.size != self.A.shape[0]:
            raise ValueError(f"q: expected {self.A.shape[0]} numbers, one a row of A, found {q.size}")

    @property
    def n(self) -> int:
        """The order of A."""
        return int(self.q.size)

    @property
    def sparse(self) -> bool:
        """Whether A is stored as a sparse array."""
        return bool(sp.issparse(self.A))

    def w(self, x: Array) -> Array:
        """A x + q, shape (n,).

        Parameters
        ----------
        x : ndarray, shape (n,)

        Returns
        -------
        ndarray, shape (n,)
        """
        product: Array = self.A @ x + self.q
        return product

    def natural_residual(self, x: Array) -> float:
        """max_i |min(x_i, w_i)|, absolute.

        Parameters
        ----------
        x : ndarray, shape (n,)

        Returns
        -------
        float
        """
        return float(np.abs(np.minimum(x, self.w(x))).max(initial=0.0))

    def scale(self, x: Array) -> float:
        """1 + max(|q|_inf, |A|_inf |x|_inf), by which the natural residual is made relative.

        Parameters
        ----------
        x : ndarray, shape (n,)

        Returns
        -------
        float
        """
        return 1.0 + max(float(np.abs(self.q).max(initial=0.0)), self._norm * float(np.abs(x).max(initial=0.0)))

    @cached_property
    def _norm(self) -> float:
        """|A|_inf: asked for with every point that is judged."""
        return float(np.max(abs(self.A).sum(axis=1), initial=0.0))

    def with_q(self, q: Any) -> LCP:
        """LCP(q, A) for another q; what is known of A is not found out again.

        Its rows keep their units, which another q may move by a factor for each part of A that hangs together.

        Parameters
        ----------
        q : array_like, shape (n,)
        """
        other = LCP(self.A, q)
        other.known.update(self.known)
        return other

    def relative_residual(self, x: Array) -> float:
        """The natural residual divided by `scale`.

        Parameters
        ----------
        x : ndarray, shape (n,)

        Returns
        -------
        float
        """
        return self.natural_residual(x) / self.scale(x)


def require_lcp(problem: Any) -> None:
    """Raise TypeError unless the argument `problem` is an LCP."""
    if not isinstance(problem, LCP):
        raise TypeError(f"problem: expected an LCP, found {type(problem).__name__}")
