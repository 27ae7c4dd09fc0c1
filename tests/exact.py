"""Linear algebra in rational arithmetic that shares nothing with the library."""

from fractions import Fraction

import numpy as np


def fractions(values):
    """The floats as the rationals that they are."""
    return np.vectorize(Fraction, otypes=[object])(np.asarray(values, dtype=float))


def gauss_jordan(rows, right=None):
    """(x, determinant) of a square system; x is None where it is singular."""
    n = len(rows)
    work = [[Fraction(v) for v in (*row, b)] for row, b in zip(rows, [0] * n if right is None else right)]
    product = Fraction(1)
    for k in range(n):
        pivot = next((i for i in range(k, n) if work[i][k]), None)
        if pivot is None:
            return None, Fraction(0)
        if pivot != k:
            work[k], work[pivot], product = work[pivot], work[k], -product
        product *= work[k][k]
        work[k] = [v / work[k][k] for v in work[k]]
        for i in range(n):
            if i != k and work[i][k]:
                work[i] = [a - work[i][k] * b for a, b in zip(work[i], work[k])]
    return [row[-1] for row in work], product


def determinant(rows):
    """Of a square matrix."""
    return gauss_jordan(rows)[1]


def exact_w(problem, x):
    """A x + q."""
    A = problem.A.toarray() if problem.sparse else problem.A
    return fractions(A) @ np.array([Fraction(v) for v in x], dtype=object) + fractions(problem.q)


def solves(problem, x):
    """Whether x >= 0, A x + q >= 0 and all products are zero."""
    w = exact_w(problem, x)
    return min(*x, *w) >= 0 and not any(Fraction(a) * b for a, b in zip(x, w, strict=True))


def check_farkas(problem, proof):
    """y >= 0, A'y <= 0 and the gap q'y that is stated, negative."""
    A = problem.A.toarray() if problem.sparse else problem.A
    y = np.array(proof.y, dtype=object)
    assert min(y) >= 0 < max(y)
    assert max(fractions(A).T @ y) <= 0
    assert fractions(problem.q) @ y == proof.gap < 0
