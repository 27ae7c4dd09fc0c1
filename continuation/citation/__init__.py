"""`cite`: BibTeX for a run."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any, Protocol, runtime_checkable

from continuation.arguments.checks import expect
from continuation.citation.bibliography import ALLGOWER_GEORG, GOVAERTS, MORGAN_SOMMESE_WAMPLER, SOFTWARE
from continuation.homotopy import Homotopy, SupportsReferences, offers
from continuation.status import Kind

_KEY = re.compile(r"@\w+\s*\{\s*([^,\s]+)\s*,")


@runtime_checkable
class Traced(Protocol):
    """A traced path."""

    winding_number: int | None
    events: list[Any]
    references: tuple[str, ...]


def cite(source: Any) -> str:
    """BibTeX of the library, the methods that a traced path used, and its homotopy's sources, each once.

    Parameters
    ----------
    source : Path or Homotopy
        A homotopy gives only its own references.

    Raises
    ------
    TypeError
        For anything else.
    """
    if isinstance(source, Traced):
        ends = (MORGAN_SOMMESE_WAMPLER,) if source.winding_number is not None else ()
        crossed = (GOVAERTS,) if any(event.kind == Kind.BRANCH_POINT for event in source.events) else ()
        return "\n\n".join(unique((SOFTWARE, ALLGOWER_GEORG, *ends, *crossed, *source.references)))
    if not offers(source, SupportsReferences) and not offers(source, Homotopy):
        raise TypeError(f"source: expected a path or a homotopy, found {type(source).__name__}")
    return "\n\n".join(unique((SOFTWARE, *references_of(source))))


def references_of(*parts: Any) -> tuple[str, ...]:
    """The parts' BibTeX, each key once."""
    found = [getattr(part, "references", ()) for part in parts]
    for given in found:
        expect(
            isinstance(given, (tuple, list)) and all(isinstance(entry, str) for entry in given),
            "references",
            "a tuple of BibTeX entries",
            given,
            TypeError,
        )
    return unique(tuple(entry for given in found for entry in given))


def entries(text: str) -> tuple[str, ...]:
    """Split BibTeX entries at empty lines."""
    return tuple(entry for entry in re.split(r"\n{2,}(?=@)", text.strip()) if entry)


def unique(found: tuple[str, ...]) -> tuple[str, ...]:
    """First entry of each key."""
    by_key = {key(entry): entry for entry in reversed(found)}
    return tuple(by_key[name] for name in dict.fromkeys(map(key, found)))


@lru_cache(maxsize=256)
def key(entry: str) -> str:
    """Citation key, or the entry itself."""
    found = _KEY.search(entry)
    return found.group(1) if found else entry
