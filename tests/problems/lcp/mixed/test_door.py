"""What comes through the door of `MixedLCP`, `from_qp` and the readers: sound, or refused with the index."""

import importlib.util
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from continuation.cli import main
from problems import lcp
from problems.lcp.data.files import read_problem

A, Q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])


def test_a_fixed_unknown_is_eliminated_and_named():
    solution = lcp.solve(lcp.MixedLCP(A, Q, [1.5, 0.0], [1.5, np.inf]))
    np.testing.assert_array_equal(solution.x, [1.5, 2.25])
    assert "Fixed, and eliminated: x[0]." in solution.message
    every = lcp.solve(lcp.MixedLCP(A, Q, [1, 2], [1, 2]))
    assert every.success
    np.testing.assert_array_equal(every.x, [1.0, 2.0])


def written(file, data):
    """A file of that suffix, with the data; JSON has null where a bound is infinite."""
    if file.suffix == ".npz":
        np.savez(file, **data)
    else:
        text = json.dumps({name: np.asarray(values).tolist() for name, values in data.items()})
        file.write_text(text.replace("-Infinity", "null").replace("Infinity", "null"))
    return file


@pytest.mark.parametrize("suffix", [".npz", ".json"])
def test_bounds_and_programs_are_read_from_every_container(tmp_path, suffix):
    bounded = {"A": A, "q": Q, "lower": [0.0, -np.inf], "upper": [1.0, np.inf]}
    program = {"P": A, "c": Q, "G": np.ones((1, 2)), "h": [2.0], "rows_lower": [-np.inf], "lower": [0.0, 0.0]}
    file = written(tmp_path / ("bounded" + suffix), bounded)
    problem = read_problem(file)
    np.testing.assert_array_equal([problem.lower, problem.upper], [bounded["lower"], bounded["upper"]])
    assert type(problem) is lcp.MixedLCP
    read = read_problem(written(tmp_path / ("program" + suffix), program))
    assert isinstance(read, lcp.Program)
    np.testing.assert_array_equal(lcp.solve(read).x, lcp.solve(lcp.from_qp(**program)).x)


MODEL = (
    "NAME T\nROWS\n N COST\n L LIM1\n G LIM2\nCOLUMNS\n X COST 1.0 LIM1 1.0\n X LIM2 1.0\n Y COST 2.0 LIM1 1.0\n"
    "RHS\n RHS LIM1 4.0 LIM2 1.0\nBOUNDS\n UP BND X 4.0\n LO BND Y -1.0\n"
)


@pytest.mark.parametrize(
    ("name", "more", "x", "objective"),
    [("t.mps", "", [1.0, -1.0], -1.0), ("t.QPS", "QUADOBJ\n X X 2.0\n Y Y 8.0\n", [1.0, -0.25], 1.75)],
)
def test_models_are_read_by_highs_where_it_is_installed(tmp_path, name, more, x, objective):
    pytest.importorskip("highspy")
    (tmp_path / name).write_text(f"{MODEL}{more}ENDATA\n")
    solution = lcp.solve(read_problem(tmp_path / name))
    np.testing.assert_array_equal(solution.named["x"], x)
    assert solution.objective == objective


@given(st.from_type(lcp.MixedLCP), st.from_type(lcp.Program))
def test_hypothesis_finds_problems_and_programs(problem, program):
    assert type(problem) is lcp.MixedLCP
    assert problem.n == problem.lower.size
    assert program.convex


def test_the_shell_solves_bounds_and_programs(tmp_path, capsys):
    bounds = {"A": [[2, 1], [1, 2]], "q": [-5, -6], "lower": [0, -np.inf], "upper": [1, np.inf]}
    program = {"P": [[2, 0], [0, 2]], "c": [-2, -6], "G": [[1, 1]], "h": [2], "lower": [0, 0]}
    files = [str(written(tmp_path / f"{len(data)}.json", data)) for data in (bounds, program)]
    assert [main(["solve", file, "--json"]) for file in files] == [0, 0]
    one, other = map(json.loads, capsys.readouterr().out.splitlines())
    assert one["x"] == pytest.approx([1.0, 2.5], rel=1e-15)
    assert (other["objective"], other["named"]["rows"]) == (-8.0, [-2.0])
    assert main(["solve", files[1]]) == 0
    assert "objective  -8" in capsys.readouterr().out
    (tmp_path / "model.mps").write_text("NAME")
    if importlib.util.find_spec("highspy") is None:
        assert main(["solve", str(tmp_path / "model.mps")]) == 2
        assert "expected highspy for this format" in capsys.readouterr().err
