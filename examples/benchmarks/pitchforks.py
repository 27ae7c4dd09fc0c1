"""Pitchforks that leave each other, (lam - k) y_k = y_k^3 for k = 1 to n: all 1 + (3^n - 1) / 2 branches.

    python examples/benchmarks/pitchforks.py [n] [processes] [archive]

With an archive, points stay in the file, and one that is there is gone on with.
"""

import resource
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext

import numpy as np
from attrs import frozen
from campaign import asked

import continuation


@frozen
class Pitchforks:
    """n of them; each solution of those before the k-th has a branch point at lam = k."""

    n: int

    def start(self):
        """The trunk."""
        return np.zeros(self.n), 0.5

    def residual(self, y, lam):
        """Cubic."""
        return (lam - np.arange(1.0, self.n + 1.0)) * y - y**3

    def jacobian(self, y, lam):
        """Diagonal."""
        return np.diag(lam - np.arange(1.0, self.n + 1.0) - 3.0 * y * y), y.copy()


def run(n, processes=0, archive=None):
    """The diagram, after a look at every branch point and every end."""
    kept = {} if archive is None else {"archive": archive, "keep": "ends", "resume": True}
    with ProcessPoolExecutor(processes) if processes else nullcontext() as executor:
        found = continuation.diagram(
            Pitchforks(n), box={"lam": (0.0, n + 2.0)}, branches=10**6, executor=executor, **kept
        )
    assert found.complete, found.message
    assert len(found) == 1 + (3**n - 1) // 2
    assert len(found.points) == len(found) - 1
    assert {len(point.branches) for point in found.points} == {2}
    states = set()
    for branch in found.branches[1:]:
        for step in (branch.path.steps[0], branch.path.steps[-1]):
            exact = np.sqrt(n + 2.0 - np.arange(1.0, n + 1.0)) * np.sign(np.round(step.y, 6))
            assert np.abs(step.y - exact).max() <= 1e-9
            states.add(tuple(np.sign(exact)))
    assert len(states) == 3**n - 1
    return found


if __name__ == "__main__":
    files, (n, processes), _ = asked(5, 0)
    found = run(n, processes, *files)
    seconds = sum(resource.getrusage(who).ru_utime for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{found}, {seconds:.0f} s of processors, {1e3 * seconds / len(found):.1f} ms a branch, {megabytes:.0f} MB")
