"""The command line: exit statuses, what is printed, and one line for whatever cannot be used."""

import json
from importlib.metadata import EntryPoint

import numpy as np
import pytest

import continuation
from continuation.archive import open_archive
from continuation.arguments import plugins
from continuation.cli import BAD_INPUT, FAILURE
from problems.paper import COUNTEREXAMPLES, EXAMPLES


def save(folder, problem, name="problem.npz"):
    np.savez(folder / name, A=problem.A, q=problem.q)
    return folder / name


@pytest.fixture
def second(tmp_path):
    """The paper's example 2, whose only solution is (1/2, 0)."""
    return save(tmp_path, EXAMPLES[1].problem)


@pytest.fixture(scope="session")
def archive(tmp_path_factory):
    """A closed archive with one path through a fold."""
    file = tmp_path_factory.mktemp("archives") / "fold.h5"
    trace_fold(file)
    return file


class Fold:
    """lam = 1 - y^2; a class that an archive can name, and make again for who trusts it."""

    target = None

    def start(self):
        return np.array([-1.0]), 0.0

    def residual(self, y, lam):
        return y**2 + lam - 1.0


def trace_fold(file, **options):
    end = continuation.TargetValue(0.9, component=0)
    return continuation.trace(Fold(), archive=file, direction=1, events=[end], **options)


# -- solve ----------------------------------------------------------------------------------------------------


def test_solve_prints_the_solution(run, second):
    out, err = run("solve", second)
    assert (
        err,
        dict(line.split(maxsplit=1) for line in out.splitlines() if line[:1].isalpha())["outcome"],
    ) == ("", "SOLVED")
    rows = [line.split() for line in out.splitlines() if line.startswith("  ") and line.strip()[:1] in "01"]
    assert [row[0] for row in rows] == ["0", "1"]
    np.testing.assert_allclose([float(row[1]) for row in rows], [0.5, 0], atol=1e-10)


def test_solve_without_a_solution_exits_with_one(run, tmp_path):
    answer = json.loads(run("solve", save(tmp_path, COUNTEREXAMPLES[0].problem), "--json", status=FAILURE).out)
    assert answer["outcome"] in ("STATIONARY", "UNSOLVABLE", "NOT_FOUND")


def test_solve_with_everything(run, second, tmp_path):
    np.save(tmp_path / "x0.npy", [2.0, 1.0])
    archive, picture = tmp_path / "run.h5", tmp_path / "path.png"
    given = "--homotopy", "kkt", "--x0", tmp_path / "x0.npy", "--archive", archive, "--plot", picture
    assert "lam =" in run("solve", second, *given, "--progress").err
    assert picture.read_bytes().startswith(b"\x89PNG")
    with open_archive(archive) as stored:
        np.testing.assert_allclose(stored.path(0).steps[0].y[:2], [2, 1])


def test_solve_traces_a_path_for_an_archive_and_for_a_picture(run, second, tmp_path):
    asked = (), ("--archive", tmp_path / "path.h5"), ("--plot", tmp_path / "path.png")
    assert [json.loads(run("solve", second, "--json", *one).out)["paths"] for one in asked] == [0, 1, 1]


# -- classify and paper ---------------------------------------------------------------------------------------


def test_classify_takes_a_problem_or_a_matrix_alone(run, second, tmp_path):
    np.savetxt(tmp_path / "a.txt", [[1.0, 0.0], [0.0, 1.0]])
    for file, answer in ((second, " no "), (tmp_path / "a.txt", " yes ")):
        lines = {line[:40].split("  ")[0].strip(): line for line in run("classify", file).out.splitlines()}
        assert " yes " in lines["PSD"]
        assert answer in lines["P"]


# -- archives -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options", [(), ("--against", "arclength"), ("--diagram",), ("--diagram", "--components", "0")]
)
def test_plot_writes_a_picture(run, archive, tmp_path, options):
    assert run("plot", archive, "--output", tmp_path / "p.png", *options).out.strip() == str(tmp_path / "p.png")
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")


def test_resume_goes_on(run, tmp_path):
    file, trust = tmp_path / "run.h5", ("--trust", f"{__name__}:Fold")
    trace_fold(file, budget=continuation.Budget(steps=3))
    assert "Fold is not registered: pass it in trust=[...]" in run("resume", file, "--steps", 9, status=BAD_INPUT).err
    assert run("resume", file, "--steps", 4, *trust, status=FAILURE).out.startswith("BUDGET_EXHAUSTED")
    assert run("resume", file, "--steps", 100, *trust).out.startswith("STOPPED_AT_EVENT")
    with open_archive(file) as stored:
        assert stored.path(0).endpoint.y[0] == 0.9


def test_export_and_merge(run, archive, tmp_path):
    out = run("export", archive, tmp_path / "run.csv").out
    assert out.splitlines() == [str(tmp_path / "run.csv"), str(tmp_path / "run.paths.csv")]
    run("merge", tmp_path / "one.h5", archive)


# -- the program itself ---------------------------------------------------------------------------------------


def test_a_command_that_cannot_be_loaded_hides_no_other(run, archive, monkeypatch):
    point = "broken", "no.such.module:register"
    monkeypatch.setattr(plugins, "entry_points", lambda group: [EntryPoint(*point, group)])
    run("inspect", archive)
    err = run("broken", "--anything", "file", status=BAD_INPUT).err
    assert "broken: no.such.module:register (no.such.module:register) cannot be loaded: ModuleNotFoundError" in err
