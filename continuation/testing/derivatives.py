"""Checks of derivatives to six digits, which difference quotients have and wrong formulas have not."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.predictors.taylor import series_reach
from continuation.testing.subject import Subject, compare, random_directions, reporting, require

COMPARED_ORDER = 6
"""Order of compared Taylor coefficients; a wrong recurrence shows at order 2 or 3."""

CANCELLED_ENTRY = 1e-10
"""Error of a cancelling entry, relative to the largest."""

SURELY_REGULAR = 1e12
"""Largest condition number for a trusted determinant sign."""


def jacobian(subject: Subject) -> None:
    """`jacobian` is the derivative (H_y, H_lam) of the residual."""
    h = subject.homotopy
    for place in subject.places:
        with reporting("jacobian", place.where):
            report = check_jacobian(SimpleNamespace(start=h.start, residual=h.residual, jacobian=h.jacobian), place.u)
        require(report.correct, f"{report.sentence}, {place.where}")


def differential(subject: Subject) -> None:
    """`differential` is the residual's derivative along a direction."""
    for place in subject.places:
        reference = subject.derivative(place)
        for v in random_directions(place.u.size, 3, 11):
            with reporting("differential", place.where):
                found = subject.homotopy.differential(place.y, place.lam, v.copy())
            size = np.abs(reference)
            allowed = SIX_DIGITS * (size @ np.abs(v)) + CANCELLED_ENTRY * float(size.max())
            compare("differential", place, "component", found, reference @ v, allowed)


def bordered(subject: Subject) -> None:
    """`bordered` solves with [[H_y, H_lam], [border']] and gives the determinant's sign."""
    for place in subject.places:
        n = place.u.size
        for border, b in zip(random_directions(n, 2, 13), random_directions(n, 2, 17)):
            whole = np.vstack([subject.derivative(place), border])
            with reporting("bordered", place.where):
                system = subject.homotopy.bordered(place.y, place.lam, border.copy())
                z = np.asarray(system.solve(b[:-1].copy(), float(b[-1])), dtype=float)
            # Relative to an equation's terms, which may cancel, and to 1e-7 of the largest possible one (round-off).
            largest = np.abs(whole).max(axis=1) * float(np.abs(z).max())
            allowed = ROOT_OF_ROUND_OFF * (np.abs(whole) @ np.abs(z) + np.abs(b) + 1e-7 * largest)
            compare("bordered", place, "the solution's equation", whole @ z, b, allowed)
            expected, trusted = np.linalg.slogdet(whole)[0], np.linalg.cond(whole) < SURELY_REGULAR
            said = f"bordered: {place.where} expected the determinant's sign {expected:+.0f} or 0 (unknown)"
            require(system.sign in (0, expected) or not trusted, f"{said}, found {system.sign}")


def taylor(subject: Subject) -> None:
    """`taylor` gives the path's coefficients in the point's pseudo-arclength."""
    for place, point in subject.points():
        with reporting("taylor", place.where):
            c = np.asarray(subject.homotopy.taylor(point, COMPARED_ORDER), dtype=float)
        compare("taylor", place, f"shape at order {COMPARED_ORDER}", c.shape, (COMPARED_ORDER + 1, point.u.size))
        for k, expected in ((0, point.u), (1, point.tangent)):
            allowed = CANCELLED_ENTRY * float(np.abs(expected).max())
            compare("taylor", place, f"coefficient {k}, component", c[k], expected, allowed)
        h = 0.5 * min(series_reach(c, 1e-3, point.weights), 1.0 + float(np.abs(c[0]).max()))
        powers = np.arange(COMPARED_ORDER + 1)
        with reporting("residual", f"{place.where}, {h:.3g} along the series"):
            far, near = (subject.evaluator.residual_norm((t**powers) @ c) for t in (h, 0.5 * h))
        floor = 1e-12 * (1.0 + float(np.abs(subject.derivative(place)).max()) * (1.0 + float(np.abs(c[0]).max())))
        order = np.log2(max(far, floor) / max(near, floor))
        said = f"taylor: {place.where} the residual along the series falls like h^{order:.2g}"
        require(near <= floor or far > 2.0**COMPARED_ORDER * near, f"{said}, expected h^{COMPARED_ORDER + 1}")
