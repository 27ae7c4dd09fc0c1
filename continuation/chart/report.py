"""A study's files: results, tables, figures, in one folder."""

from __future__ import annotations

from pathlib import Path as File

from continuation.chart.results import Results
from continuation.chart.store import write
from continuation.chart.study import Study, SupportsTable
from continuation.chart.style import CHART_DPI
from continuation.chart.table import Table, runs, summary


def report(study: Study, results: Results, folder: File) -> list[File]:
    """Write ``NAME.h5``, ``NAME.csv``, ``NAME.md`` and one ``NAME-FIGURE.png`` a figure; what is there is replaced.

    The folder exists. Returned are the files; without matplotlib there are no figures among them.
    """
    stored = folder / f"{study.name}.h5"
    stored.unlink(missing_ok=True)
    files = [write(results, stored), folder / f"{study.name}.csv", folder / f"{study.name}.md"]
    files[1].write_text(runs(results).csv(), encoding="utf-8")
    files[2].write_text(_page(study, results), encoding="utf-8")
    for figure in study.figures:
        try:
            drawing = figure.draw(results)
        except ImportError:
            break
        files.append(folder / f"{study.name}-{figure.name}.png")
        drawing.savefig(files[-1], dpi=CHART_DPI)
    return files


def tables(study: Study, results: Results) -> dict[str, Table]:
    """What the figures say, as tables by title: the summary by method, and the tables that the figures have."""
    found = {"Methods": summary(results)}
    for figure in study.figures:
        if isinstance(figure, SupportsTable):
            found[figure.name] = figure.table(results)
    return found


def _page(study: Study, results: Results) -> str:
    """Everything as Markdown."""
    parts = [f"# {results.title}"]
    parts += [f"## {title}\n\n{table.markdown()}" for title, table in tables(study, results).items()]
    failed = runs(results, failures_only=True)
    if failed.rows:
        parts.append(f"## Failures\n\n{failed.markdown()}")
    parts.append(f"## Runs\n\n{runs(results).markdown()}")
    made = ("notes", "library_version", "created", "threads", "machine", "blas", "python_version", "numpy_version")
    parts.append("\n".join(f"- {name}: {results.provenance[name]}" for name in made if name in results.provenance))
    return "\n\n".join(parts) + "\n"
