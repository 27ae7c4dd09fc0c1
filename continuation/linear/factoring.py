"""One door to sparse factorisations: SuperLU, and what else is installed, chosen by a look at the matrix."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Protocol

from attrs import define, field

from continuation.arrays import Matrix
from continuation.linear.cholmod import CholmodMethod
from continuation.linear.look import Look
from continuation.linear.multigrid import MultigridMethod
from continuation.linear.superlu import SparseFactor, SuperLUMethod


class SparseMethod(Protocol):
    """A way to factor sparse matrices."""

    @property
    def name(self) -> str:
        """By which it is asked for."""
        ...

    @property
    def needs(self) -> str:
        """The package that has to be installed."""
        ...

    @property
    def signed(self) -> bool:
        """Whether its factors tell the sign of the determinant."""
        ...

    @property
    def least(self) -> float:
        """The order from which on it is chosen by itself."""
        ...

    def suits(self, look: Look) -> bool:
        """Whether it may do for a matrix."""
        ...

    def factor(self, look: Look) -> SparseFactor | None:
        """The factors; None where it cannot do it after all."""
        ...


EXTRAS: tuple[SparseMethod, ...] = (MultigridMethod(), CholmodMethod())
"""What may be installed besides, in the order in which it is chosen."""

METHODS = ("auto", SuperLUMethod.name, *(one.name for one in EXTRAS))
"""What may be asked for."""


def check_method(argument: str, name: object) -> str:
    """The name of a method, or "auto".

    `argument`: What an error calls it. Raises `ValueError` if there is no such method. Raises `ImportError` if its
    package is not installed.
    """
    if not isinstance(name, str) or name not in METHODS:
        found = repr(name) if isinstance(name, str) else type(name).__name__
        raise ValueError(f"{argument}: expected one of {', '.join(METHODS)}, found {found}")
    for one in EXTRAS:
        if one.name == name and not installed(one):
            raise ImportError(f"{argument}={name!r} needs {one.needs}: pip install 'pseudoarclength[{name}]'")
    return name


def installed(method: SparseMethod) -> bool:
    """Whether the package of a method is there; it is not imported."""
    return find_spec(method.needs) is not None


def negated(factor: SparseFactor, n: int) -> SparseFactor:
    """Factors of -A, of order n, as those of A; det A = (-1)^n det(-A)."""
    solve, sign = factor.solve, factor.tell_sign
    return SparseFactor(factor.name, lambda rhs: -solve(rhs), factor.fill, lambda: -sign() if n % 2 else sign())


@define(eq=False)
class Factoring:
    """Factors sparse matrices, and keeps account of what did it.

    Attributes
    ----------
    method : str
        "auto", or the name of what is tried first.
    direct : SuperLUMethod
        What is left where nothing else suits.
    signed : bool
        Whether the sign of the determinant is needed.
    extras : tuple of SparseMethod
        In the order in which they are chosen.
    used : dict
        By name, how many matrices were factored, and the largest fill.
    """

    method: str = "auto"
    direct: SuperLUMethod = field(factory=SuperLUMethod)
    signed: bool = False
    extras: tuple[SparseMethod, ...] = EXTRAS
    used: dict[str, tuple[int, int]] = field(factory=dict, init=False)

    def factor(self, matrix: Matrix) -> SparseFactor | None:
        """Factors of a square matrix by itself; None where it is singular.

        What a method turns out to be unfit for is left to the next one.

        Parameters
        ----------
        matrix : csc_array of shape (N, N)
            In canonical format.
        """
        look = Look(matrix)
        factor = self._by_extras(look) or self.direct.factor(look)
        if factor is not None:
            count, fill = self.used.get(factor.name, (0, 0))
            self.used[factor.name] = count + 1, max(fill, factor.fill)
        return factor

    def _by_extras(self, look: Look) -> SparseFactor | None:
        asked = [one for one in self.extras if self._asked(one, look.n)]
        # A discretised Laplacian is negative definite.
        negative = bool(asked) and bool((look.diagonal < 0.0).all())
        positive = Look(-look.matrix) if negative else look
        for one in asked:
            factor = one.factor(positive) if one.suits(positive) else None
            if factor is not None:
                return negated(factor, look.n) if negative else factor
        return None

    def _asked(self, one: SparseMethod, n: int) -> bool:
        if self.signed and not one.signed:
            return False
        return one.name == self.method if self.method != "auto" else n >= one.least and installed(one)

    def __str__(self) -> str:
        parts = []
        for name, (count, fill) in self.used.items():
            held = f", at most {fill:.2g} numbers" if fill else ""
            parts.append(f"{count} by {name}{held}")
        return f"Sparse factorisations: {'; '.join(parts)}." if parts else ""
