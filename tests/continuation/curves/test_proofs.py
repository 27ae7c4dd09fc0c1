"""Curves that are proved by their equations written out: folds, Hopf points, and what looks at the tangent."""

import os
import subprocess
import sys
from functools import partial
from importlib.util import find_spec

import numpy as np
import pytest
from attrs import evolve

import continuation
from continuation import Curve, Family, Kind, Monitor, TargetValue, TurningPoint, certify
from continuation.archive import recheck

from ..certificate import second
from .util import (
    Lorenz,
    brusselator,
    cusp_form,
    first_fold,
    gelfand,
    imperfect,
    named,
    ring,
    steep,
    takens_bogdanov,
    van_der_pol,
    wing,
)


def folds(family, mu, **options):
    return Curve(family, first_fold(family(mu), **options), mu=mu)


PART = {"lam": (-1.0, 1.0)}
small = partial(gelfand, n=4)
CASES = {
    "a cusp": (folds(cusp_form, 1.0), {"lam": (-4.0, 4.0), "y": (-16.0, 16.0)}, 1),
    "a slab that heats itself": (folds(small, 0.2), {"lam": (0.0, None), "y": (None, 12.0)}, 1),
    "folds that stand still": (folds(takens_bogdanov, 1.0), {"lam": (-2.0, 2.0)}, 0),
    "Hopf points where nothing moves but mu": (
        Curve(van_der_pol, Kind.HOPF, (np.zeros(2), 0.05), mu=1.0), {"lam": (0.5, 1.5)}, 0,
    ),
    "Hopf points": (Curve(brusselator, Kind.HOPF, (np.array([1.0, 2.0]), 2.0), mu=1.0), {"lam": (0.5, 3.0)}, 0),
    "Lorenz": (Curve(Family(Lorenz(), "b"), Kind.HOPF, wing(24.0)), {"lam": (2.0, 8.0)}, 0),
    "an unknown turns": (
        Curve(ring, TurningPoint(1), (np.array([0.7, 0.5]), 0.6), mu=1.0), {"lam": (0.2, 5.0)}, 0,
    ),
    "a value": (Curve(imperfect, TargetValue(1.5), (np.array([1.2]), 1.5), mu=-0.07), {**PART, "y": (-5.0, 5.0)}, 2),
    "a slope": (Curve(imperfect, Monitor(steep), (np.array([-1.2]), 1.4), mu=0.1), {"lam": (0.05, 1.0)}, 0),
}  # fmt: skip


def proved(name):
    curve, box, turning = CASES[name]
    path = continuation.trace_both(curve, box=box)
    return curve, path, certify(path, curve), turning


@pytest.mark.parametrize("name", CASES)
def test_the_whole_curve_is_proved_and_what_is_changed_is_not(name):
    curve, path, proof, turning = proved(name)
    assert proof.complete, proof
    assert len(proof.turning_points) == turning
    width = path.u.shape[1]
    assert proof.node_radius.shape[1] == len(proof.radius(0.0)) == width
    # Where much stands still, one moved point moves all of it, and every cell fails at every depth: a part only.
    k, extent = len(path) // 2, np.maximum(np.ptp(path.u, axis=0), 1.0)
    part = path if turning else evolve(path, steps=list(path.steps)[k - 1 : k + 2], events=[])
    assert turning or certify(part, curve).complete
    steps, k = list(part.steps), len(part) // 2
    steps[k] = evolve(steps[k], u=steps[k].u + 2.0 * proof.radius(steps[k].arclength) + 1e-3 * extent)
    assert not certify(evolve(part, steps=steps), curve).complete
    if turning:
        unlisted = [event for event in path.events if event.name != "turning point"]
        assert not certify(evolve(path, events=unlisted), curve).complete
    if find_spec("flint"):
        assert all(second.confirmed(curve.written_out(path.u).residual, proof.cells))


def test_what_is_proved_is_that_curve():
    curve, path, proof, _ = proved("a cusp")
    # The exact folds: y = t, mu = 3 t^2, lam = -2 t^3.
    for s, (y, _, _) in zip(path.arclength, path.u):
        for t in (y, y + 0.5 * proof.radius(s)[0]):
            off = np.abs(np.array([t, -2.0 * t**3, 3.0 * t**2]) - path(s))
            assert (off <= 20.0 * proof.radius(s) + 1e-9).all()
    # That of another family is not, with the same points or with the same tubes.
    other = Curve(lambda mu: cusp_form(1.001 * mu), Kind.TURNING_POINT, curve.at, mu=1.0)
    assert not certify(path, other).complete


def test_a_hopf_curve_is_proved_up_to_where_it_meets_the_folds():
    curve = Curve(takens_bogdanov, Kind.HOPF, (np.array([-1.0, 0.0]), -1.0), mu=1.0)
    path = continuation.trace_both(curve, box={"lam": (-3.0, 3.0)})
    (end,) = named(path, "Bogdanov-Takens")
    proof = certify(path, curve)
    assert not proof.complete
    assert max(gap.end for gap in proof.gaps) <= end.arclength + 0.01 * path.arclength[-1]


def test_an_archive_holds_the_proof(tmp_path):
    for name in ("a cusp", "Hopf points"):
        curve, box, _ = CASES[name]
        file = tmp_path / f"{name}.h5"
        path = continuation.trace(curve, box=box, certified=True, archive=file)
        assert path.proof.complete
        (again,) = recheck(file, curve)
        assert again.complete
        assert again.node_radius.shape == path.proof.node_radius.shape
        # Its tubes are wider than those of a path of the same width that has nothing in front.
        (foreign,) = recheck(file, continuation.from_functions(lambda y, lam: y, start=curve.start()))
        assert "components" in str(foreign)
        path.proof.plot(0)


def test_what_is_proved_is_what_is_recorded_with_threads_too(tmp_path):
    """The trace that is proved and the one that is recorded run in two functions, each on one thread of BLAS."""
    program = f"""
from tests.continuation.curves.test_proofs import CASES
import continuation
from continuation.archive import recheck
curve, box, _ = CASES["Hopf points"]
path = continuation.trace(curve, box=box, certified=True, archive={str(tmp_path / "hopf.h5")!r})
assert path.proof.complete and recheck({str(tmp_path / "hopf.h5")!r}, curve)[0].complete
"""
    chosen = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
    environment = {name: value for name, value in os.environ.items() if name not in chosen}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
