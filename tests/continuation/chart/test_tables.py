"""What is read off results: the front, profiles, tables."""

import math

from attrs import evolve

from continuation import chart
from continuation.chart.results import ERROR_FLOOR
from continuation.counts import Counts


def test_a_profile_has_a_row_for_each_method_and_those_that_solve_most_stand_above():
    results = made(("slow", 1.0, 700, ""), ("lost", 1.0, 1, "jump"), ("quick", 1.0, 7, ""))
    (panel,) = chart.Profile("factorizations").draw(results).axes
    assert [label.get_text() for label in panel.get_yticklabels()] == ["quick", "slow", "lost"]
    assert [text.get_text() for text in panel.texts] == ["100% solved", "100% solved", "0% solved"]
    assert {tuple(line.get_xdata()) for line in panel.get_lines()} == {(), (1.0,), (1.0, 1.0), (100.0,), (100.0, 100.0)}


def test_a_profile_by_problems_has_ours_and_the_others_in_a_row():
    ours = made(("ours", 1.0, 10, "")).rows[0]
    theirs = evolve(ours, method="theirs", outside=True, counts=Counts(factorizations=5))
    rows = [ours, theirs, evolve(ours, problem="q"), evolve(theirs, problem="q", failure="jump")]
    (panel,) = chart.Profile("factorizations", by="problem").draw(evolve(made(), rows=rows)).axes
    assert [label.get_text() for label in panel.get_yticklabels()] == ["q", "p"]
    assert {tuple(line.get_xdata()) for line in panel.get_lines()} >= {(2.0, 1.0, 2.0), (1.0, 1.0)}


def made(*points):
    """Results of one problem: (method, error, factorisations, failure)."""
    rows = [
        chart.Row("p", "p", 1, name, False, 1.0, failure, "", {"e": error}, Counts(factorizations=work), 1.0)
        for name, error, work, failure in points
    ]
    return chart.Results("s", "t", "tolerance", {"e": "error"}, ("factorizations",), tuple(rows))


def test_the_front_is_what_nothing_beats():
    results = made(
        ("cheap", 1e-2, 10, ""),
        ("middle", 1e-4, 20, ""),
        ("beaten", 1e-3, 30, ""),
        ("exact", ERROR_FLOOR / 10, 50, ""),
        ("also exact", ERROR_FLOOR / 2, 50, ""),
        ("dearer", ERROR_FLOOR / 100, 60, ""),
        ("failed", 1e-9, 1, "jump"),
    )
    far = dict(zip(results.methods, chart.excess(results, "e", "factorizations").tolist()))
    assert far == {
        "cheap": 1.0, "middle": 1.0, "beaten": 1.5, "exact": 1.0, "also exact": 1.0, "dearer": 1.2, "failed": math.inf
    }  # fmt: skip
    lines = {line[0]: line for line in chart.summary(results).rows}
    assert lines["beaten"] == ("beaten", "1 of 1", "", 1.5)
    assert lines["failed"][:3] == ("failed", "0 of 1", "1 jump")


def test_what_is_solved_is_counted_by_family():
    rows = [
        evolve(row, family=family) for family in "ab" for row in made(("x", 1.0, 1, ""), ("y", 1.0, 1, "jump")).rows
    ]
    results = evolve(made(), rows=[*rows, rows[1], evolve(rows[0], method="y")])
    assert chart.solved(results) == chart.Table(("% solved", "a", "b"), [("x", 100, 100), ("y", 33, 0)])


def test_work_is_drawn_against_the_size_as_the_mean_of_what_succeeded():
    one = made(("a", 1.0, 1, "")).rows[0]
    runs = [(4, 10, ""), (2, 3, ""), (2, 5, ""), (2, 99, "jump"), (8, 99, "jump")]
    rows = [evolve(one, n=n, counts=Counts(factorizations=work), failure=failure) for n, work, failure in runs]
    (panel,) = chart.Lines("n", "factorizations").draw(evolve(made(), rows=rows)).axes
    assert panel.get_lines()[0].get_xydata().tolist() == [[2.0, 4.0], [4.0, 10.0]]


def test_tables_as_text_and_markdown():
    table = chart.Table(("name", "n"), [("a|b", 1), ("c", math.nan)])
    assert table.text() == "name    n\n----  ---\na/b     1\nc"
    assert table.markdown() == "| name |   n |\n| ---- | --: |\n| a/b  |   1 |\n| c    |     |"
