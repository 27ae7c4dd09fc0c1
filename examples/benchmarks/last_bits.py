"""Answers must not depend on the last bits of a sum: the same runs under other kernels of OpenBLAS and in other orders.

    OPENBLAS_CORETYPE=Haswell python examples/benchmarks/last_bits.py FILE [--share 0.1] [--mixings 20]
    OPENBLAS_CORETYPE=Prescott python examples/benchmarks/last_bits.py FILE [--share 0.1] [--mixings 0]

The first writes its runs to a file, with which those of the second are compared. A run is a path (the acceptance
problems, the ten examples, paths through crossings) under a preset, a random LCP, or a scene. It is repeated with its
equations mixed by random rotations (a path) or its unknowns in another order (an LCP), which reorder all sums. Status,
number and kinds of events, the end, the events, and the number of factorisations (to a tenth) must agree.
"""

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from pathlib import Path as File
from typing import Any

import crossings
import numpy as np
from campaign import asked
from rescaled import dense
from scipy.stats import ortho_group

import continuation as ct
from continuation.arrays import Array
from problems import lcp, scenes

sys.path.insert(0, str(File(__file__).parents[2] / "tests" / "behaviour"))
record = import_module("record")

AGREED = 1e-8
"""Largest difference of events and ends of two runs of well-conditioned paths, over the largest number in the run."""


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
        return self.Q @ dense(H_y), self.Q @ np.asarray(H_lam)


def _path(homotopy: Any, seed: int | None, **options: Any) -> dict[str, Any]:
    path = ct.trace(homotopy if seed is None else Mixed(homotopy, seed), **options)
    # Kind by kind: an arm of a pitchfork turns in its branch point, and round-off decides which of the two comes first.
    events = sorted(path.events, key=lambda event: event.kind.name)
    points, names = [one.u.tolist() for one in (path.endpoint, *events)], [event.kind.name for event in events]
    return _run(path.status, points, path.counts, names)


def _run(status: Any, points: list[Any], counts: Any, events: Iterable[str] = ()) -> dict[str, Any]:
    work = getattr(counts, "factorizations", 0)
    return {"status": getattr(status, "name", ""), "points": points, "events": list(events), "factorizations": work}


def _solved(problem: Any, seed: int | None) -> dict[str, Any]:
    order = np.arange(problem.n) if seed is None else np.random.default_rng(seed).permutation(problem.n)
    same = problem if seed is None else lcp.LCP(problem.A[np.ix_(order, order)], problem.q[order])
    found = lcp.solve(same, restarts=3, budget=ct.Budget(steps=2000))
    return _run(found.outcome, [] if found.x is None else [found.x[np.argsort(order)].tolist()], found.counts)


def _scene(name: str) -> dict[str, Any]:
    scene = scenes.make(name)
    found = scenes.solve(scene)
    points = [np.ravel(value).astype(float).tolist() for value in scene.answer(found).values()]
    status = getattr(found, "outcome", None) or getattr(found, "status", "")
    return _run(status, points, getattr(found, "counts", None))


def runs(share: float) -> Iterator[tuple[str, Callable[[int | None], dict[str, Any]], bool]]:
    """Every run: its name, a function of the mixing, and whether it can be mixed."""
    for name, (make, options) in record.paths().items():
        for preset in record.PRESETS:
            yield f"{name} {preset.name}", lambda s, m=make, o=options, p=preset: _path(m(), s, preset=p, **o), True
    for family, cases in crossings.CAMPAIGN.families.items():
        for k, (problem, on_arm) in enumerate(cases(max(1, round(20 * share)), 35)):
            for preset in record.PRESETS:
                options = crossings.options(problem, on_arm, preset)
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
    if many > few * (1.0 + record.MARGIN) and many > few + record.FEW:
        said.append(f"factorizations {found['factorizations']}, {expected['factorizations']}")
    return said


def computed(share: float, mixings: int) -> dict[str, dict[str, Any]]:
    """All runs by name; mixed ones have " ~seed" behind it."""
    found = {}
    for name, run, mixable in runs(share):
        for seed in (None, *range(mixings if mixable else 0)):
            found[name if seed is None else f"{name} ~{seed}"] = run(seed)
    return found


def main() -> int:
    """Print each difference, and how many runs of each kind differ."""
    files, _, options = asked(share=0.1, mixings=3)
    here, kinds = computed(options.share, options.mixings), Counter[str]()
    before = json.loads(File(files[0]).read_text()) if files and File(files[0]).exists() else here
    if files and before is here:
        File(files[0]).write_text(json.dumps({name: run for name, run in here.items() if "~" not in name}))
    for name, one in here.items():
        for words in differences(one, before[name.split(" ~")[0]], not name.startswith("lcp")):
            kinds[words.split()[0]] += 1
            print(f"{name}: {words}")
    print(f"{len(here)} runs differ in {dict(kinds) or 'nothing'}")
    return int(bool(kinds))


if __name__ == "__main__":
    sys.exit(main())
