"""Small problems in closed form, and a method that fails."""

import numpy as np

from continuation import chart
from problems.bifurcation import ExponentialCosine
from problems.bifurcation.truth import exponential_cosine


def cosine(n):
    truth = chart.Truth(
        end=exponential_cosine.curve(n, np.array(exponential_cosine.end(n))),
        turning_points=exponential_cosine.turning_points(n),
        arclength=exponential_cosine.arclength(n),
        nearest=lambda u: exponential_cosine.curve(n, u[:, :-1].sum(axis=1)),
    )
    return chart.Problem(f"cosine {n}", ExponentialCosine(n), truth, family="cosine")


def boom(problem, rung):
    raise ArithmeticError("on purpose")
