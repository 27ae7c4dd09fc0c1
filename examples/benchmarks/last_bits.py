"""Answers must not depend on the last bits of a sum: the same runs under other kernels of OpenBLAS and in other orders.

python examples/benchmarks/last_bits.py [--share 0.1] [--mixings 20] [--kernels Prescott,Haswell,SkylakeX]

A run is a path (the acceptance problems, the ten examples, paths through crossings) under a preset, a random LCP, or
a scene. It is repeated under each kernel, and with its equations mixed by random rotations (a path) or its unknowns in
another order (an LCP), which reorder all sums. What must agree: status, number and kinds of events, the end and the
events, and the number of factorisations to a tenth.
"""

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path as File
from typing import Any

import crossings
import numpy as np
import scipy.sparse as sp
from scipy.stats import ortho_group

import continuation as ct
from continuation.arrays import Array
from continuation.linear import Banded, Symmetric
from problems import lcp, scenes

sys.path.insert(0, str(File(__file__).parents[2] / "tests" / "behaviour"))
record = import_module("record")

PRESETS = record.PRESETS
AGREED = 1e-8
"""Of the largest number in the run: what two runs of well-conditioned paths may differ by at events and ends."""
MORE, FEW = 0.1, 3
"""By how much factorisations may differ: a tenth, or so few of them."""


class Mixed:
    """A homotopy whose equations are Q H: the same curve, every sum in another order; its own structure is hidden."""

    HIDDEN = ("bordered", "differential", "taylor", "piece", "switches")

    def __init__(self, homotopy: Any, seed: int) -> None:
        self.homotopy = homotopy
        n = np.size(homotopy.start()[0])
        self.Q: Array = np.eye(1) if n == 1 else ortho_group.rvs(n, random_state=np.random.default_rng(seed))
        if np.linalg.det(self.Q) < 0.0:
            self.Q[0] *= -1.0

    def __getattr__(self, name: str) -> Any:
        if name in self.HIDDEN:
            raise AttributeError(name)
        return getattr(self.homotopy, name)

    def residual(self, y: Array, lam: float) -> Any:
        """Q H."""
        return self.Q @ self.homotopy.residual(y, lam)

    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """Q H', dense."""
        H_y, H_lam = self.homotopy.jacobian(y, lam)
        if isinstance(H_y, Symmetric):
            H_y = H_y.matrix
        if isinstance(H_y, Banded):
            H_y = H_y.tosparse()
        dense = H_y.toarray() if sp.issparse(H_y) else np.asarray(H_y)
        return self.Q @ dense, self.Q @ np.asarray(H_lam)


def _path(homotopy: Any, seed: int | None, **options: Any) -> dict[str, Any]:
    path = ct.trace(homotopy if seed is None else Mixed(homotopy, seed), **options)
    # Kind by kind: an arm of a pitchfork turns in its branch point, and round-off decides which of the two comes first.
    events = sorted(path.events, key=lambda event: event.kind.name)
    return {
        "status": path.status.name,
        "points": [path.endpoint.u.tolist(), *[event.u.tolist() for event in events]],
        "events": [event.kind.name for event in events],
        "factorizations": path.counts.factorizations,
    }


def _solved(problem: Any, seed: int | None) -> dict[str, Any]:
    order = np.arange(problem.n) if seed is None else np.random.default_rng(seed).permutation(problem.n)
    same = problem if seed is None else lcp.LCP(problem.A[np.ix_(order, order)], problem.q[order])
    found = lcp.solve(same, restarts=3, budget=ct.Budget(steps=2000))
    x = None if found.x is None else np.empty(problem.n)
    if x is not None:
        x[order] = found.x
    return {
        "status": found.outcome.name,
        "points": [] if x is None else [x.tolist()],
        "events": [],
        "factorizations": found.counts.factorizations,
    }


def _scene(name: str) -> dict[str, Any]:
    scene = scenes.make(name)
    found = scenes.solve(scene)
    answer = {key: np.ravel(value).astype(float).tolist() for key, value in scene.answer(found).items()}
    return {
        "status": str(getattr(getattr(found, "outcome", None) or getattr(found, "status", ""), "name", "")),
        "points": list(answer.values()),
        "events": [],
        "factorizations": getattr(getattr(found, "counts", None), "factorizations", 0),
    }


