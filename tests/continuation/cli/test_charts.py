"""The command `chart`: what it writes, lists and refuses."""

from types import SimpleNamespace

import pytest

from continuation import chart
from continuation.arguments import plugins
from continuation.cli import charts
from continuation.cli.parser import Parser
from problems.charts.subjects import cosine


@pytest.fixture
def installed(monkeypatch):
    """A small study as if a package had registered it."""
    small = chart.Study(
        name="closed",
        problems=[cosine(2)],
        methods=[chart.traced("Hermite"), chart.Method("raises", lambda problem, rung: 1 // 0)],
        ladder=(1e-6,),
        figures=[chart.Lines("end_point", "factorizations"), chart.Profile("factorizations")],
        repeats=0,
    )

    point = SimpleNamespace(name="closed", value="package:studies", dist=None, load=lambda: lambda *_: [small])
    monkeypatch.setattr(plugins, "entry_points", lambda group: [point])


def command(*arguments):
    parser = Parser()
    charts.register(parser.add_subparsers())
    parsed = parser.parse_args(["chart", *arguments])
    return parsed.run(parsed)


def test_the_command_writes_everything(installed, tmp_path, capsys):
    folder = tmp_path / "out"
    assert command("closed", "--smoke", "--output", str(folder)) == 0
    assert sorted(file.name for file in folder.iterdir()) == [
        "closed-1.png", "closed-2.png", "closed.json",
    ]  # fmt: skip
    said = capsys.readouterr().out
    assert "1 exception" in said
    assert "blas_threads" in chart.read(folder / "closed.json").provenance


def test_the_command_lists_the_studies_and_names_a_wrong_one(installed, capsys):
    assert command() == 0
    assert capsys.readouterr().out == "closed\n"
    with pytest.raises(plugins.PluginError, match="open: no study of this name is installed; known are closed"):
        command("open")
