"""BLAS has one thread while a path is traced or an LCP is solved, unless the user chose a number."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

PROGRAM = """
import numpy as np
import continuation
from continuation.linear.threads import _pools, one_thread
from problems import lcp

threads = lambda: [get() for get, _ in _pools()]
before, seen = threads(), []

class Line:
    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        seen.append(threads())
        return y - lam

continuation.trace(Line(), target=1.0)
continuation.trace(Line(), target=1.0, observers=[])
lcp.solve(lcp.LCP(np.eye(2), [-1.0, -1.0]))
try:
    with one_thread, one_thread:
        inside = threads()
        raise KeyboardInterrupt
except KeyboardInterrupt:
    pass
assert all(number == 1 for numbers in [inside, *seen] for number in numbers), seen
assert threads() == before
print(len(before))
"""


@pytest.mark.parametrize("chosen", [{}, {"OMP_NUM_THREADS": "2"}], ids=str)
def test_one_thread_within_and_the_number_before_behind(chosen):
    environment = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")} | chosen
    run = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert not (chosen and run.stdout != "0\n"), "a number that was chosen is left alone"
