"""Homotopies whose methods return what they should not: refused at the start, in one line that names the method."""

from itertools import count

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import trace

from ...util import refused


class Line:
    """y = (lam, lam^2)."""

    target = 1.0

    def start(self):
        return np.zeros(2), 0.0

    def residual(self, y, lam):
        return np.array([y[0] - lam, y[1] - lam * lam])


def with_methods(**methods):
    return type("Bad", (Line,), methods)()


def returning(value):
    return lambda *arguments: value


EYE, ZEROS, NAN = np.eye(2), np.zeros(2), np.nan
STARTS = {
    "a list": [ZEROS, 0.0],
    "nothing": None,
    "three": (0, 0, 0),
    "a point of NaN": (np.array([NAN, 0]), 0.0),
    "a parameter of NaN": (ZEROS, NAN),
    "an infinite parameter": (ZEROS, np.inf),
    "a matrix": (np.zeros((2, 1)), 0.0),
    "no unknowns": (np.zeros(0), 0.0),
    "unknowns alone": ZEROS,
    "text": (["a", "b"], 0.0),
    "complex unknowns": (ZEROS + 1j, 0.0),
    "a complex parameter": (ZEROS, 1j),
    "no parameter": (ZEROS, None),
    "two parameters": (ZEROS, ZEROS),
    "objects": (np.array([0, "x"], object), 0.0),
    "a masked entry": (np.ma.masked_array([0.0, 0.0], [0, 1]), 0.0),
    "dates": (np.zeros(2, "M8[s]"), 0.0),
}
RESIDUALS = {
    "one number": np.zeros(1),
    "three numbers": np.zeros(3),
    "a scalar": 0.0,
    "nothing": None,
    "a column": np.zeros((2, 1)),
    "complex numbers": np.zeros(2) + 0j,
    "text": ["a", "b"],
    "a mapping": {},
    "objects": np.array([0.0, 0.0], object),
    "dates": np.zeros(2, "M8[s]"),
    "truth values": np.zeros(2, bool),
}
JACOBIANS = {
    "nothing": None,
    "one matrix": EYE,
    "a small matrix": (np.eye(1), ZEROS),
    "a short column": (EYE, np.zeros(1)),
    "a column of two dimensions": (EYE, np.zeros((2, 1))),
    "a vector": (np.ones(2), ZEROS),
    "the two exchanged": (ZEROS, EYE),
    "lists": ([[1, 0], [0, 1]], [-1, 0]),
    "complex numbers": (EYE + 0j, ZEROS),
    "a complex column": (EYE, ZEROS + 0j),
    "text": ("a", "b"),
    "no matrix": (None, ZEROS),
    "a large sparse one": (sp.eye_array(3).tocsr(), ZEROS),
    "a complex sparse one": (sp.eye_array(2).tocsr().astype(complex), ZEROS),
    "objects": (EYE.astype(object), ZEROS),
    "three": (EYE, ZEROS, ZEROS),
}
ANSWERS = [
    *[("start", name, returning(value)) for name, value in STARTS.items()],
    *[("residual", name, returning(value)) for name, value in RESIDUALS.items()],
    *[("jacobian", name, returning(value)) for name, value in JACOBIANS.items()],
    *[("max_step", repr(value), returning(value)) for value in (NAN, None, "a", np.ones(2))],
    *[("target", repr(value), value) for value in ("end", NAN, np.ones(2), 1j)],
    # Labels that are none of the unknowns.
    *[("blocks", repr(value), value) for value in ([0], [0, 1, 1], [0, -1], [0.0, 1.0])],
]


NAMED = "jacobian", "bordered", "differential", "start", "residual"
REFUSED = {
    **{f"{name}: {what}": (name, with_methods(**{name: value}), {}) for name, what, value in ANSWERS},
    **{
        f"jacobian, checked: {what}": ("jacobian", with_methods(jacobian=returning(value)), {"check_jacobian": True})
        for what, value in JACOBIANS.items()
    },
    **{f"no method {name}": ("homotopy", with_methods(**{name: 5}), {}) for name in NAMED},
    "a class": ("homotopy", Line, {}),
}  # fmt: skip


@pytest.mark.parametrize(("argument", "homotopy", "options"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_homotopy_or_answers_what_it_should_not(argument, homotopy, options):
    refused(argument, lambda: trace(homotopy, **options))


def test_observed_names_stay_what_they_are(tmp_path):
    numbers = count()
    renaming = with_methods(observe=lambda *_: {f"k{next(numbers)}": 1.0})
    for archive in (None, tmp_path / "run.h5"):
        with pytest.raises(ValueError, match=r"observe: expected the names of the first point, .*k\d+.*, found .*k\d+"):
            trace(renaming, archive=archive)
