"""The benchmark of families from outside, smoke size: its table takes the place of the one in a page."""

from ....util import benchmark


def test_a_table_is_written_where_one_was(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("Above.\n\n| family | before |\n|---|---|\n| old | 1 |\n\nBelow.\n")
    monkeypatch.setattr("sys.argv", ["outside.py", "grids", "--seed", "1", "--write", str(page)])
    benchmark("lcp/outside.py").main()
    lines = page.read_text().splitlines()
    assert (lines[0], lines[-1], len(lines)) == ("Above.", "Below.", 7)
    assert lines[4].startswith("| 12 grids, n = 12 to 900 | - | 12, ")
