"""The pictures and tables of docs/choosing.md and docs/scenes_measured.md, and the check that its statements are true.

    python docs/generate_choosing.py [FOLDER]

FOLDER holds results of all studies, run with ``--compare`` (build/chart by default): ``make chart`` runs them, and this.
Needs matplotlib. Ends with status 1, after writing everything, if a statement of the page does not hold.
"""

import re
import sys
from pathlib import Path

import choosing_claims
import choosing_scenes

from attrs import evolve

from continuation import chart

PAGES = [Path(__file__).with_name(name) for name in ("choosing.md", "scenes_measured.md")]
IMAGES = Path(__file__).parent / "images"
OURS_AND_THEIRS = ["DEFAULT", "SERIES", "plain scipy loop", "PITCON (dense)", "bice"]


def shown(results):
    """A sparse system and a path that winds, of those of the presets."""
    kinds = ("Bratu 2D", "exponential-cosine, n = 5")
    return [name for kind in kinds for name in results.problems if name.startswith(kind)]


def pictures(charts):
    """Each picture by the name of its file."""
    presets, scenes = charts["engine-presets"], charts["scenes"]
    both = ("seconds", "factorizations")
    # Of the README: two paths, ours and theirs.
    rows = [row for row in presets.rows if row.method in OURS_AND_THEIRS]
    headline = evolve(presets, rows=rows, title="Error at the end of the path against time")
    yield "headline", chart.Lines("end_point", "seconds", shown(presets)), headline
    yield "presets", chart.Lines("end_point", both, shown(presets)), presets
    yield "lcp-paper", chart.Profile("factorizations"), charts["lcp-paper"]
    yield "robustness", chart.Profile("factorizations"), charts["robustness"]
    yield "scaling-curves", chart.Lines("n", both), charts["scaling-curves"]
    yield "scaling-lcp", chart.Lines("n", both), charts["scaling-lcp"]
    yield "scenes", chart.Profile("seconds", by="problem"), scenes


TABLES = {"": chart.summary, "solved": chart.solved}

CLAIMS = {**choosing_claims.CLAIMS, "scenes": choosing_scenes.CLAIMS}

CLAIM = re.compile(r"<!-- claim (\w+) -->")
TABLE = re.compile(r"<!-- table (\S+) -->\n.*?<!-- end -->", re.DOTALL)


def draw(charts):
    for name, picture, results in pictures(charts):
        file = IMAGES / f"chart_{name}.png"
        picture.draw(results).savefig(file)
        print(file)


def tables(text, charts):
    """The page with every table made anew."""

    def made(match):
        study, _, kind = match[1].partition("/")
        return f"<!-- table {match[1]} -->\n\n{TABLES[kind](charts[study]).markdown()}\n\n<!-- end -->"

    return TABLE.sub(made, text)


def false_claims(text, charts):
    """The names of the page's claims that do not hold, and of those that are stated or tested alone."""
    tested = {name: (study, test) for study, claims in CLAIMS.items() for name, test in claims.items()}
    stated = set(CLAIM.findall(text))
    wrong = [f"{name}: does not hold" for name, (study, test) in tested.items() if not test(charts[study])]
    return [*wrong, *(f"{name}: not both stated and tested" for name in sorted(stated ^ set(tested)))]


def main(folder):
    charts = {file.stem: chart.read(file) for file in folder.glob("*.json")}
    IMAGES.mkdir(exist_ok=True)
    draw(charts)
    for page in PAGES:
        page.write_text(tables(page.read_text(encoding="utf-8"), charts), encoding="utf-8")
        print(page)
    wrong = false_claims(PAGES[0].read_text(encoding="utf-8"), charts)
    print("\n".join(wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent / "build" / "chart"))
