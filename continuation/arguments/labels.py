"""Names and units of parameter and unknowns."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from attrs import field, frozen

from continuation.arguments.checks import expect

ATTRIBUTES = ("parameter_name", "names", "units")
_LONGEST = 100
"""Longest name from a file: 100 characters of TeX hold 14 nested roots; 30 roots exhaust matplotlib's stack."""


@frozen
class Labels:
    """Names of unknowns, and units by name, also of parameter and observed scalars."""

    parameter_name: str = ""
    names: tuple[str, ...] = ()
    units: Mapping[str, str] = field(factory=dict)

    @classmethod
    def of(cls, homotopy: Any) -> Labels:
        """The homotopy's labels; `TypeError` for a wrong type."""
        name, names, units = (getattr(homotopy, attribute, None) for attribute in ATTRIBUTES)
        expect(isinstance(name, str | None), "parameter_name", "a text", name, TypeError)
        listed = not isinstance(names, str) and _are_texts(names, Sequence)
        expect(listed, "names", "a list of texts, one an unknown", names, TypeError)
        mapped = _are_texts(units, Mapping) and _are_texts([*(units or {}).values()], Sequence)
        expect(mapped, "units", "texts by the names of what they belong to", units, TypeError)
        return cls(name or "", tuple(names or ()), dict(units or {}))

    def attributes(self) -> dict[str, str]:
        """Texts for an archive."""
        texts = (self.parameter_name, json.dumps(self.names), json.dumps(dict(self.units)))
        return {name: text for name, text in zip(ATTRIBUTES, texts) if text not in ("", "[]", "{}")}

    @classmethod
    def from_attributes(cls, attributes: Mapping[str, Any]) -> Labels:
        """Labels from an archive; none if one is invalid."""
        try:
            texts = {name: str(attributes[name]) for name in ATTRIBUTES if attributes.get(name)}
            name = texts.pop(ATTRIBUTES[0], "")
            said = cls.of(SimpleNamespace(parameter_name=name, **{key: json.loads(texts[key]) for key in texts}))
        except (TypeError, ValueError, RecursionError):
            return cls()
        shown = (said.parameter_name, *said.names, *said.units, *said.units.values())
        return said if max(map(len, shown)) <= _LONGEST else cls()

    def parameter(self, symbol: str = "lam") -> str:
        """The parameter's label."""
        return self.with_unit(self.parameter_name) if self.parameter_name else symbol

    def unknown(self, i: int) -> str:
        """An unknown's name, or empty."""
        return self.names[i] if i < len(self.names) else ""

    def with_unit(self, name: str) -> str:
        """A name, with its unit in brackets if known."""
        return f"{name} [{self.units[name]}]" if name in self.units else name

    def index(self, name: str) -> int:
        """Number of an unknown, -1 for the parameter."""
        if name in ("lam", self.parameter_name):
            return -1
        known = ", ".join(filter(None, ("lam", self.parameter_name, *self.names)))
        expect(name in self.names, "name", f"one of {known}", name)
        return self.names.index(name)


def _are_texts(given: Any, kind: Any) -> bool:
    return given is None or (isinstance(given, kind) and all(isinstance(one, str) for one in given))
