"""One attribute as a second parameter."""

from __future__ import annotations

import copy
from typing import Any

import attrs
from attrs import field, frozen

from continuation.arguments.checks import complain


@frozen(eq=False)
class Family:
    """Homotopies that differ in one attribute.

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
    TypeError, ValueError
        If the homotopy has no such number.
    """

    homotopy: Any
    name: str = field()

    @name.validator
    def _a_number_of_the_homotopy(self, attribute: Any, name: Any) -> None:
        if not isinstance(name, str):
            raise complain(TypeError, "name", "the name of an attribute", name)
        if not hasattr(self.homotopy, name):
            raise complain(ValueError, "name", f"an attribute of {type(self.homotopy).__name__}", name)
        try:
            float(getattr(self.homotopy, name))
        except (TypeError, ValueError):
            raise complain(TypeError, name, "a number to begin with", getattr(self.homotopy, name)) from None

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
