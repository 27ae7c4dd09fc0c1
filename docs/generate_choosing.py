"""The figures and tables of docs/choosing.md, and the check that its statements are true.

    python docs/generate_choosing.py [FOLDER]

FOLDER holds what ``make chart`` wrote (build/chart by default). Needs matplotlib. Ends with status 1, after writing
everything, if a statement of the page does not hold.
"""

import inspect
import re
import sys
from pathlib import Path

import choosing_claims
import choosing_scenes

from continuation import chart
from continuation.chart.style import CHART_DPI
from problems.charts import order

PAGE = Path(__file__).with_name("choosing.md")
IMAGES = PAGE.parent / "images"

END_POINT = chart.Precision("end_point", "factorizations")
FIGURES = {
    "engine-presets": END_POINT,
    "engine-predictors": END_POINT,
    "engine-correctors": END_POINT,
    "engine-controllers": END_POINT,
    "engine-steps": chart.Precision("curve_distance", "factorizations"),
    "order": chart.Sweep("seconds", order.chosen),
    "lcp-paper": chart.Profile("factorizations"),
    "lcp-generated": chart.Precision("natural_residual", "factorizations"),
    "scaling-curves": chart.Scaling("seconds"),
    "scaling-lcp": chart.Scaling("seconds"),
    "robustness": chart.Profile("factorizations"),
    "scenes-meshes": chart.Precision("answer", "seconds"),
    "scenes-exact": chart.Precision("answer", "seconds"),
}
TABLES = {
    "cost-model": order.CostModel(),
    "scaling-factorizations": chart.Scaling("factorizations"),
    "profile-factorizations": chart.Profile("factorizations"),
}

CLAIMS = {
    name: test
    for module in (choosing_claims, choosing_scenes)
    for name, test in inspect.getmembers(module, inspect.isfunction)
    if list(inspect.signature(test).parameters) == ["charts"]
}
"""What takes the charts alone is the test of a statement."""

CLAIM = re.compile(r"<!-- claim (\w+) -->")
TABLE = re.compile(r"<!-- table (\S+) -->\n.*?<!-- end -->", re.DOTALL)


def draw(charts):
    for study, figure in FIGURES.items():
        file = IMAGES / f"chart_{study}-{figure.name}.png"
        figure.draw(charts[study]).savefig(file, dpi=CHART_DPI)
        print(file)


def tables(text, charts):
    """The page with every table made anew."""

    def made(match):
        study, _, figure = match[1].partition("/")
        table = TABLES[figure].table(charts[study]) if figure else chart.summary(charts[study])
        return f"<!-- table {match[1]} -->\n\n{table.markdown()}\n\n<!-- end -->"

    return TABLE.sub(made, text)


def false_claims(text, charts):
    """The names of the page's claims that do not hold, and of those that are stated or tested alone."""
    stated = CLAIM.findall(text)
    alone = sorted(set(stated) ^ set(CLAIMS))
    return [f"{name}: not both stated and tested" for name in alone] + [
        f"{name}: does not hold" for name in stated if name in CLAIMS and not CLAIMS[name](charts)
    ]


def main(folder):
    charts = choosing_claims.Charts(folder)
    IMAGES.mkdir(exist_ok=True)
    draw(charts)
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(tables(text, charts), encoding="utf-8")
    print(PAGE)
    wrong = false_claims(text, charts)
    print("\n".join(wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE.parent.parent / "build" / "chart"))
