"""The parts that every combination is tried of, and an observer that keeps what it sees."""

import numpy as np

from continuation.controllers import AllgowerGeorg, Bounds, Fixed
from continuation.correctors import BorderedNewton, MoorePenrose
from continuation.metric import Euclidean, Relative, RootMeanSquare, Weighted
from continuation.predictors import Hermite, Tangent

PREDICTORS = [Tangent(), Hermite()]


CORRECTORS = [BorderedNewton(), BorderedNewton(reuse=0.0), MoorePenrose()]


CONTROLLERS = [
    Fixed(Bounds(initial=0.2)),
    Fixed(Bounds(minimum=1e-6, initial=0.25), max_angle=np.inf),
    AllgowerGeorg(),
]


METRICS = [None, Euclidean(), Relative(floor=0.1), RootMeanSquare(), Weighted(np.array([2.0]), 0.5)]


class Watcher:
    def __init__(self):
        self.seen = []
        self.states = []

    def step(self, tracer, step):
        self.seen.append(("step", step.index))
        self.states.append(tracer.state)

    def event(self, tracer, event):
        self.seen.append(("event", event.name))

    def end(self, tracer):
        self.seen.append(("end", tracer.path.status))
