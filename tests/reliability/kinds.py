"""Kinds of arguments, and for each what cannot be meant: see `hostile.py`."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from typing import Any

import numpy as np
import scipy.sparse as sp

import continuation as c
from continuation import controllers, correctors, metric, predictors
from continuation.archive import Limits, PathLog
from continuation.controllers import Bounds
from problems import bifurcation, lcp

NAN, INF = np.nan, np.inf
NO_NUMBERS = ("a", None, 1j, [1.0], {}, (), np.ones(2), object, len, Decimal("nan"))
NO_TRUTH = ("no", None, 1, 0.0, [], {}, NAN)
NO_HOMOTOPY = (None, 3, "cusp", bifurcation.Cusp, len, {}, [], np.ones(2))
NO_OBJECT = (None, 3, "a", [], {}, len)
NO_NAMES = (5, 1.5, b"a.h5", ["a.h5"], {}, len, PathLog)


def vectors(n: int) -> tuple[Any, ...]:
    """What is no vector of n finite numbers."""
    return (
        "a", None, 5.0, {}, {1, 2}, len, [NAN] * n, [INF] * n, [1j] * n, ["a"] * n, [None] * n, np.ones(n + 1),
        np.ones((n, n)), np.zeros(n, "M8[s]"), np.ma.masked_array(np.ones(n), np.ones(n)), [[1.0], [1.0, 2.0]],
        [10**400] * n, np.array([object()] * n), [True] * n, (value for value in [1.0] * n), ["-5"] * n,
        sp.csr_array(np.ones((1, n))), dict.fromkeys(range(n), 1.0), np.array(["1e4000"] * n, np.longdouble),
    )  # fmt: skip


def optional(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """The same, where None is allowed."""
    return tuple(value for value in values if value is not None)


NO_MATRICES = (
    "a", None, 5, {}, {1, 2}, len, np.ndarray, [], [1, 2], np.ones((2, 3)), np.ones((2, 2, 2)), [[1, 2], [3]],
    [[NAN, 1], [1, 2]], [[INF, 1], [1, 2]], np.eye(2) + 1j, [["a", "b"], ["c", "d"]], [[None, 1], [1, 2]],
    np.zeros((2, 2), "M8[s]"), b"abcd", np.ma.masked_array(np.eye(2), np.eye(2)), sp.csr_array([[NAN, 1], [1, 2]]),
    sp.csr_array(np.eye(2) + 1j), sp.csr_array(np.ones((2, 3))), sp.coo_array(np.ones(2)),
    np.array([[object()] * 2] * 2), (row for row in np.eye(2)), lcp.LCP(np.eye(2), np.ones(2)),
    np.zeros((2, 2), [("a", "f8")]), np.ones((2, 2), "m8[s]"), np.array([[2, 1j], [1, 2]], object),
    np.array([[2, "x"], [1, 2]], object),
    sp.linalg.aslinearoperator(np.eye(2)), sp.coo_array(([1e308, 1e308], ([0, 0], [0, 0])), shape=(2, 2)),
    np.array([["1e4000", "1"], ["1", "1"]], np.longdouble),
)  # fmt: skip

POSITIVE = (*NO_NUMBERS, 0, -1.0, NAN, -INF, True)
KINDS: Mapping[str, tuple[Any, ...]] = {
    "positive": POSITIVE,
    "positive, finite": (*POSITIVE, INF),
    "positive or None": optional(POSITIVE),
    "not negative or inf": (*NO_NUMBERS, -1.0, NAN, True),
    "fraction": (*POSITIVE, INF, 1.0, 2),
    "share": (*NO_NUMBERS, -0.1, NAN, INF, 1.1, True),
    "factor": (*POSITIVE, INF, 1.0, 0.5),
    "finite": (*NO_NUMBERS, NAN, INF, -INF, True),
    "finite or None": (*optional(NO_NUMBERS), NAN, INF, -INF, True),
    "not negative": (*NO_NUMBERS, -1.0, NAN, INF, True),
    "count": (*NO_NUMBERS, 0, -3, 2.5, NAN, INF, True),
    "count or None": (*optional(NO_NUMBERS), -3, 2.5, NAN, INF),
    "from 0": (*NO_NUMBERS, -1, 2.5, NAN, INF, True),
    "integer": (*NO_NUMBERS, 2.5, NAN, INF, True),
    "sign": (*NO_NUMBERS, True, 2, -2, 0.5, NAN, INF),
    "truth": NO_TRUTH,
    "text": (5, None, b"a", [], {}, len, NAN),
    "function": (5, None, "f", [], {}, NAN, 1j),
    "function or None": (5, "f", [], {}, NAN, 1j),
    "homotopy": NO_HOMOTOPY,
    "homotopy with pieces": (*NO_HOMOTOPY, bifurcation.Cusp()),
    "family": (None, 3, "a", [], {}, np.ones(2)),
    "path": (*NO_OBJECT, c.Path, np.ones(3)),
    "event": (*NO_OBJECT, c.TurningPoint(), np.ones(3)),
    "events": (None, 3, "turning", len, [len], [3], [None], c.TurningPoint(), [c.TurningPoint], {}),
    "guards": (None, 3, "bent", len, [3], [None], ["bent"], {}),
    "sign, not 0": (*NO_NUMBERS, 0, 2, 0.5, NAN, INF),
    "count from 1 or None": (*optional(NO_NUMBERS), 0, -3, 2.5, NAN, INF, True),
    "stability": (5, "all", [], {}, len, c.Stability),
    "values": (None, 3, "a", [NAN], ["a"], [None], len),
    "known points": (None, 3, "a", [[NAN]], [np.zeros(3)], len),
    "vectors": (None, 3, "a", 1j, [[NAN, 0.0]], {}, len, np.ones(3), np.ones((2, 2, 2))),
    "observers": (None, 3, "log", len, [len], [3], [None], object(), [PathLog]),
    "budget": (5, "5", NAN, {"steps": 3}, c.Budget, [], len),
    "tolerance": (*POSITIVE, INF, Decimal("1e-8"), 1e300, 1.0, 1e-40, c.Tolerance(relative=1e-40), c.Tolerance, "1e-8"),
    "tolerance of a solution": (*POSITIVE, INF, Decimal("1e-8"), 1.0, 2, "1e-8", c.Tolerance()),
    "target": (*optional(NO_NUMBERS), NAN, INF, -INF, "x"),
    "start": (3, "a", (np.zeros(5), np.ones(5)), ("a", "b"), (np.full(2, NAN), np.ones(2)), (np.zeros(2), np.zeros(2)),
              (np.zeros(2),), (np.zeros(2), np.ones(3)), (np.zeros(2) + 1j, np.ones(2)), [], {}, (1, 2, 3)),
    "state": (5, "a", {}, [], c.Tracer, np.ones(2)),
    "preset": ("fast", None, 5, [], c.FAST.predictor, type(c.FAST)),
    "predictor": ("tangent", 5, [], predictors.Tangent, correctors.BorderedNewton(), len),
    "corrector": ("newton", 5, [], correctors.BorderedNewton, predictors.Tangent(), len),
    "controller": ("fixed", 5, [], controllers.Fixed, Bounds(), len),
    "metric": ("rms", 5, [], metric.RootMeanSquare, len),
    "box": (3, "lam", [], {"lam": 3}, {"x": (0, 1)}, {"lam": (1, 0)}, {"lam": (NAN, 1)}, {"lam": ("a", "b")},
            {9: (0, 1)}, {"lam": (0, 1, 2)}, {"lam": (1e3, 2e3)}, len),
    "bounds": (None, 5, "a", [], {}, Bounds, (0.1, 1.0)),
    "limits": ((1, 2, 3), 5, "a", {}, Limits),
    "order 2 or 4": (*optional(NO_NUMBERS), None, 0, 3, 99, 2.5, NAN, INF),
    "order 2 to 4": (*optional(NO_NUMBERS), None, 0, 1, 99, 2.5, NAN, INF),
    "order": (*optional(NO_NUMBERS), 0, 1, -2, 2.5, NAN, INF, True, 10**6),
    "degree": (*NO_NUMBERS, 0, 1, -2, 2.5, NAN, INF, True, 10**6),
    "name of a file": (*NO_NAMES, None),
    "name of a new file": NO_NAMES,
    "archive": (*NO_OBJECT, "a.h5"),
    "homotopies": (None, 3, bifurcation.Cusp(), len, [3], [bifurcation.Cusp(), None], [bifurcation.Cusp]),
    "executor": (5, "threads", [], len, c.Tracer),
    "progress": (5, "yes", True, []),
    "seconds": (*optional(NO_NUMBERS), 0, -1.0, NAN, True),
    "point": (*vectors(2), np.ones(1)),
    "places": ("a", 1j, None, {}, -1.0, 1e9, NAN, [0.0, NAN], ["a"], len),
    "matrix": (*NO_MATRICES, [[10**400, 1], [1, 2]]),
    "vector": vectors(2),
    "vector of any size": vectors(2)[:11] + vectors(2)[12:],
    "vector or None": optional(vectors(2)),
    "level": (*NO_NUMBERS[:1], *NO_NUMBERS[2:3], -1.0, NAN, INF, [1.0, NAN], np.ones(3), {}, len),
    "lower": ("a", 1j, NAN, [NAN, 0.0], INF, np.ones(3), {}, len, ["a", "b"], np.zeros((2, 2))),
    "upper": ("a", 1j, NAN, [NAN, 0.0], -INF, np.ones(3), {}, len, ["a", "b"], np.zeros((2, 2))),
    "exact matrix": (*NO_MATRICES, np.zeros((0, 0))),
    "problem": ((np.eye(2), np.ones(2)), None, 3, "a", np.eye(2), lcp.LCP, [], {}, len),
    "guess": (3, "a", np.ones(2), lcp.Solution, [], {}, len),
    "name of a homotopy": ("simplex", None, 3, "KKT", ["kkt"], lcp.KKTHomotopy, {}, b"kkt"),
    "name of a factorisation": ("umfpack", "cholesky", None, 3, "AMG", ["amg"], {}, b"amg"),
    "start of an LCP": (*optional(vectors(2)), [-1.0, 1.0], [True, True], np.ones(1)),
    "positive start": (*optional(vectors(2)), [-1.0, 1.0], [0.0, 1.0], [True, True], np.ones(1)),
    "generator": (None, 3, "a", [], {}, len),
    "interval": (None, 3, "a", (1.0,), (NAN, 1.0), ("a", "b"), (1.0, 1.0), {}, len),
    "source": (None, 3, "a", [], {}, np.ones(2)),
    "vector of one": tuple(value for value in optional(vectors(1)) if not isinstance(value, float)),
    "point of two": optional(vectors(2)),
    "pair": (None, 3, "a", [], {}, (1,), (1, 2, 3), ([0.0], [1.0, 2.0]), (["a"], 0.0), ([0.0], "a"),
             ([1j], 0.0)),
}  # fmt: skip
