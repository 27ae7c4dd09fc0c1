"""A homotopy with a second parameter: one of its own attributes."""

from __future__ import annotations

import copy
from typing import Any

import attrs
from attrs import field, frozen

from continuation.arguments.checks import complain


@frozen(eq=False)
class Family:
    """The homotopies that differ from a given one in an attribute: a map from the value of that attribute.

    A family is anything that maps a number mu to a homotopy: a class with one argument, a function. What most people
    have is a homotopy written as a class with its constants for attributes, and then nothing at all is to be written:
    ``Family(homotopy, "eps")``. This form has a name for the axis, a value to begin with, and can be pickled and
    kept in an archive, which a lambda cannot.

    An attrs class is made anew (`attrs.evolve`), so what it derives from the attribute follows; of any other object a
    shallow copy gets the new value. If the residual is written in plain numpy, and the class takes what it is given as
    it is, derivatives by mu come from jets: mu may be one. A converter or validator that wants a float is no harm:
    differences serve then.

    Parameters
    ----------
    homotopy : Homotopy
    name : str
        The attribute.

    Raises
    ------
    TypeError, ValueError
        If the homotopy has no such attribute, or it is no number.
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
        """The attribute of the given homotopy."""
        return float(getattr(self.homotopy, self.name))

    @property
    def parameter_name(self) -> str:
        """The attribute's name."""
        return self.name

    def __call__(self, mu: Any) -> Any:
        """The homotopy whose attribute is mu.

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
