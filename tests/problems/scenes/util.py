"""Small sizes of the scenes, how exact they are there, and what tells that a model is larger than its answer needs."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from problems import lcp
from problems.lcp import MixedLCP
from problems.scenes import Point, make, order
from problems.scenes.scene import SupportsSolve, conditions

SMALL = {
    "string": {"n": 20},
}
"""Parameters other than the defaults."""

EXACT_TO = {
    "block": 1e-15, "painleve-rod": 1e-14, "box": 1e-13, "puck": 0.07, "string": 2e-3, "cournot": 1e-14,
}  # fmt: skip
"""Relative, to the closed form: round-off, or the error of the mesh at the small size."""

MINIMAL = {
    "block": (4, "a normal impulse, friction both ways, and a slip velocity to know whether friction is at its limit"),
    "painleve-rod": (1, "friction is a multiple of the contact force"),
    "box": (8, "a rigid box on a flat floor rests on two corners, whatever their number"),
    "puck": (10, "a normal impulse, eight edges of the pyramid, a slip velocity"),
    "string": (20, "one height a point of one half; the floor's force is a residual"),
    "cournot": (4, "prices and profits follow from quantities, capacities are bounds"),
}
"""The fewest unknowns that the small scenes can have, and why."""

FREE = {}
"""Kinds of unknowns that have no bounds, with the equation that asks for each: all others could be eliminated."""


def small(name):
    """The scene at a size for tests."""
    return make(name, SMALL.get(name))


def dense(problem):
    """The matrix as an array."""
    return problem.A.toarray() if sp.issparse(problem.A) else problem.A


def needless(scene):
    """What a scene models beyond what its answer needs, as sentences; none if it is minimal."""
    problem = conditions(scene.problem())
    complaints = []
    counted = sum(kind.count for kind in scene.unknowns)
    if counted != order(problem):
        complaints.append(f"{order(problem)} unknowns, of which {counted} are accounted for")
    if not isinstance(problem, MixedLCP):
        return complaints
    A, n = dense(problem), problem.n
    for i in range(n):
        for j in range(i):
            opposite = np.array_equal(A[i], -A[j]) and np.array_equal(A[:, i], -A[:, j])
            if opposite and problem.q[i] == -problem.q[j] and not problem.lower[i] and not problem.lower[j]:
                complaints.append(f"unknowns {j} and {i} are one without a sign")
            if np.array_equal(A[:, i], A[:, j]) and np.array_equal(A[i], A[j]) and problem.q[i] == problem.q[j]:
                complaints.append(f"unknowns {j} and {i} are the same")
        row, column = np.flatnonzero(A[i]), np.flatnonzero(A[:, i])
        alone = len(row) == len(column) == 1 and row[0] == column[0] != i
        if alone and problem.lower[i] == 0.0 and A[i, row[0]] * A[row[0], i] < 0.0:
            complaints.append(f"unknown {i} is the multiplier of a bound")
    complaints += [f"unknown {i} is in no equation that the answer needs" for i in sorted(set(range(n)) - used(scene))]
    return complaints


def used(scene):
    """The unknowns that the answer reads, and those that the equations of these have, and so on."""
    problem = conditions(scene.problem())
    found = lcp.solve(problem)
    if not found.solved or isinstance(scene, SupportsSolve):
        read = set(range(problem.n))
    else:
        base = flat(scene.answer(Point(found.x)))
        read = {j for j in range(problem.n) if not np.array_equal(base, flat(scene.answer(Point(moved(found.x, j)))))}
    depends = dense(problem) != 0.0
    while True:
        more = read | {int(j) for i in read for j in np.flatnonzero(depends[i])}
        if more == read:
            return read
        read = more


def moved(x, j):
    """A point with one unknown larger."""
    changed = np.array(x)
    changed[j] += 1.0 + abs(changed[j])
    return changed


def flat(answer):
    """All numbers of an answer."""
    return np.concatenate([np.atleast_1d(np.asarray(value, dtype=float)).ravel() for value in answer.values()])