def runs(share: float) -> Iterator[tuple[str, Callable[[int | None], dict[str, Any]], bool]]:
    """Every run: its name, what makes it of a mixing, and whether it can be mixed."""
    for name, (make, options) in record.paths().items():
        for preset in PRESETS:
            yield f"{name} {preset.name}", lambda s, m=make, o=options, p=preset: _path(m(), s, preset=p, **o), True
    for family in crossings.FAMILIES:
        for k, problem in enumerate(crossings.drawn(family, max(1, round(20 * share)), 35)):
            arm = family == "arm"
            for preset in PRESETS:
                trunk = problem.point(0.0, problem.curve(0.0)[1] - 2.0)[1] if arm else 0.0
                stop = {"target": None, "direction": -1, "events": [crossings._on(problem), ct.TargetValue(trunk)]}
                options = {"preset": preset, "budget": ct.Budget(steps=1000)} | (stop if arm else {})
                yield f"{family} {k} {preset.name}", lambda s, h=problem, o=options: _path(h, s, **o), True
    for k in range(round(2000 * share)):
        yield f"lcp {k}", lambda s, k=k: _solved(record.problem(k), s), True
    for name in scenes.available():
        yield f"scene {name}", lambda s, name=name: _scene(name), False


def differences(found: dict[str, Any], expected: dict[str, Any], unique: bool) -> list[str]:
    """In what two runs differ; an LCP may have several solutions, of which another one may be found."""
    said = []
    if found["status"] != expected["status"]:
        said.append(f"status {found['status']}, {expected['status']}")
    if found["events"] != expected["events"]:
        said.append(f"events {found['events']}, {expected['events']}")
    elif unique:
        pairs = list(zip(found["points"], expected["points"]))
        size = max((abs(value) for _, point in pairs for value in point), default=0.0)
        far = max((float(np.max(np.abs(np.subtract(a, b)), initial=0.0)) for a, b in pairs), default=0.0)
        if not far <= AGREED * size:
            said.append(f"points {far:.1e} apart, numbers up to {size:.1e}")
    few, many = sorted((found["factorizations"], expected["factorizations"]))
    if many > few * (1.0 + MORE) and many > few + FEW:
        said.append(f"factorizations {found['factorizations']}, {expected['factorizations']}")
    return said


def computed(share: float, mixings: int) -> dict[str, dict[str, Any]]:
    """All runs of this process by name; mixed ones have " ~seed" behind it."""
    found = {}
    for name, run, mixable in runs(share):
        for seed in (None, *range(mixings if mixable else 0)):
            found[name if seed is None else f"{name} ~{seed}"] = run(seed)
    return found


def main() -> int:
    """Print each difference, and a table: runs and differences of each kind by surrounding."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--share", type=float, default=0.1, help="of 20 crossings of a family and 2,000 LCPs")
    parser.add_argument("--mixings", type=int, default=3)
    parser.add_argument("--kernels", default="Prescott,Sandybridge,Haswell,SkylakeX")
    parser.add_argument("--print", action="store_true", help="only print this process's runs as JSON")
    options = parser.parse_args()
    if options.print:
        print(json.dumps(computed(options.share, options.mixings)))
        return 0
    here = computed(options.share, options.mixings)
    table = {"mixed": ({k: v for k, v in here.items() if "~" in k}, Counter[str]())}
    for kernel in options.kernels.split(","):
        command = [sys.executable, __file__, "--print", "--share", str(options.share), "--mixings", "0"]
        environment = {**os.environ, "OPENBLAS_CORETYPE": kernel}
        output = subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout
        table[kernel] = (json.loads(output), Counter())
    for surrounding, (found, kinds) in table.items():
        for name, one in found.items():
            for words in differences(one, here[name.split(" ~")[0]], not name.startswith("lcp")):
                kinds[words.split()[0]] += 1
                print(f"{surrounding}: {name}: {words}")
    print("surrounding | runs | differ in")
    for surrounding, (found, kinds) in table.items():
        print(f"{surrounding} | {len(found)} | {dict(kinds) or 'nothing'}")
    return int(any(kinds for _, kinds in table.values()))


if __name__ == "__main__":
    sys.exit(main())
