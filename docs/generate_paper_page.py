"""The tables and figures of docs/the_paper_measured.md, made anew.

    python docs/generate_paper_page.py

Takes about a minute; needs matplotlib. What a run prints depends on no clock and no random number.
"""

import contextlib
import io
import re
import sys
import tempfile
from pathlib import Path

from draw_counterexamples import figures

from continuation import DEFAULT, SERIES, trace
from continuation.cli import main as command
from continuation.predictors import Hermite, Tangent, Taylor
from problems.lcp import KKTHomotopy, classify
from problems.paper import EXAMPLES

PAGE = Path(__file__).with_name("the_paper_measured.md")
IMAGES = PAGE.parent / "images"
TABLE = re.compile(r"<!-- table (\w+) -->\n.*?<!-- end -->", re.DOTALL)

STATED = {
    1: ("N",), 2: ("PSD",), 3: ("Q0",), 4: ("E0^s",), 5: (), 6: ("almost copositive",), 7: ("almost N-bar", "Q"),
    8: ("almost N0",), 9: ("N0 of exact order k",), 10: ("N-bar of exact order k",),
}  # fmt: skip
"""What the paper says of each matrix, by the names that `classify` uses."""

DENIED = {3: ("PSD",), 5: ("N",), 8: ("Q",)}
"""What it says that they are not; of 3 only what its place in the text says."""

IMPLIED_BY = {
    "P0": {"row sufficient"}, "sufficient": {"PSD"}, "column sufficient": {"sufficient"}, "P_*": {"sufficient"},
    "copositive": {"PSD"}, "E0": {"row sufficient", "copositive"}, "Q0": {"Q", "row sufficient", "Z"},
    "nondegenerate": {"N"}, "R0": {"nondegenerate"}, "S": {"Q"}, "N0": {"N"}, "N-bar": {"N"},
    "almost N0": {"almost N-bar"}, "N-bar of exact order k": {"almost N-bar"},
    "N0 of exact order k": {"almost N-bar", "N-bar of exact order k"},
}  # fmt: skip
"""A class is left out of the table where one of these is in it (with what else holds of the ten matrices)."""

PREDICTORS = {
    "Euler (tangent), `DEFAULT`": {"preset": DEFAULT, "predictor": Tangent()},
    "Hermite, `DEFAULT`": {"preset": DEFAULT, "predictor": Hermite()},
    "Taylor with Padé, order 30, `SERIES`": {"preset": SERIES, "predictor": Taylor(order=30, rational=True)},
}


def markdown(head, rows, align):
    """A table; `align` has an l or an r a column."""
    lines = [head, [{"l": "---", "r": "---:"}[a] for a in align], *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def printed():
    """The two tables of `continuation paper --methods all`, with their remarks."""
    out = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(out):
        status = command(["paper", "--methods", "all", "--output", folder])
    if status:
        raise SystemExit("continuation paper: not all examples are solved")
    first, second, _ = out.getvalue().split("\n\n", 2)
    return {"examples": f"```text\n{first.strip()}\n```", "methods": f"```text\n{second.strip()}\n```"}


def work():
    """Factorisations from the paper's starts to lambda = 0, with no active-set finish."""
    rows = []
    for name, options in PREDICTORS.items():
        paths = [trace(KKTHomotopy(e.problem, e.x0, e.z1, e.z2), **options) for e in EXAMPLES]
        if not all(arrives(path, example) for path, example in zip(paths, EXAMPLES)):
            raise SystemExit(f"{name}: a wrong end")
        counts = [path.counts.factorizations for path in paths]
        rows.append([name, *counts[:9], f"**{sum(counts[:9])}**", f"**{counts[9]}**"])
    return markdown(["predictor", *range(1, 10), "total 1-9", 10], rows, "l" + "r" * 11)


def arrives(path, example):
    """Whether the path ends at the printed solution, of which the exact value is known."""
    x = path.endpoint.y[: example.q.size]
    return all(abs(a - float(b)) <= 1e-8 * (1 + abs(float(b))) for a, b in zip(x, example.solutions[0]))


def entailed(holds):
    """The classes that follow from others in the set."""
    return {name for name, smaller in IMPLIED_BY.items() if smaller & holds}


def label(membership):
    """The name of a class, with its k where it has one."""
    k = membership.certificate.value
    return membership.name.replace("order k", f"order {k}") if k is not None else membership.name


def classes():
    """The paper's class of each matrix, and what the exact tests say."""
    rows = []
    for example in EXAMPLES:
        found = classify(example.A)
        holds = {name for name, membership in found.items() if membership.holds}
        right = set(STATED[example.number]) <= holds and not set(DENIED.get(example.number, ())) & holds
        guaranteed = "yes" if "row sufficient" in holds else "no"
        heading = "P0" if "P0" in holds else "nondegenerate" if "nondegenerate" in holds else "**neither**"
        others = ", ".join(label(found[name]) for name in found if name in holds - {"row sufficient"} - entailed(holds))
        verdict = "confirmed" if right else "**wrong**"
        number = len(example.solutions)
        rows.append([example.number, example.stated_class, verdict, heading, others, guaranteed, number])
    head = [
        "#",
        "the paper's class",
        "exact test",
        "the heading's class",
        "other classes",
        "row sufficient",
        "solutions",
    ]
    return markdown(head, rows, "rlllllr")


def main():
    """Make the tables, put them into the page, draw the figures."""
    tables = {**printed(), "work": work(), "classes": classes()}
    text = PAGE.read_text(encoding="utf-8")
    missing = sorted(set(tables) ^ set(TABLE.findall(text)))
    if missing:
        raise SystemExit(f"{PAGE.name}: tables made and tables wanted differ: {', '.join(missing)}")
    made = TABLE.sub(lambda match: f"<!-- table {match[1]} -->\n\n{tables[match[1]]}\n\n<!-- end -->", text)
    PAGE.write_text(made, encoding="utf-8")
    print(PAGE)
    IMAGES.mkdir(exist_ok=True)
    for name, figure in figures().items():
        file = IMAGES / f"{name}.png"
        figure.savefig(file, dpi=110)
        print(file)


if __name__ == "__main__":
    sys.exit(main())
