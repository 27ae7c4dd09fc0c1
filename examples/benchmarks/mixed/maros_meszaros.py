"""The Maros-Meszaros programs of up to 300 variables and rows, as they come: no free variable and no box is split.

    python examples/benchmarks/mixed/maros_meszaros.py FOLDER [seconds] [NAME ...]

FOLDER holds the .mat files of https://github.com/qpsolvers/maros_meszaros_qpbenchmark (data/): P, q, r, and l <= A x
<= u, of which the last n rows are the bounds of x.
"""

import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sp

from continuation.budget import Budget
from problems import lcp

LARGEST = 300
ACCURATE = 1e-9
NONE = 1e19


def read(file):
    data = scipy.io.loadmat(file)
    n = int(data["n"][0, 0])
    A = sp.csr_array(data["A"])
    ends = (data[name].ravel().astype(float) for name in "lu")
    # 1e20 is none, also where a constant was added to it.
    low, high = (np.where(np.abs(end) >= NONE, np.copysign(np.inf, end), end) for end in ends)
    m = A.shape[0] - n
    P = data["P"].toarray()
    rows = {"G": A[:m].toarray(), "h": high[:m], "rows_lower": low[:m]} if m else {}
    program = lcp.from_qp((P + P.T) / 2, data["q"].ravel(), lower=low[m:], upper=high[m:], **rows)
    return program, float(data["r"][0, 0])


def small(file):
    rows, n = next(shape for name, shape, _ in scipy.io.whosmat(file) if name == "A")
    return n <= LARGEST and rows - n <= LARGEST


def main(folder, seconds="60", *names):
    files = [Path(folder) / f"{name}.mat" for name in names]
    files = files or [file for file in sorted(Path(folder).glob("*.mat")) if small(file)]
    accurate, outcomes = 0, Counter()
    for file in files:
        program, constant = read(file)
        began = time.perf_counter()
        solution = lcp.solve(program, budget=Budget(seconds=float(seconds)))
        outcomes[solution.outcome.name] += 1
        accurate += solution.residual <= ACCURATE
        print(
            f"{file.stem:10} n = {program.n:3}, order {program.problem.n:3}: {solution.outcome.name:19} "
            f"{time.perf_counter() - began:6.2f} s, residual {solution.residual:.1e}, relative "
            f"{solution.relative_residual:.1e}, objective {solution.objective + constant:.9g}, "
            f"{solution.counts.factorizations} factorisations, {len(solution.paths)} paths", flush=True,
        )  # fmt: skip
    print(f"{len(files)} programs: {dict(outcomes)}, {accurate} at a natural residual of {ACCURATE}, absolute")


if __name__ == "__main__":
    main(*sys.argv[1:])
