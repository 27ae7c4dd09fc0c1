"""A homotopy with one attribute as a second parameter."""

from __future__ import annotations

import copy
from typing import Any

import attrs
from attrs import field, frozen

from continuation.arguments.checks import complain


@frozen(eq=False)
class Family:
    """The homotopies that differ from a given one in one attribute.

    ``Family(homotopy, "eps")`` maps mu to the homotopy whose `eps` is mu: attrs objects are made anew, others copied
    shallowly. It can be archived. Derivatives by mu come from jets if residual and class accept them, else from
    differences.

    Parameters
    ----------
    homotopy : Homotopy
    name : str
        The attribute.

    Raises
    ------
    ValueError
        If the homotopy has no such number.
    """

    homotopy: Any
    name: str = field()

    @name.validator
    def _a_number_of_the_homotopy(self, attribute: Any, name: Any) -> None:
        try:
            float(getattr(self.homotopy, name))
        except (AttributeError, TypeError, ValueError):
            expected = f"a numerical attribute of {type(self.homotopy).__name__}"
            raise complain(ValueError, "name", expected, name) from None

    @property
    def value(self) -> float:
        """The attribute's value."""
        return float(getattr(self.homotopy, self.name))

    @property
    def parameter_name(self) -> str:
        """The attribute's name."""
        return self.name

    def __call__(self, mu: Any) -> Any:
        """The homotopy with the attribute mu.

        Parameters
        ----------
        mu : float, or a jet
        """
        if attrs.has(type(self.homotopy)):
            alias = next((a.alias for a in attrs.fields(type(self.homotopy)) if a.name == self.name), self.name)
            return attrs.evolve(self.homotopy, **{alias or self.name: mu})
        other = copy.copy(self.homotopy)
        setattr(other, self.name, mu)
        return other
