"""The conformance suite: a right homotopy passes all of it, and for every check there is a fault that it finds."""

import math

import numpy as np
import pytest
from attrs import define

import continuation
from continuation.linear import factor_bordered
from continuation.metric import Relative
from continuation.testing import CheckFailure, check_homotopy, homotopy_checks, run_checks
from continuation.testing.suite import RULES

REFERENCE = "@misc{Nobody2026,\n  title = {On products and differences},\n}"


class Interior:
    """y1 y2 = lam, y1 - y2 = 1 from lam = 1 to lam = 0 through y > 0, with every capability there is."""

    target = 0.0
    metric = Relative()
    references = (REFERENCE,)
    events = (continuation.Monitor(lambda u, v: float(u[0] - 1.5), "y1 = 1.5"),)

    def start(self):
        return np.array([0.5 + math.sqrt(1.25), -0.5 + math.sqrt(1.25)]), 1.0

    def residual(self, y, lam):
        return np.stack([y[0] * y[1] - lam, y[0] - y[1] - 1.0 + 0.0 * lam])

    def jacobian(self, y, lam):
        return np.array([[y[1], y[0]], [1.0, -1.0]]), np.array([-1.0, 0.0])

    def differential(self, y, lam, v):
        H_y, H_lam = self.jacobian(y, lam)
        return H_y @ v[:-1] + H_lam * v[-1]

    def bordered(self, y, lam, border):
        return factor_bordered(*self.jacobian(y, lam), border)

    def taylor(self, point, order):
        c = np.zeros((order + 1, 3))
        c[0], c[1] = point.u, point.tangent
        for k in range(2, order + 1):
            c[k] = point.solve(np.array([-float(c[1:k, 0] @ c[k - 1 : 0 : -1, 1]), 0.0]))
        return c

    def max_step(self, u, v):
        falling = v[:2] < 0.0
        return float((u[:2][falling] / -v[:2][falling]).min()) if falling.any() else math.inf

    def observe(self, y, lam):
        return {"gap": float(y[0] * y[1])}

    def finish(self, y, lam):
        return None


CAPABILITIES = {rule.capability for rule in RULES} - {""}


def test_a_right_homotopy_passes_every_check():
    results = check_homotopy(Interior())
    assert [result.name for result in results] == [rule.name for rule in RULES]
    assert {result.outcome for result in results} == {"passed"}


@pytest.mark.parametrize("check", homotopy_checks(Interior()), ids=str)
def test_the_checks_serve_parametrize(check):
    check()


# -- planted faults -------------------------------------------------------------------------------------------


def interior(**methods):
    """An `Interior` with methods replaced: the class is made anew, so that pickle and archive cannot name it."""
    return type("Faulty", (Interior,), methods)()


class OwnArray(Interior):
    Y0 = np.array([0.5 + math.sqrt(1.25), -0.5 + math.sqrt(1.25)])

    def start(self):
        return self.Y0, 1.0


class Spoiling(Interior):
    def residual(self, y, lam):
        value = super().residual(y, lam)
        y[1] += 1e-3
        return value


class Drifting(Interior):
    """Each residual a little larger than the one before."""

    calls = 0

    def residual(self, y, lam):
        self.calls += 1
        return super().residual(y, lam) + 1e-13 * self.calls


class Reusing(Interior):
    BUFFER = np.zeros((2, 2))

    def jacobian(self, y, lam):
        self.BUFFER[:] = [[y[1], y[0]], [1.0, -1.0]]
        return self.BUFFER, np.array([-1.0, 0.0])


class Flipped(Interior):
    def bordered(self, y, lam, border):
        system = super().bordered(y, lam, border)

        class Wrong:
            sign = -1.0 * system.sign
            solve = staticmethod(system.solve)

        return Wrong()


class Deaf(Interior):
    """Solves with one and the same border."""

    def bordered(self, y, lam, border):
        return super().bordered(y, lam, np.array([0.0, 0.0, 1.0]))


class NoSolution:
    """y^2 + lam^2 + 1 = 0."""

    def start(self):
        return np.array([0.3]), 1.0

    def residual(self, y, lam):
        return y**2 + lam**2 + 1.0


class Double(NoSolution):
    """y^2 = (lam - 1)^2, at the crossing."""

    def start(self):
        return np.array([0.0]), 1.0

    def residual(self, y, lam):
        return y**2 - (lam - 1.0) ** 2


class Wandering(Interior):
    def observe(self, y, lam):
        return {"gap": 0.0} if lam == 1.0 else {"distance": 0.0}


class WrongSeries(Interior):
    def taylor(self, point, order):
        c = super().taylor(point, order)
        c[3] *= 1.01
        return c


class WrongSeriesWithoutJets(WrongSeries):
    def residual(self, y, lam):
        # `float` is beyond jets, so that the order of the residual along the series has to tell.
        return np.array([float(y[0]) * float(y[1]) - float(lam), float(y[0]) - float(y[1]) - 1.0])


