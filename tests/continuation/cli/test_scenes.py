"""``continuation solve scene`` and ``continuation plugins``: scenes by name, of this package and of one's own."""

import json
import re
from pathlib import Path

import pytest


def test_as_json(run):
    answer = json.loads(run("solve", "scene", "cournot", "costs=[10,20]", "--json").out)
    assert answer["unknowns"] == 2
    assert answer["answer"]["price"] == pytest.approx(130.0 / 3.0)


def test_scenes_are_listed_beside_homotopies(run):
    out, err = run("plugins")
    assert err == ""
    assert "a scene: continuation solve scene american-put" in out
    assert "bratu-1d" in out
    assert "options: mass=1.0, friction=0.5, speed=1.0" in run("plugins", "block").out


def test_the_scene_of_the_tutorial_runs_by_its_name(run, tmp_path, monkeypatch):
    page = (Path(__file__).parents[3] / "docs" / "own_scene.md").read_text(encoding="utf-8")
    code = re.search(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[1]
    (tmp_path / "reservoirs.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    out, err = run("solve", "scene", "reservoirs:Reservoirs", "seepage=0.4", "--plot", "levels.png")
    assert err == ""
    assert "levels  3.75, 4, 4, 4 m" in out
    assert (tmp_path / "levels.png").exists()
