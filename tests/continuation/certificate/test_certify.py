"""Proofs of paths: complete where the path is one, refused where it is not, and checked again from a file."""

from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
from attrs import evolve

import continuation
from continuation import Budget, Path, Status, Step, certify, from_functions, refine, trace
from continuation.certificate import verify
from problems import paper
from problems.bifurcation import Aircraft, Bratu1D, Circle, Cusp, ExponentialCosine, FreudensteinRoth, Pitchfork
from problems.lcp import LCP, homotopies
from problems.lcp.data.problem import MixedLCP

from ...util import benchmark
from . import second
from .util import proved

corrupted, Rescaled = benchmark("corrupted.py"), benchmark("rescaled.py").Rescaled
EXAMPLES = [e for value in vars(paper).values() if isinstance(value, tuple) for e in value if hasattr(e, "true_class")]


def duffing(y, lam):
    a, b = y[0], y[1]
    stiffness = 1.0 - lam**2 + 0.75 * (a**2 + b**2)
    return np.stack([stiffness * a + 0.1 * lam * b - 0.3, stiffness * b - 0.1 * lam * a])


@pytest.mark.parametrize("k", range(10))
def test_the_ten_examples_are_proved_with_a_box_a_step(k):
    example = EXAMPLES[k]
    homotopy = homotopies.KKTHomotopy(example.problem, example.x0)
    path, proof = proved(homotopy)
    assert len(proof.turning_points) == len(path.turning_points)
    assert proof.boxes <= 1.3 * len(path)
    if k == 6:  # its end is singular: proved up to there, and the solution by rational arithmetic
        assert "rational" in proof.end
        assert 0.0 < proof.cells.end[-1, -1] <= 1.001e-6
    else:
        assert "exactly at lam = 0" in proof.end
        assert (proof.end_radius < 1e-9).all()