class Unreachable:
    """y = sqrt(lam - 1/2), asked for at lam = 0."""

    def start(self):
        return np.array([math.sqrt(0.5)]), 1.0

    def residual(self, y, lam):
        return y - np.sqrt(lam - 0.5)


class OneWay(Interior):
    """Where points of the path have come with a larger parameter four times, there is another path."""

    last, rises = 1.0, 0

    def start(self):
        self.last, self.rises = 1.0, 0
        return super().start()

    def residual(self, y, lam):
        value = super().residual(y, lam)
        if np.abs(value).max() < 1e-10:
            self.rises += lam > self.last + 1e-3
            self.last = lam
        return value + (1e-2 if self.rises >= 4 else 0.0)


@define
class Forgetful:
    """The archive keeps its slope without the factor."""

    slope: float = 2.0

    def start(self):
        return np.zeros(1), 1.0

    def residual(self, y, lam):
        return y - self.slope * (1.0 - lam)

    def archive_data(self):
        return {"slope": 1.0}

    @classmethod
    def from_archive(cls, data):
        return cls(**data)


@define
class Ageing(Forgetful):
    """What it answers depends on how often its start has been asked for."""

    drift: float = 1e-6
    starts: int = 0

    def start(self):
        self.starts += 1
        return super().start()

    def residual(self, y, lam):
        return y - (self.slope + self.drift * self.starts) * (1.0 - lam)


FAULTS = [
    ("start", interior(start=None), "expected a method `start`, found none"),
    ("start", interior(start=lambda self: [1.0, 2.0, 3.0]), r"expected a tuple \(y0, lam0\), found list"),
    ("start", interior(start=lambda self: (np.full(2, np.nan), 1.0)), "expected finite numbers, found NaN"),
    ("start", interior(start=lambda self: 1 / 0), "it raises ZeroDivisionError"),
    ("repeatable", OwnArray(), "it returns its own array"),
    ("start", interior(residual=lambda self, y, lam: y[:1]), r"expected shape \(2,\), that of y0, found \(1,\)"),
    ("residual", interior(residual=lambda self, y, lam: y.astype(np.float32)), "at the start expected float64, found"),
    ("inputs_not_modified", Spoiling(), r"residual: at the start it changes its argument number 1, by up to 0\.001"),
    ("repeatable", Drifting(), "residual: at the start a second call .* differs from the first, by up to"),
    ("repeatable", Reusing(), "jacobian: .* an answer changes when the method is called again: return new arrays"),
    ("target", interior(target="zero"), "expected a finite number or None, found 'zero'"),
    ("target", interior(target=math.inf), "expected a finite number or None, found inf"),
    (
        "jacobian_types",
        interior(jacobian=lambda self, y, lam: [[1.0, 1.0], [1.0, -1.0]]),
        r"jacobian: at the start expected a tuple \(H_y, H_lam\), found list",
    ),
    (
        "jacobian_types",
        interior(jacobian=lambda self, y, lam: (np.eye(2), np.ones((2, 1)))),
        r"expected H_lam of shape \(2,\), found \(2, 1\)",
    ),
    ("jacobian_types", interior(jacobian=lambda self, y, lam: (np.eye(3), np.ones(2))), r"shapes \(3, 3\)"),
    (
        "jacobian",
        interior(jacobian=lambda self, y, lam: (np.array([[y[1], y[0]], [1.0, -1.0]]), np.array([1.0, 0.0]))),
        r"H_lam\[0\] is 1, expected -1 \(by jets\), at the start",
    ),
    (
        "jacobian",
        interior(jacobian=lambda self, y, lam: (np.array([[y[1], 1.01 * y[0]], [1.0, -1.0]]), np.array([-1.0, 0.0]))),
        r"H_y\[0, 1\] is 1\.634.*, expected 1\.618",
    ),
    (
        "differential",
        interior(differential=lambda self, y, lam, v: self.jacobian(y, lam)[0] @ v[:-1]),
        "differential: at the start component 0 is .*, expected .*, a difference of",
    ),
    ("bordered", Flipped(), r"the sign is [+-]1, but the determinant is"),
    ("bordered", Deaf(), r"the solution misses the border's equation by .*, relative .*, expected at most 1e-08"),
    ("start_on_path", NoSolution(), "START_NOT_ON_PATH: The start is not on the path"),
    ("start_on_path", Double(), "SINGULAR_START: The Jacobian .* has no full rank at the start"),
    (
        "metric",
        interior(metric=type("Flat", (), {"weights": lambda self, u, v, current: np.array([1.0, 0.0, 1.0])})()),
        "metric: at the start weight 1 is 0.0, expected a positive finite number",
    ),
    ("max_step_positive", interior(max_step=lambda self, u, v: 0.0), "it is 0, expected a positive number"),
    ("max_step_positive", interior(max_step=lambda self, u, v: 1.0), "it is 1 along v = 0, expected inf"),
    (
        "max_step_sharp",
        interior(max_step=lambda self, u, v: 0.9 * Interior.max_step(self, u, v)),
        r"after 0\.5 of that .* should be left, found",
    ),
    (
        "max_step_sharp",
        interior(max_step=lambda self, u, v: float(np.linalg.norm(v)) * Interior.max_step(self, u, v)),
        "along v and .* along 2 v, expected half",
    ),
    ("observe", Wandering(), r"beside the start the names are \['distance'\], at the start \['gap'\]"),
    ("observe", interior(observe=lambda self, y, lam: {"gap": "small"}), "expected names and real numbers"),
    ("finish", interior(finish=lambda self, y, lam: y[:1]), "expected None or 2 finite numbers"),
    ("events", interior(events=(object(),)), "expected `name` on"),
    (
        "events",
        interior(events=(continuation.Monitor(lambda u, v: math.nan, "nowhere"),)),
        "the monitor of 'nowhere' is nan",
    ),
    ("references", interior(references=("Nobody, On products, 2026",)), "number 0 is no BibTeX entry"),
    ("references", interior(references=REFERENCE), "expected a sequence of BibTeX entries, found one string"),
    ("picklable", interior(), "picklable: .*PicklingError"),
    ("taylor", WrongSeries(), "coefficient 3, component 0 is .*, expected .*, a difference of"),
    ("taylor", WrongSeriesWithoutJets(), r"the residual along the series falls like h\^[23]\.?\d*, expected h\^7"),
    ("taylor", interior(taylor=lambda self, point, order: np.zeros((order, 3))), r"expected shape \(7, 3\)"),
    ("trace", Unreachable(), "the path ended after .* steps, (LEFT_DOMAIN|STEP_TOO_SMALL)"),
    ("refinement", Ageing(drift=1e-3), r"step refinement: The retrace does not pass through step \d+ \(arclength"),
    ("reversal", OneWay(), "reversal: The retrace does not pass through step"),
    ("archive", Forgetful(), "at the start the homotopy read back has another residual|read back has another residual"),
    ("resume", Ageing(), r"resume: (step \d+ .* differs by|homotopy: expected the archive's residual)"),
]


