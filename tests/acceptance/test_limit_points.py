"""Freudenstein-Roth: every limit point, in the order of the path, and none that does not exist."""

import numpy as np
import pytest

from continuation import CONSERVATIVE, DEFAULT, FAST, TurningPoint
from continuation.controllers import AllgowerGeorg, Bounds
from problems.bifurcation import FreudensteinRoth

from ..util import path_of

TABLE = [
    ("turning point of component 0", (14.28309125009385, -1.741376892197492, 0.258577871376728)),
    ("turning point", (20.48585782792345, -0.896805253274477, 0.587587325408120)),
    ("turning point of component 0", (61.66936258114785, 1.983801134621735, -0.663879742243337)),
    ("turning point", (61.02031501158272, 2.230138586607810, -0.686352757506886)),
]


@pytest.mark.parametrize(
    "options",
    [
        *({"preset": preset} for preset in (FAST, DEFAULT, CONSERVATIVE)),
        *({"controller": AllgowerGeorg(bounds=Bounds(maximum=longest))} for longest in (30.0, 20.0, 3.0, 0.5)),
    ],
    ids=["FAST", "DEFAULT", "CONSERVATIVE", "30", "20", "3", "0.5"],
)
def test_freudenstein_roth_under_every_preset_and_whatever_the_longest_step(options):
    path = path_of(FreudensteinRoth(), events=[TurningPoint(0)], **options)
    assert [event.name for event in path.events] == [name for name, _ in TABLE]
    for event, (_, point) in zip(path.events, TABLE):
        np.testing.assert_allclose(event.u, point, rtol=0, atol=1e-10)
    np.testing.assert_allclose(path.endpoint.u, (5.0, 4.0, 1.0), rtol=1e-9)
    assert path.endpoint.lam == 1.0
    assert options.get("preset") is not DEFAULT or path.counts.factorizations <= 60
