"""For every check of the conformance suite there is a fault that it finds."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from attrs import define

import continuation
from continuation.testing import CheckFailure, homotopy_checks
from continuation.testing.suite import CHECKS

from .util import Interior, NoSolution, WrongSeries, interior


@pytest.mark.parametrize("check", homotopy_checks(Interior()), ids=str)
def test_the_checks_serve_parametrize(check):
    check()


def spoiling(self, y, lam):
    """It changes its argument."""
    value = Interior.residual(self, y, lam)
    y[1] += 1e-3
    return value


def drifting(self, y, lam):
    """Each residual is a little larger than the one before."""
    self.calls = getattr(self, "calls", 0) + 1
    return Interior.residual(self, y, lam) + 1e-13 * self.calls


def reusing(self, y, lam):
    """All matrices are one."""
    self.buffer[:] = [[y[1], y[0]], [1.0, -1.0]]
    return self.buffer, np.array([-1.0, 0.0])


def flipped(self, y, lam, border):
    """The determinant's sign is wrong."""
    system = Interior.bordered(self, y, lam, border)
    return SimpleNamespace(sign=-system.sign, solve=system.solve)


def plain(residual, y0):
    return continuation.from_functions(residual, start=([y0], 1.0), target=0.0)


class OneWay(Interior):
    """Where points of the path have come with a larger parameter four times, there is another path."""

    last, rises = 1.0, 0

    def start(self):
        self.last, self.rises = 1.0, 0
        return super().start()

    def residual(self, y, lam):
        value = super().residual(y, lam)
        if np.abs(value).max() < 1e-10:
            # By more than from a look within a short step back to its end.
            self.rises += lam > self.last + 0.05
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


class Bent:
    """|y| = lam, whose two pieces meet at 0; `tear` is a step between them, `wrong` an error of their derivatives."""

    target = 0.5

    def __init__(self, tear=0.0, wrong=0.0, watched=lambda y: y):
        self.tear, self.wrong, self.watched = tear, wrong, watched

    def start(self):
        return np.array([-1.0]), 1.0

    def residual(self, y, lam):
        return np.abs(y) - lam

    def switches(self, y, lam):
        return self.watched(y)

    def piece(self, signs):
        sign = float(signs[0])
        return continuation.from_functions(
            lambda y, lam: sign * y + self.tear - lam,
            lambda y, lam: (np.array([[sign * (1.0 + self.wrong)]]), -np.ones(1)),
            start=self.start(),
        )


INSIDE = np.array([0.5 + math.sqrt(1.25), -0.5 + math.sqrt(1.25)])
FAULTS = [
    (
        "repeatable",
        Bent(watched=lambda y: np.multiply(y, 1.5, out=y)),
        "switches: at the start it changes its argument",
    ),
    ("pieces", Bent(tear=1e-3), "piece: .* differs from the map: number 0 is .*, a difference of 0.001"),
    ("derivatives_of_pieces", Bent(wrong=1e-4), "is -1.0001, expected -1"),
    ("start", interior(start=None), "expected a method `start`, found none"),
    ("start", interior(start=lambda self: [1.0, 2.0, 3.0]), r"expected a tuple \(y0, lam0\), found list"),
    ("start", interior(start=lambda self: (np.full(2, np.nan), 1.0)), "expected finite numbers, found NaN"),
    ("start", interior(start=lambda self: 1 / 0), "it raises ZeroDivisionError"),
    ("repeatable", interior(own=INSIDE, start=lambda self: (self.own, 1.0)), "it returns its own array"),
    ("start", interior(residual=lambda self, y, lam: y[:1]), r"expected shape \(2,\), that of y0, found \(1,\)"),
    (
        "residual",
        interior(residual=lambda self, y, lam: y.astype(np.float32)),
        "at the start expected one finite number of float64 for each unknown, found",
    ),
    (
        "repeatable",
        interior(residual=spoiling),
        r"residual: at the start it changes its arguments: number 1 is .*, a difference of 0\.001",
    ),
    (
        "repeatable",
        interior(residual=drifting),
        "residual: at the start a second call .* differs from the first: number 0 is",
    ),
    (
        "repeatable",
        interior(jacobian=reusing, buffer=np.zeros((2, 2))),
        r"jacobian: .* an answer changes when the method is called again \(return new arrays\)",
    ),
    (
        "jacobian_types",
        interior(jacobian=lambda self, y, lam: [[1.0, 1.0], [1.0, -1.0]]),
        r"jacobian: at the start expected a tuple \(H_y, H_lam\), .* found \[\[1\.0",
    ),
    (
        "jacobian_types",
        interior(jacobian=lambda self, y, lam: (np.eye(2), np.ones((2, 1)))),
        r"of which H_lam has one number for each unknown, found \(array",
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
    ("bordered", interior(bordered=flipped), r"expected the determinant's sign [+-]1 or 0 .unknown., found [+-]?1"),
    (
        "bordered",
        interior(bordered=lambda *given: Interior.bordered(*given[:3], np.array([0.0, 0.0, 1.0]))),
        "the solution's equation 2 is .*, expected",
    ),
    ("start_on_path", NoSolution(), "START_NOT_ON_PATH: The start is not on the path"),
    (
        "start_on_path",
        plain(lambda y, lam: y**2 - (lam - 1.0) ** 2, 0.0),
        "SINGULAR_START: The Jacobian .* has no full rank at the start",
    ),
    (
        "metric",
        interior(metric=type("Flat", (), {"weights": lambda self, u, v, current: np.array([1.0, 0.0, 1.0])})()),
        "metric: at the start expected one positive finite weight for each component, found",
    ),
    ("max_step", interior(max_step=lambda self, u, v: 0.0), "it is 0, expected a positive number"),
    (
        "max_step",
        interior(max_step=lambda self, u, v: 0.9 * Interior.max_step(self, u, v)),
        r"after 0\.5 of .* what is left along 1 v, number 0 is .*, expected",
    ),
    (
        "max_step",
        interior(max_step=lambda self, u, v: float(np.linalg.norm(v)) * Interior.max_step(self, u, v)),
        "what is left along 2 v, number 0 is .*, expected",
    ),
    ("picklable", interior(), "picklable: .*PicklingError"),
    ("taylor", WrongSeries(), r"the residual along the series falls like h\^[23]\.?\d*, expected h\^7"),
    ("taylor", interior(taylor=lambda self, point, order: np.zeros((order, 3))), "shape at order 6 0 is 6, expected 7"),
    (
        "trace",
        plain(lambda y, lam: y - np.sqrt(lam - 0.5), math.sqrt(0.5)),
        "the path ended after .* steps, (LEFT_DOMAIN|STEP_TOO_SMALL)",
    ),
    ("reversal", OneWay(), "reversal: The retrace does not pass through step"),
    ("refinement", Ageing(drift=1e-3), r"refinement: The retrace does not pass through step \d+ \(arclength"),
    ("resume", Forgetful(), "resume: expected <Step"),
    ("resume", Ageing(), r"resume: (expected <Step|.* homotopy: expected the archive's residual)"),
]


@pytest.mark.parametrize(("name", "fault", "message"), FAULTS, ids=[name for name, _, _ in FAULTS])
def test_a_planted_fault_is_found(name, fault, message):
    check = next(check for check in homotopy_checks(fault) if str(check) == name)
    with pytest.raises(CheckFailure, match=message):
        check()


def test_there_is_a_fault_for_every_check():
    assert {name for name, _, _ in FAULTS} == {rule.name for rule in CHECKS}