ACCEPTED = {
    "freudenstein-roth": (FreudensteinRoth(), 200),
    "cusp": (Cusp(), 200),
    "circle": (Circle(), 200),
    "aircraft": (Aircraft(), 60),
    "duffing": (from_functions(duffing, start=([0.3, 0.0], 0.1), target=2.5), 200),
    "bratu": (Bratu1D(16), 14),
    **{f"exponential-cosine-{n}": (ExponentialCosine(n), 200) for n in (2, 3, 4)},
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_a_path_is_proved_with_all_its_turning_points(name):
    homotopy, steps = ACCEPTED[name]
    path, proof = proved(homotopy, budget=Budget(steps=steps))
    assert len(proof.turning_points) == len(path.turning_points)
    assert all(
        begin - 0.02 <= turn.arclength <= end + 0.02
        for (begin, end), turn in zip(proof.turning_points, path.turning_points)
    )


def test_the_true_path_lies_in_the_tube():
    homotopy = FreudensteinRoth()
    path = trace(homotopy)
    middle = path.arclength[:-1] + 0.4 * np.diff(path.arclength)
    events = [
        evolve(path.events[0], name="a look", kind=0, u=refine(homotopy, path, float(s)), arclength=float(s), step=k)
        for k, s in enumerate(middle, 1)
    ]
    assert not certify(evolve(path, events=sorted([*path.events, *events], key=lambda e: e.arclength)), homotopy).gaps


@pytest.mark.parametrize("seed", range(3))
def test_units_do_not_matter(seed):
    """The same homotopy in other units of y, of the parameter and of the equations."""
    rng = np.random.default_rng(seed)
    for inner in (FreudensteinRoth(), ExponentialCosine(3)):
        n = inner.start()[0].size
        D, E = 2.0 ** rng.integers(-20, 20, (2, n))
        _, proof = proved(Rescaled(inner, D, np.zeros(n), E, 2.0 ** float(rng.integers(-20, 20)), 0.0))
        assert len(proof.turning_points) == len(trace(inner).turning_points)


# --- what is no path --------------------------------------------------------------------------------------


def test_no_corrupted_path_is_proved():
    """Fourteen of them; `corrupted.py` makes ten thousand."""
    assert corrupted.CAMPAIGN.run(14, 3) == 0


def test_a_branch_point_is_a_gap_with_its_reason():
    path = trace(Pitchfork(), events=[continuation.BranchPoint()])
    proof = certify(path, Pitchfork())
    assert not proof.complete
    assert any(gap.begin <= 0.0 + path.arclength[-1] and gap.reason for gap in proof.gaps)
    assert "Not proved from s" in str(proof)


def test_a_kink_is_crossed_by_one_lipschitz_curve():
    kink = from_functions(lambda y, lam: y - np.abs(lam) * (1.0 + 0.1 * y), start=([1.0], -1.0), target=1.0)
    steps = []
    for k, lam in enumerate([-1.0, -0.6, -0.3, -0.1, 0.1, 0.4, 1.0]):
        y, slope = abs(lam) / (1.0 - 0.1 * abs(lam)), np.sign(lam) / (1.0 - 0.1 * abs(lam)) ** 2
        steps.append(Step(k, np.array([y, lam]), np.array([slope, 1.0]), arclength=1.0 + lam))
    assert certify(Path(steps=steps, status=Status.REACHED_TARGET), kink).complete


def test_a_comparison_that_boxes_do_not_decide_is_a_gap_there_alone():
    def residual(y, lam):
        return np.stack([y[0] - np.where(lam > 0.3, np.sin(lam), np.sin(lam)), y[1] - 0.5])

    homotopy = from_functions(residual, start=([0.0, 0.5], 0.0), target=1.0)
    path = trace(homotopy)
    proof = certify(path, homotopy)
    ((begin, end),) = {(gap.begin, gap.end) for gap in proof.gaps}
    assert path(begin)[-1] < 0.3 < path(end)[-1]
    assert end - begin < 0.01 * path.arclength[-1]
    assert len(proof.cells) > len(path)


# --- the form of quadratic homotopies ---------------------------------------------------------------------

MATRIX = np.array([[2.0, -1.0, 0.3], [0.7, 1.0, -0.2], [0.1, 0.4, 3.0]])
PROBLEM = LCP(MATRIX, np.array([-1.0, 0.5, -2.0]))
BOXED = MixedLCP(MATRIX, np.array([-1.0, 0.5, -2.0]), lower=[0.0, -1.0, -np.inf], upper=[1.0, np.inf, 2.0])
FORMS = {
    "kkt": homotopies.KKTHomotopy(PROBLEM),
    **{
        name: getattr(homotopies, name)(PROBLEM)
        for name in ("YuHomotopy", "WangHomotopy", "XuHomotopy", "ZhaoHomotopy")
    },
    **{f"{name}-boxed": getattr(homotopies, name)(BOXED) for name in ("YuHomotopy", "WangHomotopy")},
    "kmm": homotopies.KojimaMegiddoMizunoHomotopy(PROBLEM),
    "kmm-boxed": homotopies.KojimaMegiddoMizunoHomotopy(BOXED),
    "kkt-boxed": homotopies.KKTHomotopy(BOXED),
    "kkt-free": homotopies.KKTHomotopy(
        MixedLCP(MATRIX, PROBLEM.q, lower=[0.0, -np.inf, -np.inf], upper=[1.0, np.inf, 2.0])
    ),
}


@pytest.mark.parametrize("name", FORMS)
def test_both_engines_prove_it(name):
    homotopy = FORMS[name]
    path = trace(homotopy)
    proof = certify(path, homotopy)
    capabilities = "target", "metric", "start", "residual", "bordered", "differential", "max_step"
    slow = certify(path, SimpleNamespace(**{name: getattr(homotopy, name) for name in capabilities}))
    assert proof.complete, str(proof)
    assert slow.complete or "exactly" not in proof.end, str(slow)
    assert len(slow.turning_points) == len(proof.turning_points)


SUBJECTS = {
    **ACCEPTED,
    **{name: (homotopy, 200) for name, homotopy in FORMS.items()},
    **{f"example-{k + 1}": (homotopies.KKTHomotopy(e.problem, e.x0), 200) for k, e in enumerate(EXAMPLES)},
}


@pytest.mark.skipif(not find_spec("flint"), reason="python-flint is not installed (make nightly)")
@pytest.mark.parametrize("name", SUBJECTS)
def test_python_flint_confirms_every_tube(name):
    homotopy, steps = SUBJECTS[name]
    proof = certify(trace(homotopy, budget=Budget(steps=steps)), homotopy)
    assert all(second.confirmed(homotopy.residual, proof.cells))
    thin = proof.cells.with_tubes(1e-9 * proof.cells.radius, proof.cells.slabs).take(slice(0, 3))
    assert not any(second.confirmed(homotopy.residual, thin))


# --- the door ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("homotopy", "points", "words"),
    [
        (FreudensteinRoth(), 1, "at least two points, found 1"),
        (ExponentialCosine(5), None, "expected points of"),
        (from_functions(lambda y, lam: np.sort(y) - lam, start=(np.zeros(2), 0.0), target=1.0), None, r"numpy\.sort"),
    ],
)
def test_bad_input_is_named(homotopy, points, words):
    with pytest.raises((TypeError, ValueError), match=words):
        certify(Path(steps=trace(FreudensteinRoth()).steps[:points]), homotopy)


def test_a_picture_and_the_radius():
    path = trace(FreudensteinRoth())
    proof = certify(path, FreudensteinRoth())
    axes = proof.plot()
    assert axes.get_title() == "complete"
    assert (proof.radius(1.0) > 0.0).all()
    assert np.isnan(proof.radius(1e9)).all()
    assert "Proved" in repr(proof)


def test_an_event_that_is_not_on_the_curve_is_a_gap_however_wide_the_tube():
    # The tubes of the cusp are wide: a turning point moved within one was proved to be there.
    path = continuation.trace(Cusp())
    for k, event in enumerate(path.events):
        for way in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (1.0, -1.0)]:
            events = list(path.events)
            events[k] = evolve(event, u=event.u + 0.02 * np.array(way) * np.ptp(path.u, axis=0))
            assert not continuation.certify(Path(steps=path.steps, events=events, status=path.status), Cusp()).complete


def test_a_start_that_is_not_on_the_curve_is_a_gap_however_wide_its_tube():
    # Two of 10,000 corrupted paths were proved: between the moved start and the next point is room for one curve.
    sheets, lemke = benchmark("subjects.py").two_sheets(5.1e-4), corrupted.subjects(0)[5][0]
    for homotopy, off in ((sheets, [0.0173, 0.0173]), (lemke, [-0.068, 0.025, -0.025, -0.068])):
        path = trace(homotopy)
        first, *others = path.steps
        proof = certify(evolve(path, steps=[evolve(first, u=first.u + off), *others]), homotopy)
        # The moved start may be so far off that no point of the curve is found beside it, too.
        assert proof.gaps[0].reason == verify.OFF_CURVE
        assert certify(path, homotopy).complete
