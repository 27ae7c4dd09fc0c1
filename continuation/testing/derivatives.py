"""Checks of derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.point.linearization import Linearization
from continuation.predictors.taylor import series_reach
from continuation.testing.subject import Place, Subject, fail, random_directions, reporting, require

COMPARED_ORDER = 6
"""Order of compared Taylor coefficients: a wrong recurrence shows at order 2 or 3."""

SOLVE_ERROR = 1e-8
"""Largest relative residual of a bordered solve: half of the digits."""

DERIVATIVE_ERROR = 1e-6
"""Largest relative error of a derivative, coefficient or step: difference quotients satisfy it, wrong formulas do
not."""

CANCELLED_ENTRY = 1e-10
"""Error of a cancelling entry, relative to the largest."""

SURELY_REGULAR = 1e12
"""Largest condition number for a trusted determinant sign."""


@frozen(eq=False)
class JacobianAlone:
    """A homotopy with `jacobian` only."""

    start: Any
    residual: Any
    jacobian: Any


def jacobian(subject: Subject) -> None:
    """`jacobian` is the derivative (H_y, H_lam) of the residual."""
    h = subject.homotopy
    for place in subject.places:
        with reporting("jacobian", place.where):
            report = check_jacobian(JacobianAlone(h.start, h.residual, h.jacobian), place.u)
        require(report.correct, f"{report.sentence}, {place.where}")


def differential(subject: Subject) -> None:
    """`differential` is the residual's derivative along a direction."""
    for place in subject.places:
        reference = subject.derivative(place)
        for v in random_directions(place.u.size, 3, 11):
            with reporting("differential", place.where):
                found = np.asarray(subject.homotopy.differential(place.y, place.lam, v.copy()), dtype=float)
            expected = reference @ v
            said = f"differential: {place.where} expected shape {expected.shape}, found {found.shape}"
            require(found.shape == expected.shape, said)
            size = np.abs(reference)
            allowed = DERIVATIVE_ERROR * (size @ np.abs(v)) + CANCELLED_ENTRY * float(size.max())
            _compare("differential", place, "component", found, expected, allowed)


def bordered(subject: Subject) -> None:
    """`bordered` solves with [[H_y, H_lam], [border']] and gives the determinant's sign."""
    for place in subject.places:
        matrix = subject.derivative(place)
        for border in random_directions(place.u.size, 2, 13):
            whole = np.vstack([matrix, border])
            with reporting("bordered", place.where):
                system = subject.homotopy.bordered(place.y, place.lam, border.copy())
            _check_solves(place, whole, system)
            _check_sign(place, whole, system.sign)


def _check_solves(place: Place, whole: Array, system: Any) -> None:
    n = len(whole) - 1
    for b in (np.eye(n + 1)[-1], *random_directions(n + 1, 2, 17)):
        with reporting("bordered.solve", place.where):
            z = np.asarray(system.solve(b[:-1].copy(), float(b[-1])), dtype=float)
        require(z.shape == b.shape, f"bordered: {place.where} expected a solution of shape {b.shape}, found {z.shape}")
        # Relative to each equation's terms, since their sum may cancel, and to 1e-7 of the largest possible term, which
        # may be round-off.
        largest = np.abs(whole).max(axis=1) * float(np.abs(z).max())
        allowed = SOLVE_ERROR * (np.abs(whole) @ np.abs(z) + np.abs(b) + 1e-7 * largest)
        _compare("bordered", place, "the solution's equation", whole @ z, b, allowed)


def _check_sign(place: Place, whole: Array, sign: int) -> None:
    said = f"bordered: {place.where} expected a sign of -1, 0 (unknown) or 1, found {sign!r}"
    require(sign in (-1, 0, 1), said)
    if sign != 0 and np.linalg.cond(whole) < SURELY_REGULAR:
        expected, logarithm = np.linalg.slogdet(whole)
        if sign != expected:
            size = f"{expected * np.exp(logarithm):.3g}" if abs(logarithm) < 700 else f"of sign {expected:+.0f}"
            fail(f"bordered: {place.where} the sign is {int(sign):+d}, but the determinant is {size}")


def taylor(subject: Subject) -> None:
    """`taylor` gives the path's coefficients in the point's pseudo-arclength."""
    n = subject.start.u.size
    for place, point in subject.points():
        with reporting("taylor", place.where):
            c = np.asarray(subject.homotopy.taylor(point, COMPARED_ORDER), dtype=float)
        shape = (COMPARED_ORDER + 1, n)
        said = f"taylor: {place.where} expected shape {shape} at order {COMPARED_ORDER}, found {c.shape}"
        require(c.shape == shape, said)
        for k, expected in ((0, point.u), (1, point.tangent)):
            allowed = np.full(n, CANCELLED_ENTRY * float(np.abs(expected).max()))
            _compare("taylor", place, f"coefficient {k}, component", c[k], expected, allowed)
        _check_order(subject, place, point, c)


def _check_order(subject: Subject, place: Place, point: Linearization, c: Array) -> None:
    along = c @ point.border
    for k in range(2, COMPARED_ORDER + 1):
        said = f"taylor: {place.where} coefficient {k} leaves the pseudo-arclength: border . c = {along[k]:.3g}"
        require(not abs(along[k]) > DERIVATIVE_ERROR * float(np.abs(c[k]).max()) + 1e-12, said)
    h = 0.5 * min(series_reach(c, 1e-3, point.weights), 1.0 + float(np.abs(c[0]).max()))
    powers = np.arange(COMPARED_ORDER + 1)
    sizes = []
    for t in (h, 0.5 * h):
        u = (t**powers) @ c
        with reporting("residual", f"{place.where}, {t:.3g} along the series"):
            sizes.append(float(np.abs(np.asarray(subject.homotopy.residual(u[:-1], float(u[-1])))).max()))
    floor = 1e-12 * (1.0 + float(np.abs(subject.derivative(place)).max()) * (1.0 + float(np.abs(c[0]).max())))
    if sizes[1] > floor and not sizes[0] > 2.0**COMPARED_ORDER * sizes[1]:
        order = np.log2(sizes[0] / sizes[1])
        fail(f"taylor: {place.where} the residual along the series falls like h^{order:.2g}, expected "
             f"h^{COMPARED_ORDER + 1} ({sizes[0]:.3g} at h = {h:.3g})")  # fmt: skip


def _compare(method: str, place: Place, what: str, found: Array, expected: Array, allowed: Array) -> None:
    error = np.abs(found - expected)
    excess = np.where(np.isfinite(error), error / np.maximum(allowed, np.finfo(float).tiny), np.inf)
    i = int(np.argmax(excess))
    said = f"{what} {i} is {found[i]:.10g}, expected {expected[i]:.10g}, a difference of {error[i]:.3g}"
    require(not excess[i] > 1.0, f"{method}: {place.where} {said}")
