"""What to quote: the parts of a run, the homotopy's own sources, each once, in BibTeX that can be read."""

import re

import numpy as np
import pytest

import continuation
from continuation.archive import open_archive
from continuation.citation import bibliography, entries, key, short, unique
from continuation.correctors import MoorePenrose
from continuation.predictors import Taylor
from problems import lcp
from problems.bifurcation import Bratu1D, Circle, Pitchfork
from problems.paper import EXAMPLES

ENTRIES = [value for name, value in vars(bibliography).items() if name.isupper()]


def keys(text):
    return [key(entry) for entry in entries(text)]


def traced(homotopy, **options):
    return continuation.cite(continuation.trace(homotopy, **options))


@pytest.mark.parametrize("entry", ENTRIES, ids=key)
def test_an_entry_is_bibtex(entry):
    assert re.fullmatch(r"@(article|book|incollection|software)\{\w+,\n(  \w+ = \{.*\},\n)+\}", entry)
    assert entry.count("{") == entry.count("}")
    for field in ("author", "title", "year"):
        assert f"  {field} = " in entry


def test_keys_are_unique():
    assert len({key(entry) for entry in ENTRIES}) == len(ENTRIES)


def test_the_parts_of_a_run_are_quoted():
    found = keys(traced(Bratu1D(10), budget=continuation.Budget(steps=3)))
    assert found[:2] == ["continuation", "AllgowerGeorg2003"]
    assert {"Keller1977", "Deuflhard2004", "Bratu1914"} <= set(found)
    assert "Cochelin1994" not in found


def test_other_parts_other_sources():
    found = keys(
        traced(
            Circle(),
            corrector=MoorePenrose(),
            budget=continuation.Budget(steps=3),
        )
    )
    assert "AllgowerGeorg2003" in found
    assert "Keller1977" not in found


def test_series_rational_or_not_by_jets_or_not():
    plain = keys(traced(Circle(), preset=continuation.SERIES, predictor=Taylor()))
    assert {"Cochelin1994", "GriewankWalther2008"} <= set(plain)
    assert "BakerGravesMorris1996" not in plain
    assert "BakerGravesMorris1996" in keys(traced(Circle(), preset=continuation.SERIES))
    example = EXAMPLES[1]
    own = keys(traced(lcp.KKTHomotopy(example.problem, example.x0), preset=continuation.SERIES))
    assert "Cochelin1994" in own
    assert "GriewankWalther2008" not in own


def test_derivatives_from_the_residual_are_quoted():
    def by_jets(y, lam):
        return y**2 + lam**2 - 1.0

    def by_complex_step(y, lam):
        return np.array([complex(y[0]) ** 2 + lam**2 - 1.0]) if np.iscomplexobj(y) else y**2 + float(lam) ** 2 - 1.0

    for function, source in ((by_jets, "GriewankWalther2008"), (by_complex_step, "SquireTrapp1998")):
        homotopy = continuation.from_functions(function, start=([1.0], 0.0), target=None)
        assert source in keys(traced(homotopy, budget=continuation.Budget(steps=2)))


def test_a_branch_point_and_a_singular_end_are_quoted():
    assert "Govaerts2000" in keys(traced(Pitchfork()))
    assert "Govaerts2000" not in keys(traced(Pitchfork(0.1)))
    example = EXAMPLES[6]
    assert "MorganSommeseWampler1992" in keys(traced(lcp.KKTHomotopy(example.problem, example.x0)))


def test_a_homotopy_alone_is_quoted_with_its_own_sources():
    assert keys(continuation.cite(Bratu1D(10))) == ["continuation", "Bratu1914"]


def test_a_path_of_an_archive_knows_its_parts(tmp_path):
    path = continuation.trace(Bratu1D(10), archive=tmp_path / "a.h5", budget=continuation.Budget(steps=3))
    with open_archive(tmp_path / "a.h5") as archive:
        assert keys(continuation.cite(archive.path(0))) == keys(continuation.cite(path))


def test_only_paths_and_homotopies_can_be_quoted():
    with pytest.raises(TypeError, match="source: expected a path or a homotopy, found int"):
        continuation.cite(3)


def test_an_entry_in_one_line():
    assert short(bibliography.MORGAN_SOMMESE_WAMPLER) == (
        "Morgan, Sommese and Wampler 1992, "
        "A Power Series Method for Computing Singular Solutions to Nonlinear Analytic Systems"
    )
    assert short("@misc{X,\n  author = {Yu and others},\n  year = {2006},\n}") == "Yu et al. 2006"
    assert short("@misc{OnlyAKey,\n}") == "OnlyAKey"
    assert "Pade Approximants" in short(bibliography.BAKER_GRAVES_MORRIS)


def test_the_first_of_two_entries_with_one_key_stays():
    assert unique(("@misc{a, 1}", "@misc{b, 2}", "@misc{a, 3}")) == ("@misc{a, 1}", "@misc{b, 2}")
