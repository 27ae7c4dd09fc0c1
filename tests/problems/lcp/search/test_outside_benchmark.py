"""The benchmark of families from outside, smoke size: its table takes the place of the one in a page."""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[4]


def test_a_table_is_written_where_one_was(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "examples/benchmarks/lcp"))
    import outside

    page = tmp_path / "page.md"
    page.write_text("Above.\n\n| family | before |\n|---|---|\n| old | 1 |\n\nBelow.\n")
    given = ["outside.py", "grids", "--seed", "1", "--write", str(page)]
    monkeypatch.setattr(sys, "argv", given)
    outside.main()
    lines = page.read_text().splitlines()
    assert (lines[0], lines[-1], len(lines)) == ("Above.", "Below.", 7)
    assert lines[4].startswith("| 12 grids, n = 12 to 900 | - | 12, ")
