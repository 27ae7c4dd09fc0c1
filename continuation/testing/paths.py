"""Checks of whole paths."""

from __future__ import annotations

import json
import math
import re
import sys
import tempfile
from operator import attrgetter
from pathlib import Path as File
from typing import Any

import numpy as np

from continuation.archive import ArchiveError, resume
from continuation.archive.codec import problem_data
from continuation.archive.trust import UnknownError, decode, registry
from continuation.archive.writer import PathLog
from continuation.arrays import Array
from continuation.auditing import audit
from continuation.budget import Budget
from continuation.path import Path
from continuation.status import Status
from continuation.testing.derivatives import DERIVATIVE_ERROR
from continuation.testing.protocol import same_residual
from continuation.testing.subject import Place, Subject, fail, random_directions, reporting, require


def max_step(subject: Subject) -> None:
    """After a share of the way to the boundary, `max_step` gives the rest."""
    for place in subject.places:
        # Relative, since interior points span orders of magnitude.
        size = np.where(place.u == 0.0, 1.0, np.abs(place.u))
        for v in size * np.array(random_directions(place.u.size, 4, 19)):
            whole = _longest(subject, place.where, place.u, v)
            for share, factor in () if math.isinf(whole) else ((0.0, 2.0), (0.5, 1.0), (0.999, 1.0)):
                rest = (1.0 - share) / factor * whole
                left = _longest(subject, place.where, place.u + share * whole * v, factor * v)
                if abs(left - rest) > DERIVATIVE_ERROR * whole:
                    fail(f"max_step: {place.where} it is {whole:.6g} along v; after {share:g} of that {rest:.6g} along "
                         f"{factor:g} v should be left, found {left:.6g}")  # fmt: skip
            inside = not math.isfinite(whole) or subject.finite(Place("", place.u + 0.999 * whole * v))
            said = f"max_step: {place.where} it is {whole:.6g}, but the residual is not finite at 0.999 of that"
            require(inside, said)
        with reporting("max_step", place.where):
            still = float(subject.homotopy.max_step(place.u.copy(), np.zeros_like(place.u)))
        said = f"max_step: {place.where} it is {still:g} along v = 0, expected inf: staying is always admissible"
        require(still > 1.0, said)


def _longest(subject: Subject, where: str, u: Array, v: Array) -> float:
    with reporting("max_step", where):
        longest = float(subject.homotopy.max_step(u.copy(), v.copy()))
    said = f"max_step: {where} it is {longest:g}, expected a positive number: the point is inside the domain"
    require(longest > 0.0, said)
    return longest


def audited(name: str, backwards: bool, subject: Subject) -> None:
    """A retrace, with half steps or backwards, gives the same path."""
    if len(subject.regular) < 2:
        return
    with reporting(name, "along the path"):
        report = audit(subject.homotopy, subject.regular, backwards=backwards)
    require(report.same, f"{name}: {report.sentence}")


def archive(subject: Subject) -> None:
    """The homotopy survives an archive that can hold it."""
    text, arrays = problem_data(subject.homotopy)
    tree = json.loads(text)
    if "unstorable" in tree:
        # The owner passes it to `resume`.
        return
    # Encoding has just loaded these modules.
    named = re.findall(r'"(?:class|function)": "([\w.]+):([\w.]+)"', text)
    trusted = registry([attrgetter(name)(sys.modules[module]) for module, name in named])
    try:
        homotopy: Any = decode(tree, arrays.__getitem__, trusted)
    except UnknownError as error:
        fail(f"archive: the homotopy was stored and cannot be made again: {error}")
    same_residual(subject, homotopy, "archive", "the homotopy read back")


def resumed(subject: Subject) -> None:
    """A path resumed half-way equals, bit for bit, the uninterrupted path."""
    with reporting("resume", "while the whole path is traced"):
        whole = subject.traced()
    half = (len(whole) - 1) // 2
    if half < 1:
        return
    with tempfile.TemporaryDirectory() as folder:
        file = File(folder) / "half.h5"
        with reporting("resume", "while the first half is traced"):
            first = subject.traced(observers=(PathLog(file),), budget=Budget(steps=half))
            if first.status is not Status.BUDGET_EXHAUSTED:
                fail(f"resume: the first {half} steps ended as {first.status.name}, those of the whole path did not")
            try:
                again = resume(file, subject.homotopy, budget=subject.limits)
            except (ArchiveError, ValueError) as error:
                fail(f"resume: {error}")
    _same_path("resume", whole, again)


def _same_path(name: str, wanted: Path, found: Path) -> None:
    both: list[tuple[list[Any], list[Any]]] = [(wanted.steps, found.steps), (wanted.events, found.events)]
    for p, q in both:
        sizes = f"{len(wanted)} points and {len(wanted.events)} events, found {len(found)} and {len(found.events)}"
        require(len(p) == len(q), f"{name}: expected {sizes}")
        for a, b in zip(p, q):
            if not np.array_equal(a.u, b.u):
                fail(f"{name}: expected {a!r}, found {b!r}, which differs by {float(np.abs(a.u - b.u).max()):.3g}")
            # Archives order scalars differently.
            scalars = list(a.observed.values()), [b.observed.get(key, math.inf) for key in a.observed]
            if len(a.observed) != len(b.observed) or not np.array_equal(*scalars, equal_nan=True):
                fail(f"{name}: {a!r} observed {dict(a.observed)}, found {dict(b.observed)}")
    named = [[event.name for event in path.events] for path in (wanted, found)]
    require(named[0] == named[1], f"{name}: expected the events {wanted.events}, found {found.events}")
