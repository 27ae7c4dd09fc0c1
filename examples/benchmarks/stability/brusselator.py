"""The Brusselator with diffusion on an interval, and what eigenvalues along its branch cost.

    python examples/benchmarks/stability/brusselator.py [points of the grid] [repetitions]

Two unknowns a point of the grid, fixed at both ends. The uniform state loses its stability at Hopf points, one for each
Fourier mode; of the grid's own modes they are known. Times are of the process, the smallest of the repetitions.
"""

import sys
import time

import numpy as np
import scipy.sparse as sp
from attrs import frozen

import continuation

A, DX, DY, LENGTH = 2.0, 0.008, 0.004, 1.0


@frozen
class Brusselator:
    """x' = DX x'' + A - (B + 1) x + x^2 y, y' = DY y'' + B x - x^2 y, with x = ends A, y = B / A at the ends; B from 4.

    With ends = 1 the state is uniform, and the branch a straight line; else it is a curve.
    """

    points: int = 1000
    ends: float = 1.2
    target: float = 6.2

    @property
    def laplacian(self):
        n = self.points
        h = LENGTH / (n + 1)
        return sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)) / h**2

    def start(self):
        return np.repeat([A, 4.0 / A], self.points), 4.0

    def residual(self, y, lam):
        x, z = y[: self.points], y[self.points :]
        h2 = (LENGTH / (self.points + 1)) ** 2
        bent = [np.diff(np.concatenate(([end], w, [end])), 2) / h2 for w, end in ((x, self.ends * A), (z, lam / A))]
        made = x * x * z
        return np.concatenate([DX * bent[0] + A - (lam + 1.0) * x + made, DY * bent[1] + lam * x - made])

    def jacobian(self, y, lam):
        n = self.points
        x, z = y[:n], y[n:]
        L = self.laplacian
        one = sp.diags_array(2.0 * x * z - lam - 1.0), sp.diags_array(x * x)
        two = sp.diags_array(lam - 2.0 * x * z), sp.diags_array(-x * x)
        ends = np.zeros(n)
        ends[[0, -1]] = DY / A * ((n + 1) / LENGTH) ** 2
        return (
            sp.csc_array(sp.block_array([[DX * L + one[0], one[1]], [two[0], DY * L + two[1]]])),
            np.concatenate([-x, x + ends]),
        )

    def hopf(self, mode):
        """Where the trace of the mode's two equations vanishes, and its frequency."""
        n = self.points
        rate = 4.0 * ((n + 1) / LENGTH) ** 2 * np.sin(0.5 * mode * np.pi / (n + 1)) ** 2
        B = 1.0 + A * A + (DX + DY) * rate
        return B, np.sqrt((B - 1.0 - DX * rate) * (-A * A - DY * rate) + A * A * B)


def traced(brusselator, **options):
    began = time.process_time()
    path = continuation.trace(brusselator, **options)
    return path, time.process_time() - began


def main(points=1000, repetitions=3):
    # Up to the first Hopf point, and over two, with many points and with few.
    for target, max_step in ((5.1, 0.02), (6.2, 0.02), (6.2, 0.05)):
        compare(Brusselator(points, target=target), repetitions, max_step)
    uniform = Brusselator(points, ends=1.0)
    path = continuation.trace(uniform, observers=[continuation.Stability()])
    found = [event for event in path.events if event.kind == continuation.Kind.HOPF]
    for mode, event in enumerate(found, start=1):
        B, frequency = uniform.hopf(mode)
        print(
            f"uniform state, mode {mode}: B = {event.lam:.12f}, off by {abs(event.lam - B):.0e}, "
            f"frequency off by {abs(event.observed['frequency'] - frequency):.0e}"
        )


def compare(brusselator, repetitions, max_step):
    """One line: a trace with and without stability, in turn, and the smallest time of each."""
    alone, watched = [], []
    for _ in range(repetitions):
        plain, seconds = traced(brusselator, max_step=max_step)
        alone.append(seconds)
        path, seconds = traced(brusselator, max_step=max_step, observers=[continuation.Stability()])
        watched.append(seconds)
    hopf = sum(event.kind == continuation.Kind.HOPF for event in path.events)
    print(
        f"N = {2 * brusselator.points}: {len(path)} points, {hopf} Hopf points, {min(alone):.2f} s, with stability "
        f"{min(watched):.2f} s, {min(watched) / min(alone):.2f} times as much; {plain.counts.factorizations} and "
        f"{path.counts.factorizations} factorisations, {plain.counts.solves} and {path.counts.solves} solves"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
