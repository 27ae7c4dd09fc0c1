"""The ready studies: their problems, their truths, and that small ones run."""

import numpy as np
import pytest

from continuation import chart
from continuation.arguments import plugins
from problems import lcp
from problems.charts import engine, families, rivals, robustness, scaling, scenes, subjects
from problems.charts import lcp as lcp_charts

MODULES = (engine, lcp_charts, scaling, robustness, scenes)


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.rpartition(".")[2])
def test_every_study_can_be_made(module):
    found = module.studies("smoke", False)
    assert len({study.name for study in found}) == len(found)
    assert all(study.problems and study.methods and study.errors for study in found)


@pytest.mark.parametrize("family", families.FAMILIES)
def test_a_planted_problem_has_a_solution_and_depends_on_the_seed_alone(family):
    problem = families.planted(family, 6, 3)
    again, other = families.planted(family, 6, 3), families.planted(family, 6, 4)
    np.testing.assert_array_equal(problem.q, again.q)
    assert (problem.q != other.q).any()
    assert lcp.solve_by_enumeration(problem)


def test_a_direct_solver_is_judged_by_the_certificate_unless_it_says_itself_that_it_failed(monkeypatch):
    def gives_up(problem):
        if problem.n > 1:
            raise ArithmeticError("a ray")
        return np.ones(1), 1

    answers = {
        "right": ("numpy", lambda problem: (np.linalg.solve(problem.A, -problem.q), 2), lcp_charts.interior),
        "wrong": ("", lambda problem: (np.zeros(problem.n), 2), lcp_charts.interior),
        "gives up": ("math", gives_up, lcp_charts.pivots),
    }
    monkeypatch.setattr(lcp_charts, "DIRECT", answers)
    study = chart.Study(
        name="outside",
        problems=[chart.Problem("one", lcp.LCP(np.eye(5), -np.ones(5)))],
        methods=lcp_charts.direct_methods(True),
        ladder=(1e-8,),
        errors=lcp_charts.RESIDUAL,
        repeats=0,
    )
    rows = chart.run(study).rows
    assert [(row.failure, row.counts.factorizations) for row in rows] == [("", 2), ("wrong end", 2), ("stopped", 0)]
    assert rows[2].message == "a ray"
    for name in ("lcp", "robustness", "scaling"):
        compared = [method.name for method in plugins.find(name, plugins.STUDIES)("smoke", True)[-1].methods]
        assert {"right", "gives up"} < set(compared)


@pytest.mark.parametrize("name", ["quantecon Lemke", "PIQP"])
def test_the_adapters_of_installed_solvers_work(name):
    module, solve, _ = lcp_charts.DIRECT[name]
    pytest.importorskip(module)
    problem = lcp_charts.problem("semidefinite", 5, 0).subject
    x, iterations = solve(problem)
    assert lcp.certify(problem, x).solves(1e-6)
    assert iterations > 0


def test_scenes_are_answered_by_ours_and_by_the_methods_that_apply_to_them():
    (study,) = scenes.studies("smoke", False)
    rows = chart.run(study).rows
    assert [(row.problem, row.method, row.failure) for row in rows] == [
        ("string", "ours", ""), ("string", "L-BFGS-B (scipy)", ""),
        ("cournot", "ours", ""), ("cournot", "L-BFGS-B (scipy)", ""),
    ]  # fmt: skip
    assert rows[2].errors["answer"] <= 1e-15
    problem = chart.Problem("cournot", scenes.make("cournot"), options={"true": {"price": 50.0}})
    answer = scenes._method("wrong", lambda scene: {"price": 40.0}).run(problem, 1.0)
    assert (answer.failure, answer.message) == ("wrong end", "the answer is off by 2.0e-01")


@pytest.mark.parametrize(
    ("name", "problem", "accuracy"),
    [
        ("plain scipy loop", subjects.freudenstein(), 1e-10),
        ("PITCON (dense)", subjects.bratu_square(5), 1e-6),
        ("bice", subjects.bratu_square(5), 1e-6),
    ],
)
def test_other_followers_come_to_the_end_of_a_path_and_are_counted(name, problem, accuracy):
    if module := rivals.FOLLOWERS[name][0]:
        pytest.importorskip(module)
    methods = [method for method in rivals.curve_followers(bool(module)) if method.name == name]
    study = chart.Study(name="followers", problems=[problem], methods=methods, ladder=(1e-8,), repeats=0)
    (row,) = chart.run(study).rows
    assert (row.failure, row.outside) == ("", True)
    assert row.errors["end_point"] < accuracy
    assert row.counts.factorizations > 0
