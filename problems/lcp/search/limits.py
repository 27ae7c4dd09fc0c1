"""How long each attempt of a strategy goes on, and up to which order it is one; the reasons are beside the numbers."""

from __future__ import annotations

from attrs import evolve

from problems.lcp.active_set.finish import CORRECTIONS_WITHOUT_GAIN
from problems.lcp.active_set.iteration import Policy

FIRST = Policy(steps=30)
"""Corrections of an active set before any path, from a guess that is good; each costs less than a step of a path."""

AT_GUESS = Policy(steps=2)
"""Of the active set of a problem nearby: where it has hardly changed that is all; else pivots are quicker."""

FROM_ZERO = Policy(steps=30, patience=CORRECTIONS_WITHOUT_GAIN)
"""From x = 0, which is no guess at all."""

WHILE_REGULAR = evolve(FROM_ZERO, regular=True, singular=3)
"""The same where pivots come next: contacts in excess make faces singular, of which 10 to 20 take 1 to 30 ms, and
Lemke's method half of that (arches and piles, n = 40 to 320; prices, n = 225 and 400). Two of them are enough for a box
on many corners, in half of the time of pivots."""

LEAST_SINGULAR, LARGEST_SINGULAR = 13, 400
"""Between these orders Lemke's method comes before any other active set than the first, where that is singular or zeros
are on the diagonal: of arches, piles and prices (n = 25 to 400) that takes 0.1 to 0.9 of the time. Below, a few active
sets take as long; semidefinite problems of rank n / 2 take as long either way at n = 400."""

LEAST_REGULAR = 0.4
"""So many of the equations of the first face, as a share, are independent where pivots come first: of contact 0.5 to 1,
of one box on many corners, of which two or three singular faces are enough, 0.05 to 0.4."""

MOST_Z_STEPS = 1000
"""The same for a Z-matrix, where n corrections are enough: each makes the active set larger until it is right."""

LARGEST_PROOF = 30_000_000
"""Order times number of entries up to which a proof is looked for where the budget has no limit of seconds.

Two seconds then: 2.0 for a dense matrix of order 300, 1.5 for a sparse one of order 1000 with seven entries a row, 2.3
for a tridiagonal one of order 3000; a dense one of order 500, four times the limit, takes 10.
"""

PROOF_SHARE = 0.2
"""Of the time left, where that is limited, the most that a proof takes: it is mostly far quicker than a path."""

FEW_PIECES = 10
"""With bounds, so many pieces as an LCP of this order has faces are tried before any path."""

LARGEST_MADE_DENSE = 500
"""A sparse matrix of at most this order is made dense for pivots and paths, whose matrices of order n or 2n fill: with
5 % entries and n = 200 a path takes a tenth of the time then."""

FEW_GROUPS = 20, 1000
"""Up to this order such a tree comes before reflections, which take 3 ms where it takes 1 to 15, but find a solution
that depends on how sums are rounded."""

SMALL_TREE = 40, 1000
"""Largest order, and linear programs of a small tree that enumerates faces in groups, before any path: 0.1 ms each at
n = 20, 0.2 at 40. Feasible Gaussian problems take 5 to 150 up to n = 20, 40 to 1,000 at 30 and 1,200 at 40."""

LARGE_TREE = 40, 10_000
"""The same after the first paths: 1 s at n = 20, 2 at 40. At n = 60, where 300 to 20,000 and more are needed, restarts
solve in 0.6 s what takes 2 to 7 with this before them."""

LARGEST_TINY = 6
"""Up to this order they come right after Lemke's method, before units of the problem's own, which take 0.4 ms: 0.1 ms
(n = 3, 4) to 0.8 ms (6)."""

LEAST_START = 1e-3
"""In natural units: what a zero of x0 is where a path begins, which needs positive ones."""

MOST_AUGMENTED = 2000
"""Factorisations of order n for the augmented Lagrangian: 1,500 are needed for QCAPRI, some 100 for most others."""

LARGEST_EARLY_PROOF = 40
"""Up to this order the linear program is not worth a thought (5 ms, where Wang's path takes 200), so it comes first."""

FIRST_ROUND, FIRST_ROUNDS = 1, 4
"""Rounds of reflections before any path: where faces can be enumerated in groups, which decide more, and else."""

FIRST_WORK, MOST_WORK, MOST_ROUNDS = 1.5e9, 6e9, 40
"""Iterations times n^2 of reflections before any path, and before restarts; of the second at most so many rounds. The
first is 5 s at n = 300, where nothing is found, and one round at n = 600 (16 s) and 1000 (a minute, of which Gaussian
problems need 5 to 17 s); together with the second 20 to 30 s."""

FIRST_SHARE, REFLECTED_SHARE = 0.25, 0.5
"""Of the time left, where that is limited, for the first and for the others: what they do not solve paths may."""
