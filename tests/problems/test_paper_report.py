"""The ten examples end to end: solutions, archive, table, figure, and who else solves them."""

import matplotlib as mpl
import pytest

from problems.paper import EXAMPLES
from problems.paper_figures import draw_examples
from problems.paper_methods import METHODS, compare, matrix
from problems.paper_report import remarks, run_examples, table

mpl.use("Agg")

CHOSEN = (EXAMPLES[0], EXAMPLES[6], EXAMPLES[9])


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """Rows and archive of examples 1 (the literal algorithm jumps), 7 (degenerate end) and 10 (two turns)."""
    file = tmp_path_factory.mktemp("report") / "paths.h5"
    return run_examples(CHOSEN, file), file


TABLE = [
    ["turns", "paper", "literal", "status"],
    ["0", "20", "18*", "REACHED_TARGET"],
    ["0", "17", "18", "REACHED_TARGET"],
    ["2", "1925", "1955", "REACHED_TARGET"],
]


def test_the_table_has_the_counts_and_marks_the_false_claim(report):
    rows, _ = report
    assert all(row.solved for row in rows)
    head, _, *lines = table(rows).splitlines()
    assert [line.split()[-4:] for line in (head, *lines)] == TABLE
    assert "(0.2403846, 0, 1.634615, 3.846154, 0)" in lines[2]
    (remark,) = remarks(rows)
    for part in ("Example 1", "(0.1666667, 0)", "0.17"):
        assert part in remark


def test_the_figure_has_a_panel_an_example_and_marks_the_turns(report):
    rows, _ = report
    figure = draw_examples([row.example for row in rows], [row.path for row in rows], columns=2)
    figure.canvas.draw()
    panels = [axes for axes in figure.axes if axes.get_visible()]
    assert len(panels) == 3
    assert panels[1].get_title() == r"7: almost $\bar{N}$, Q"
    marks = [line for line in panels[2].get_lines() if line.get_linestyle() == "None"]
    assert [mark.get_xdata()[0] for mark in marks] == [turn.lam for turn in rows[2].path.turning_points]
    (inset,) = panels[2].child_axes
    assert inset.get_title() == "2 turning points"


# Who solves examples 1 to 3, as an independent program found it; literal ends at a KKT point on example 1.
SOLVERS = {
    "kkt": "yyy", "literal": ".yy", "yu": ".yy", "zhao": "...", "xu": ".yy", "wang": ".yy", "kmm": ".yy",
    "lemke": ".yy", "modulus": None, "min-newton": ".yy",
}  # fmt: skip


@pytest.fixture(scope="module")
def results():
    return compare(EXAMPLES[:3], list(METHODS))


def test_who_solves_what(results):
    assert set(SOLVERS) == set(METHODS)
    for name, expected in SOLVERS.items():
        found = "".join("." if row.failed else "y" for row in results.of(method=name))
        assert expected is None or found == expected, name
    by = {(row.method, row.problem): row for row in results.rows}
    assert by["literal", "1"].failure == "wrong end"
    assert by["yu", "1"].failure == by["wang", "1"].failure == "diverged"
    assert by["literal", "3"].counts.accepted == 15


def test_the_matrix_has_a_line_a_method(results):
    head, _, *lines = matrix(results).splitlines()
    assert [line.split()[0] for line in (head, *lines)] == ["example", *METHODS]
    assert ["literal", "stat.", "21", "15"] in [line.split() for line in lines]
