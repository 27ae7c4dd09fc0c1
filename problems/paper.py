"""The paper's ten examples, and two counterexamples to its theorems.

Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems". Data are
as printed; `true_class` and exact solutions come from all minors and bases in rational arithmetic.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.lcp import LCP


def _array(value: object) -> Array:
    """A read-only float array: examples are shared."""
    array: Array = np.array(value, dtype=float)
    array.flags.writeable = False
    return array


def _exact(*solutions: str) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(Fraction(component) for component in solution.split()) for solution in solutions)


@frozen(eq=False, kw_only=True)
class Printed:
    """A problem and a start."""

    A: Array = field(converter=_array)
    q: Array = field(converter=_array)
    x0: Array = field(converter=_array)

    @property
    def problem(self) -> LCP:
        """LCP(q, A)."""
        return LCP(self.A, self.q)


@frozen(eq=False, kw_only=True)
class Example(Printed):
    """A numerical example.

    Attributes
    ----------
    number, printed_iterations : int
    label, remarks : str
        LaTeX label; misprints and corrections.
    stated_class, true_class : str
        By the paper; by minors and proofs.
    A : Array of shape (n, n)
    q, x0, z1, z2 : Array of shape (n,)
        Data and start.
    printed_solution, printed_point : Array
        x; (x, z1, z2, lambda).
    solutions : tuple of tuple of Fraction
        All exact solutions, the printed one first.
    """

    number: int
    label: str
    stated_class: str
    true_class: str
    printed_solution: Array = field(converter=_array)
    printed_point: Array = field(converter=_array)
    printed_iterations: int
    solutions: tuple[tuple[Fraction, ...], ...]
    remarks: str = ""

    @property
    def z1(self) -> Array:
        """Starting multiplier of x >= 0: ones."""
        return np.ones(self.q.size)

    @property
    def z2(self) -> Array:
        """Starting multiplier of A x + q >= 0: ones."""
        return np.ones(self.q.size)


@frozen(eq=False, kw_only=True)
class Counterexample(Printed):
    """A strictly feasible LCP without solution, in a class for which the paper claims one.

    Attributes
    ----------
    matrix_class : str
    A : Array of shape (n, n)
    q, x0, end : Array of shape (n,)
        Data, strictly feasible start (z1 = z2 = e), x at the KKT path's end.
    refutes, why : str
        False statement; reason.
    """

    matrix_class: str
    end: Array = field(converter=_array)
    refutes: str
    why: str


EXAMPLES: tuple[Example, ...] = (
    Example(
        number=1,
        label="matrix0",
        stated_class="N",
        true_class="N: every principal minor is negative; so nondegenerate",
        A=[[-1, 2], [3, -1]],
        q=[1, -0.5],
        x0=[0.4, 0.1],
        printed_solution=[1, 0],
        printed_point=[1, 0, 0, 2.5, 1, 0, 0],
        printed_iterations=20,
        solutions=_exact("1 0"),
        remarks="The points (1/6, 0) and (1/2, 0) satisfy the KKT system and do not solve the LCP.",
    ),
    Example(
        number=2,
        label="matrix1",
        stated_class="PSD",
        true_class="positive semidefinite, symmetric of rank 1; so P0 and row sufficient",
        A=[[1, -1], [-1, 1]],
        q=[-0.5, 2],
        x0=[2, 1],
        printed_solution=[0.5, 0],
        printed_point=[0.5, 0, 0, 1.499, 0.499, 0, 0, 0],
        printed_iterations=22,
        solutions=_exact("1/2 0"),
        remarks="The end point is printed with eight numbers for seven, a zero too many at the end; 1.499 and 0.499 "
        "stand for 1.5 and 0.5.",
    ),
    Example(
        number=3,
        label="matrix2",
        stated_class="singular Q0",
        true_class="singular, Q0 as stated; P0 and row sufficient, not positive semidefinite",
        A=[[1, 1], [0, 0]],
        q=[-1, 1],
        x0=[1, 0.2],
        printed_solution=[1, 0],
        printed_point=[1, 0, 0, 1, 1, 0, 0],
        printed_iterations=15,
        solutions=_exact("1 0"),
    ),
    Example(
        number=4,
        label="matx1",
        stated_class="E0^s",
        true_class="E0^s as stated; neither P0 nor nondegenerate: zero diagonal, minors of both signs",
        A=[[0, 1, 1], [2, 0, 1], [-4, -5, 0]],
        q=[-4, -7, 10],
        x0=[1, 1, 6],
        printed_solution=[0, 2, 7],
        printed_point=[0, 2, 7, 5, 0, 0, 0, 2, 7, 0],
        printed_iterations=14,
        solutions=_exact("0 2 7", "5/2 0 4", "25/14 4/7 24/7"),
        remarks="Three solutions. The paper's section says that its examples are P0 or nondegenerate; this is neither.",
    ),
    Example(
        number=5,
        label="matrix3",
        stated_class="not N",
        true_class="nondegenerate; not N: minors of both signs",
        A=[[-1, 2, 1], [1, -0.5, -0.25], [-0.5, -1, -1]],
        q=[-0.25, -0.1, 3],
        x0=[2.3, 1, 0.7],
        printed_solution=[1.8333, 0, 2.0833],
        printed_point=[1.8333, 0, 2.0833, 0, 1, 2125, 0, 1.8333, 0, 2.0833, 0],
        printed_iterations=17,
        solutions=_exact("11/6 0 25/12", "13/60 7/30 0"),
        remarks="The number 1.2125 = 97/80 is printed as 1,2125, so that the end point has eleven numbers for ten.",
    ),
    Example(
        number=6,
        label="matrix4",
        stated_class="almost C0",
        true_class="almost C0 as stated (e'Ae = -3); nondegenerate: proper principal minors 1, determinant -7",
        A=[[1, -2, 0], [0, 1, -2], [-2, 0, 1]],
        q=[-1, 1, 7],
        x0=[3, 0.5, 0.5],
        printed_solution=[1, 0, 0],
        printed_point=[1, 0, 0, 0, 1, 5, 1, 0, 0, 0],
        printed_iterations=24,
        solutions=_exact("1 0 0", "29/7 11/7 9/7"),
        remarks="Called a degenerate solution in the paper; it is strictly complementary, w = (0, 1, 5).",
    ),
    Example(
        number=7,
        label="matrix5",
        stated_class="almost N-bar, Q",
        true_class="almost N0: proper principal minors are at most 0, the determinant is 1; degenerate",
        A=[[-1, 1, 1, 1], [1, 0, 0, 0], [1, 0, 0, -1], [1, 0, -1, 0]],
        q=[-1, 1, -1, 1],
        x0=[4, 4, 1, 1],
        printed_solution=[1, 0, 2, 0],
        printed_point=[1, 0, 2, 0, 0, 2, 0, 0, 1, 0, 2, 0, 0],
        printed_iterations=17,
        solutions=_exact("1 0 2 0"),
        remarks="The only example whose solution is not strictly complementary: x_4 = w_4 = 0.",
    ),
    Example(
        number=8,
        label="maat4",
        stated_class="almost N0",
        true_class="almost N0 as stated: proper principal minors are at most 0, the determinant is 8; degenerate",
        A=[[-2, -2, -2, 2], [-2, -1, -3, 3], [-2, -3, -1, 3], [2, 3, 3, 0]],
        q=[-1001, -500, -500, -500],
        x0=[100, 100, 200, 1000],
        printed_solution=[250, 0, 0, 750.5],
        printed_point=[250, 0, 0, 750.5, 0, 1251.5, 1251.5, 0, 250, 0, 0, 750.5, 0],
        printed_iterations=17,
        solutions=_exact("250 0 0 1501/2"),
        remarks="Called a degenerate solution in the paper; it is strictly complementary.",
    ),
    Example(
        number=9,
        label="matrix6",
        stated_class="N0 of exact order 2",
        true_class="N0 of exact order 2 as stated: minors to order 3 at most 0, of orders 4 and 5 positive; degenerate",
        A=[[0, 0, 0, 1, 2], [0, 0, -1, -1, 2], [0, -1, 0, -1, 1], [1, -1, -1, 0, 0], [2, 1, 0, 0, 0]],
        q=[-2, -1, 7, 2, -1],
        x0=[3, 1, 1, 1, 3],
        printed_solution=[0.5, 0, 0, 0, 1],
        printed_point=[0.5, 0, 0, 0, 1, 0, 1, 8, 2.5, 0, 0.5, 0, 0, 0, 1, 0],
        printed_iterations=27,
        solutions=_exact("1/2 0 0 0 1", "0 1 1 14 8"),
        remarks="A stray row of 25 numbers is printed after the example; it is the matrix of example 10.",
    ),
    Example(
        number=10,
        label="mtx5",
        stated_class="N-bar of exact order 2",
        true_class="N0 of exact order 2: minors to order 3 are at most 0, of orders 4 and 5 positive; degenerate",
        A=[
            [0, -90, -80, -70, 0],
            [-90, -2, -2, -2, 2],
            [-70, -2, -1, -3, 3],
            [-50, -2, -3, -0.8, 3],
            [0, 2, 3, 3, 0],
        ],
        q=[400, 50, 30, 20, -10],
        x0=[0.1, 0.1, 0.1, 5, 100],
        printed_solution=[0.2403846, 0, 1.634615, 3.846154, 0],
        printed_point=[
            0.2403846, 0, 1.634615, 3.846154, 0, 0, 17.40385, 0, 0, 6.442308,
            0.2403846, 0, 1.634615, 3.846154, 0, 0,
        ],
        printed_iterations=1925,
        solutions=_exact("25/104 0 85/52 50/13 0", "87/143 40/11 10/11 0 90/13"),
        remarks="The path turns twice in lambda. The paper's matrix is not symmetric: -80, -70 against -70, -50.",
    ),
)  # fmt: skip

COUNTEREXAMPLES: tuple[Counterexample, ...] = (
    Counterexample(
        matrix_class="P0",
        A=[[0, 1], [0, 0]],
        q=[-1, 1],
        x0=[1, 2],
        end=[1.3247, 1],
        refutes="The paper: for every P0 matrix the limit of the path solves the LCP.",
        why="w_2 = 1 forces x_2 = 0, and then w_1 = -1: no solution. The path ends at w = (0, 1), where x_2 w_2 = 1; "
        "A is P0 but not row sufficient.",
    ),
    Counterexample(
        matrix_class="nondegenerate",
        A=[[1, 1], [1, -1]],
        q=[-1, -2],
        x0=[4, 1],
        end=[2, 0],
        refutes="The paper: for every nondegenerate matrix the limit of the path solves the LCP.",
        why="The minors are 1, -1 and -2, and none of the four bases is feasible: no solution. The path ends at "
        "w = (1, 0), where x_0 w_0 = 2; the proof takes W_q + X_q (A')_qq for a principal minor of A.",
    ),
)
"""Problems whose KKT paths end at stationary points."""
