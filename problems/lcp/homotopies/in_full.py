"""Derivatives of the homotopies in all their unknowns, for reference: the engine uses what has been reduced to order n.

Dense ones are made by numpy alone: blocks of sparse matrices cost a small problem a hundred times as much.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array, Matrix
from problems.lcp.homotopies.kkt_system import KKTSystem
from problems.lcp.homotopies.pair_system import PairSystem


def kkt_in_full(s: KKTSystem) -> tuple[Matrix, Array]:
    """(H_y, H_lam) of the KKT homotopy from its system at a point, sparse as A is."""
    column = np.concatenate([s.column, -s.c1, s.factor * s.rho - s.c2, -s.c3])
    return (_sparse_kkt(s) if s.structure.problem.sparse else _dense_kkt(s)), column


def _dense_kkt(s: KKTSystem) -> Array:
    structure, sides, mu, n, m = s.structure, s.rows.sides, 1.0 - s.lam, s.structure.n, s.gap.size
    x, first, second, third = np.split(np.arange(2 * n + m + s.t.size), [n, n + m, 2 * n + m])
    boxed = second[s.rows.boxed]
    whole = np.zeros((2 * n + m + s.t.size,) * 2)
    whole[:n, :n] = mu * structure.symmetrized
    whole[x, x] += s.lam
    whole[sides.index, first], whole[first, sides.index] = -mu * sides.sign, s.z1 * sides.sign
    whole[:n, n + m : 2 * n + m] = -mu * structure.transpose
    whole[n + m : 2 * n + m, :n] = s.factor[:, None] * structure.problem.A
    whole[first, first], whole[second, second] = s.gap, s.rest
    whole[boxed, third], whole[third, boxed] = s.factor[s.rows.boxed], -s.t
    whole[third, third] = s.rows.width - s.z2[s.rows.boxed]
    return whole


def _sparse_kkt(s: KKTSystem) -> Matrix:
    structure, rows, mu, eye = s.structure, s.rows, 1.0 - s.lam, sp.eye_array(s.structure.n, format="csr")
    pull, at = sp.diags_array(rows.sides.sign) @ eye[rows.sides.index], eye[rows.boxed]
    slope = mu * sp.csr_array(structure.symmetrized) + s.lam * eye
    factor, last = sp.diags_array(s.factor), sp.diags_array(rows.width - s.z2[rows.boxed])
    return sp.block_array(
        [
            [slope, -mu * pull.T, -mu * sp.csr_array(structure.transpose), None],
            [sp.diags_array(s.z1) @ pull, sp.diags_array(s.gap), None, None],
            [factor @ sp.csr_array(structure.problem.A), None, sp.diags_array(s.rest), factor @ at.T],
            [None, None, -sp.diags_array(s.t) @ at, last],
        ],
        format="csr",
    )


def pairs_in_full(s: PairSystem) -> tuple[Matrix, Array]:
    """The same of a homotopy in (x, y)."""
    column = np.concatenate([s.blend.sign * s.column, -s.c])
    return (_sparse_pairs(s) if s.structure.problem.sparse else _dense_pairs(s)), column


def _dense_pairs(s: PairSystem) -> Array:
    n, sign, index, turn = s.structure.n, s.blend.sign, s.sides.index, s.sides.sign
    x, force = np.arange(n), n + np.arange(index.size)
    whole = np.zeros((n + index.size,) * 2)
    whole[:n, :n] = sign * s.alpha * s.structure.problem.A
    whole[x, x] += sign * s.beta
    whole[index, force], whole[force, index], whole[force, force] = -sign * s.gamma * turn, s.y * turn, s.gap
    return whole


def _sparse_pairs(s: PairSystem) -> Matrix:
    problem, sign, eye = s.structure.problem, s.blend.sign, sp.eye_array(s.structure.n, format="csr")
    pull = eye if problem.standard else sp.diags_array(s.sides.sign) @ eye[s.sides.index]
    diagonal = sp.diags_array(np.broadcast_to(sign * s.beta, problem.n))
    top = [sp.csr_array(sign * s.alpha * problem.A) + diagonal, -sign * s.gamma * pull.T]
    return sp.block_array([top, [sp.diags_array(s.y) @ pull, sp.diags_array(s.gap)]], format="csr")
