"""Presets: named choices of predictor, corrector and controller."""

from __future__ import annotations

from attrs import frozen

from continuation.controllers import AllgowerGeorg, Controller, SeriesRange
from continuation.correctors import BorderedNewton, Corrector
from continuation.predictors import Hermite, Predictor, Taylor


@frozen
class Preset:
    """Predictor, corrector and controller."""

    name: str
    trade: str
    predictor: Predictor
    corrector: Corrector
    controller: Controller


FAST = Preset(
    "FAST",
    "steps that aim at a turn of 26 degrees and one factorisation for several increments; for smooth paths: an S-bend "
    "of less than a thousandth of the path may lie inside a step (0 of 3,000 from 0.001, 44 of 180 at 0.0001)",
    Hermite(),
    BorderedNewton(reuse=0.5),
    AllgowerGeorg(contraction=0.5, distance=0.2, angle=0.45, deceleration=2.0),
)
DEFAULT = Preset(
    "DEFAULT",
    "steps that aim at a turn of 20 degrees; follows the paths on which other tracers jump",
    Hermite(),
    BorderedNewton(reuse=0.2),
    AllgowerGeorg(contraction=0.3, distance=0.3, angle=0.35, deceleration=2.0, acceleration=3.0),
)
CONSERVATIVE = Preset(
    "CONSERVATIVE",
    "short steps, a factorisation for every increment: five times the work of DEFAULT; for paths close to others",
    Hermite(),
    BorderedNewton(reuse=0.0),
    AllgowerGeorg(contraction=0.1, distance=0.012, angle=0.12, deceleration=1.3),
)

SERIES = Preset(
    "SERIES",
    "one factorisation a step and as many solves as the order; for paths whose factorisations are what costs",
    Taylor(rational=True),
    BorderedNewton(reuse=0.2),
    SeriesRange(),
)
