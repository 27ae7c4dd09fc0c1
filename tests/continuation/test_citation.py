"""What to quote: the parts of a run, the homotopy's own sources, each once, in BibTeX that can be read."""

import numpy as np
import pytest

from continuation import SERIES, Budget, cite, from_functions, trace
from continuation.archive import open_archive
from continuation.citation import entries, key
from continuation.correctors import MoorePenrose
from continuation.predictors import Taylor
from problems import lcp
from problems.bifurcation import Bratu1D, Circle, Pitchfork
from problems.paper import EXAMPLES

FEW = {"budget": Budget(steps=3)}


def keys(source):
    return [key(entry) for entry in entries(cite(source))]


def kkt(number):
    return lcp.KKTHomotopy(EXAMPLES[number].problem, EXAMPLES[number].x0)


def by_complex_step(y, lam):
    return np.array([complex(y[0]) ** 2 + lam**2 - 1.0]) if np.iscomplexobj(y) else y**2 + float(lam) ** 2 - 1.0


def own(function):
    return from_functions(function, start=([1.0], 0.0), target=None)


@pytest.mark.parametrize(
    ("homotopy", "options", "there", "absent"),
    [
        (Bratu1D(10), FEW, "continuation AllgowerGeorg2003 Keller1977 Deuflhard2004 Bratu1914", "Cochelin1994"),
        (Circle(), {"corrector": MoorePenrose(), **FEW}, "AllgowerGeorg2003", "Keller1977"),
        (
            Circle(), {"preset": SERIES, "predictor": Taylor()},
            "Cochelin1994 GriewankWalther2008", "BakerGravesMorris1996",
        ),
        (Circle(), {"preset": SERIES}, "BakerGravesMorris1996", "Govaerts2000"),
        (kkt(1), {"preset": SERIES}, "Cochelin1994", "GriewankWalther2008"),
        (own(lambda y, lam: y**2 + lam**2 - 1.0), FEW, "GriewankWalther2008", "SquireTrapp1998"),
        (own(by_complex_step), FEW, "SquireTrapp1998", "GriewankWalther2008"),
        (Pitchfork(), {}, "Govaerts2000", "MorganSommeseWampler1992"),
        (Pitchfork(0.1), {}, "continuation", "Govaerts2000"),
        (kkt(6), {}, "MorganSommeseWampler1992", "Cochelin1994"),
    ],
)  # fmt: skip
def test_what_a_run_used_is_quoted_and_nothing_else(homotopy, options, there, absent):
    found = keys(trace(homotopy, **options))
    assert len(set(found)) == len(found)
    assert set(there.split()) <= set(found)
    assert absent not in found


def test_a_homotopy_alone_is_quoted_with_its_own_sources():
    assert keys(Bratu1D(10)) == ["continuation", "Bratu1914"]
    with pytest.raises(TypeError, match="source: expected a path or a homotopy, found int"):
        cite(3)


def test_a_path_of_an_archive_knows_its_parts(tmp_path):
    path = trace(Bratu1D(10), archive=tmp_path / "a.h5", **FEW)
    with open_archive(tmp_path / "a.h5") as archive:
        assert keys(archive.path(0)) == keys(path)
