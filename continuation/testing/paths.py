"""Checks of whole paths."""

from __future__ import annotations

import json
import math
import re
import sys
import tempfile
from itertools import zip_longest
from operator import attrgetter
from pathlib import Path as File
from typing import Any

import numpy as np

from continuation.archive import resume
from continuation.archive.codec import problem_data
from continuation.archive.writer import PathLog
from continuation.arrays import SIX_DIGITS, Array
from continuation.auditing import audit
from continuation.budget import Budget
from continuation.status import Status
from continuation.testing.subject import Subject, TestedPoint, compare, random_directions, reporting, require


def max_step(subject: Subject) -> None:
    """`max_step` is positive; after a share of the way to the boundary it gives the rest."""

    def longest(place: TestedPoint, u: Array, v: Array) -> float:
        with reporting("max_step", place.where):
            found = float(subject.homotopy.max_step(u.copy(), v.copy()))
        said = f"max_step: {place.where} it is {found:g}, expected a positive number: the point is inside the domain"
        require(found > 0.0, said)
        return found

    for place in subject.places:
        # Relative, since interior points span orders of magnitude.
        size = np.where(place.u == 0.0, 1.0, np.abs(place.u))
        for v in size * np.array(random_directions(place.u.size, 4, 19)):
            whole = longest(place, place.u, v)
            if math.isinf(whole):
                continue
            for share, factor in ((0.0, 2.0), (0.5, 1.0), (0.999, 1.0)):
                rest = (1.0 - share) / factor * whole
                left = longest(place, place.u + share * whole * v, factor * v)
                said = f"after {share:g} of {whole:.6g} along v what is left along {factor:g} v, number"
                compare("max_step", place, said, [left], [rest], SIX_DIGITS * whole)


def audited(name: str, backwards: bool, subject: Subject) -> None:
    """A retrace, with half steps or backwards, gives the same path."""
    if len(subject.regular) >= 2:
        with reporting(name, "along the path"):
            report = audit(subject.homotopy, subject.regular, backwards=backwards)
        require(report.same, f"{name}: {report.sentence}")


def resumed(subject: Subject) -> None:
    """A path resumed half-way equals, bit for bit, the uninterrupted one; an archive makes the homotopy if it can."""
    text, _ = problem_data(subject.homotopy)
    # Encoding has just loaded these modules.
    named = re.findall(r'"(?:class|function)": "([\w.]+):([\w.]+)"', text)
    trusted = [attrgetter(name)(sys.modules[module]) for module, name in named]
    given = subject.homotopy if "unstorable" in json.loads(text) else None
    whole = subject.path
    half = (len(whole) - 1) // 2
    if half < 1:
        return
    with tempfile.TemporaryDirectory() as folder, reporting("resume", "from the middle of the path"):
        file = File(folder) / "half.h5"
        first = subject.traced(observers=(PathLog(file),), budget=Budget(steps=half))
        ended = f"resume: the first {half} steps ended as {first.status.name}, those of the whole path did not"
        require(first.status is Status.BUDGET_EXHAUSTED, ended)
        again = resume(file, given, trust=trusted, budget=subject.limits)
    for part in ("steps", "events"):
        for a, b in zip_longest(getattr(whole, part), getattr(again, part)):
            require(_bits(a) == _bits(b), f"resume: expected {a!r}, found {b!r} or other observed numbers")


def _bits(point: Any) -> Any:
    # Archives order scalars differently.
    return point and (point.u.tobytes(), getattr(point, "name", ""), repr(sorted(point.observed.items())))
