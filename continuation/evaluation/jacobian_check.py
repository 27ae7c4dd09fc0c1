"""Checks of derivatives against residuals."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arguments.checks import real_vector
from continuation.arrays import SIX_DIGITS, Array
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.products import Residual, difference_along, exact

Product = Callable[[Array], Array]


@frozen
class JacobianReport:
    """Result of the check.

    Attributes
    ----------
    correct : bool
    sentence : str
        The result in words.
    source : str
        Reference: jets, complex step or differences.
    row, column : int or None
        The wrong entry; column N is the parameter's.
    found, expected : float or None
        Given value, and the residual's.
    """

    correct: bool
    sentence: str
    source: str
    row: int | None = None
    column: int | None = None
    found: float | None = None
    expected: float | None = None

    def __str__(self) -> str:
        return self.sentence


def check_jacobian(homotopy: Any, u: Array | None = None) -> JacobianReport:
    """Compare a homotopy's derivative with its residual.

    Products with random directions cost a few residuals; bisection finds a wrong entry with 2 log2(N) more.

    Parameters
    ----------
    homotopy : Homotopy
        With `jacobian`, or `bordered` and `differential`.
    u : ndarray, shape (N + 1,), optional
        Default: the start and a point near it, as zeros can hide mistakes.

    Raises
    ------
    TypeError
        Without a derivative.
    ValueError
        If `u` has the wrong shape, or the residual is not finite.
    """
    evaluator = Evaluator(homotopy, Counts())
    if not any(callable(getattr(homotopy, name, None)) for name in ("jacobian", "differential")):
        raise TypeError(f"homotopy: expected a method `jacobian` to check, found none on {type(homotopy).__name__}")
    start = evaluator.start()
    if u is not None:
        u = real_vector("u", u)
        if u.shape != start.shape:
            raise ValueError(f"u: expected shape {start.shape}, found {u.shape}")
        return _check(evaluator, u)
    beside = start + 1e-2 * (1.0 + np.abs(start)) * np.random.default_rng(4).uniform(0.5, 1.0, start.size)
    report = _check(evaluator, start)
    if not report.correct:
        return report
    try:
        return _check(evaluator, beside)
    except ValueError:
        # At the edge of the domain.
        return report


def _check(evaluator: Evaluator, u: Array) -> JacobianReport:
    try:
        evaluator.residual(u)
    except EvaluationError as error:
        raise ValueError(f"u: at lam = {u[-1]:g} {error}") from error
    given = evaluator.differential(u)
    assert given is not None
    generator = np.random.default_rng(5)
    probes = [generator.choice((-1.0, 1.0), u.size) * generator.uniform(0.5, 1.0, u.size) for _ in range(3)]
    source, expected = _reference(evaluator.called, u, probes[0])
    pairs = [(given(w), expected(w)) for w in probes]
    size = np.max([np.fmax(np.abs(p), np.abs(q)) for p, q in pairs], axis=0)
    # Differences have about ten digits. A zero row is measured by the others.
    allowed = SIX_DIGITS * size + 1e-10 * float(size.max())
    for w, (p, q) in zip(probes, pairs):
        excess = np.where(np.isfinite(p), np.abs(p - q), np.inf) / np.maximum(allowed, np.finfo(float).tiny)
        if excess.max() > 1.0:
            return _located(given, expected, w, int(np.argmax(excess)), source, float(u[-1]))
    sentence = f"The derivative agrees with the residual (by {source}) at lam = {u[-1]:g}."
    return JacobianReport(True, sentence, source)


def _reference(residual: Residual, u: Array, probe: Array) -> tuple[str, Product]:
    """Best product that agrees with differences."""
    products = exact(residual, u, probe)
    if products is None:
        return "differences", lambda w: difference_along(residual, u, w)[0]
    return products.name, lambda w: products(residual, u, w[None])[:, 0]


def _located(given: Product, expected: Product, w: Array, row: int, source: str, lam: float) -> JacobianReport:

    def error(columns: NDArray[np.intp]) -> float:
        part = np.zeros_like(w)
        part[columns] = w[columns]
        return abs(float(given(part)[row] - expected(part)[row]))

    if not np.isfinite(given(w)[row]):
        sentence = f"jacobian: at lam = {lam:g} row {row} is not finite"
        return JacobianReport(False, sentence, source, row)
    columns = np.arange(w.size)
    while columns.size > 1:
        halves = np.array_split(columns, 2)
        columns = halves[0] if error(halves[0]) >= error(halves[1]) else halves[1]
    column = int(columns[0])
    unit = np.zeros_like(w)
    unit[column] = 1.0
    found, wanted = float(given(unit)[row]), float(expected(unit)[row])
    where = f"H_lam[{row}]" if column == w.size - 1 else f"H_y[{row}, {column}]"
    sentence = f"jacobian: at lam = {lam:g} {where} is {found:.10g}, expected {wanted:.10g} (by {source})"
    return JacobianReport(False, sentence, source, row, column, found, wanted)