@pytest.mark.parametrize(("name", "fault", "message"), FAULTS, ids=[name for name, _, _ in FAULTS])
def test_a_planted_fault_is_found(name, fault, message):
    check = next(check for check in homotopy_checks(fault) if str(check) == name)
    with pytest.raises(CheckFailure, match=message):
        check()


def test_there_is_a_fault_for_every_check():
    assert {name for name, _, _ in FAULTS} == {rule.name for rule in RULES}


# -- the whole suite ------------------------------------------------------------------------------------------


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(CheckFailure) as caught:
        check_homotopy(WrongSeries())
    first, *others = str(caught.value).splitlines()
    assert first == f"WrongSeries fails 1 of {len(RULES)} checks:"
    assert others[0].startswith("  taylor: at the start coefficient 3")


def test_only_the_capabilities_that_are_there_are_checked():
    names = [str(check) for check in homotopy_checks(NoSolution())]
    assert "jacobian" not in names
    assert "target" not in names
    assert CAPABILITIES.isdisjoint(names)


def test_nothing_is_called_while_the_checks_are_collected():
    def explode(*arguments):
        raise AssertionError("called")

    faulty = interior(start=explode, residual=explode)
    assert len(homotopy_checks(faulty)) == len(RULES)


def test_what_depends_on_a_failed_check_is_not_run():
    results = {result.name: result for result in run_checks(interior(start=None))}
    assert results.pop("start").outcome == "failed"
    assert {result.outcome for result in results.values()} == {"not run"}
    assert results["residual"].message == "it needs start, which did not pass"


def test_a_failure_may_be_expected_with_its_reason():
    results = check_homotopy(WrongSeries(), expected_failed_checks={"taylor": "known, issue 12"})
    outcome = next(result for result in results if result.name == "taylor")
    assert outcome.outcome == "failed as expected"
    assert outcome.message.endswith("(known, issue 12)")


def test_a_failure_that_does_not_come_is_reported():
    with pytest.raises(CheckFailure, match=r"taylor: expected to fail .* but it passes: take it off the list"):
        check_homotopy(Interior(), expected_failed_checks={"taylor": "known"})


def test_a_check_that_does_not_exist_cannot_be_expected_to_fail():
    with pytest.raises(ValueError, match=r"expected_failed_checks: expected names among .*, found 'tailor'"):
        check_homotopy(Interior(), expected_failed_checks={"tailor": "typing"})


@pytest.mark.parametrize(("steps", "few"), [(2, True), (None, False)])
def test_fewer_steps_are_looked_at_when_asked(steps, few):
    seen = set()

    class Watched(Interior):
        def observe(self, y, lam):
            seen.add(lam)
            return super().observe(y, lam)

    next(check for check in homotopy_checks(Watched(), steps=steps) if str(check) == "trace")()
    # A path is traced once to see how long it is, and once with short steps.
    assert (len(seen) <= 6) is few
