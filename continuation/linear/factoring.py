"""One door to sparse factorisations: SuperLU, and what else is installed, chosen by a look at the matrix."""

from __future__ import annotations

from importlib.util import find_spec

from attrs import define, evolve, field

from continuation.arrays import Matrix
from continuation.linear.extras import EXTRAS, Extra
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor, SuperLUMethod

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


def installed(method: Extra) -> bool:
    """Whether the package of a method is there; it is not imported."""
    return find_spec(method.needs) is not None


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
    extras : tuple of Extra
        In the order in which they are chosen.
    used : dict
        By name, how many matrices were factored, and the largest fill.
    """

    method: str = "auto"
    direct: SuperLUMethod = field(factory=SuperLUMethod)
    signed: bool = False
    extras: tuple[Extra, ...] = EXTRAS
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
        # A discretised Laplacian is negative definite; det A = (-1)^n det(-A).
        negative = bool(asked) and bool((look.diagonal < 0.0).all())
        look = Look(-look.matrix) if negative else look
        factors = (one.factor(look) for one in asked if one.suits(look))
        factor = next((factor for factor in factors if factor is not None), None)
        if factor is None or not negative:
            return factor
        solve, sign, way = factor.solve, factor.tell_sign, -1 if look.n % 2 else 1
        return evolve(factor, solve=lambda rhs: -solve(rhs), tell_sign=lambda: way * sign())

    def _asked(self, one: Extra, n: int) -> bool:
        if self.signed and not one.signed:
            return False
        return one.name == self.method if self.method != "auto" else n >= one.least and installed(one)

    def __str__(self) -> str:
        parts = []
        for name, (count, fill) in self.used.items():
            held = f", at most {fill:.2g} numbers" if fill else ""
            parts.append(f"{count} by {name}{held}")
        return f"Sparse factorisations: {'; '.join(parts)}." if parts else ""
