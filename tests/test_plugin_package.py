"""A package of somebody else's: installed into a folder of its own, found by its entry point, run and tested there."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "examples" / "plugin_package"


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """Runs Python in an environment with the package installed, and nothing fetched from anywhere."""
    folder = tmp_path_factory.mktemp("site")
    # Built from a copy: a build leaves nothing in the repository.
    source = tmp_path_factory.mktemp("source")
    for file in ("pyproject.toml", "README.md", "snapthrough/__init__.py"):
        (source / file).parent.mkdir(exist_ok=True)
        (source / file).write_bytes((PACKAGE / file).read_bytes())
    environment = {**os.environ, "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}

    def run(*arguments, cwd=folder):
        command = [sys.executable, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment, cwd=cwd)

    options = ("--quiet", "--no-deps", "--no-build-isolation", "--target", folder)
    installed = run("-m", "pip", "install", *options, source)
    assert installed.returncode == 0, installed.stderr
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, (str(folder), os.environ.get("PYTHONPATH"))))
    return run


COMMANDS = """
import sys
from contextlib import redirect_stdout
from continuation.cli import main
for k, line in enumerate(sys.argv[1:]):
    with open(f"{k}.txt", "w") as out, redirect_stdout(out):
        assert main(line.split()) == 0, line
"""


def test_it_is_listed_and_traced_by_its_name(program, tmp_path):
    trace = "trace von-mises-truss rise=0.2 --json --archive snap.h5"
    lines = "plugins von-mises-truss", "plugins", trace, "inspect snap.h5"
    ran = program("-c", COMMANDS, *lines, cwd=tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")
    listed, every, traced, inspected = ((tmp_path / f"{k}.txt").read_text() for k in range(4))
    assert "Two bars of unit span" in listed
    assert "options: rise=0.3, target=0.05" in listed
    assert "for: elastic structures" in listed
    assert "from: snapthrough 0.1.0 (snapthrough:VonMisesTruss)" in listed
    assert "@article{vonMises1923" in listed
    assert {"von-mises-truss", "bratu-1d", "kkt"} <= set(every.splitlines())
    answer = json.loads(traced)
    assert answer["status"] == "REACHED_TARGET"
    loads = [event["lam"] for event in answer["events"]]
    load = 2 * 0.2**3 / (3 * 3**0.5)
    assert loads == pytest.approx([load, -load], abs=1e-10)
    assert "snapthrough:VonMisesTruss" in inspected


def test_its_own_tests_pass(program, tmp_path):
    tests = tmp_path / "test_conformance.py"
    tests.write_bytes((PACKAGE / "tests" / "test_conformance.py").read_bytes())
    ran = program("-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider", tests, cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout
    assert "13 passed" in ran.stdout
