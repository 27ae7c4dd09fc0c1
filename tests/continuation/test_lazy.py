"""Names of the package are imported when they are asked for, and are those that its imports for types say."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import continuation

HEAVY = "numpy", "scipy", "h5py", "attr"


def imported(*command):
    """What a command prints, and which of the heavy packages it imports."""
    found = subprocess.run([sys.executable, "-X", "importtime", *command], capture_output=True, text=True, check=True)
    modules = {line.rpartition("|")[2].strip() for line in found.stderr.splitlines()}
    return found.stdout, {name for name in HEAVY if name in modules}


def test_the_package_by_itself_imports_nothing():
    assert imported("-c", "import continuation") == ("", set())


def test_the_version_is_said_before_anything_is_imported():
    said = f"continuation {continuation.__version__}\n"
    assert imported("-m", "continuation", "--version") == (said, set())


def test_every_name_is_that_of_the_module_which_the_imports_for_types_say():
    tree = ast.parse(Path(continuation.__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    said = {alias.name: node.module for node in block.body for alias in node.names}
    assert {name: f"continuation.{home}" for name, home in continuation._HOME.items()} == said
    assert sorted(continuation.__all__) == sorted([*said, "__version__"])
    for name, module in said.items():
        assert getattr(continuation, name) is getattr(sys.modules[module], name)


def test_modules_are_found_by_name_and_others_are_not():
    code = "import continuation; print(continuation.jets.__name__, hasattr(continuation, 'nothing'))"
    assert imported("-c", code)[0] == "continuation.jets False\n"
    assert {"trace", "Path", "__version__"} <= set(dir(continuation))
    with pytest.raises(AttributeError, match="module 'continuation' has no attribute 'traces'"):
        continuation.traces  # noqa: B018
