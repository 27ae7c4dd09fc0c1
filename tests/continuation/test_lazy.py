"""Names of the package are imported when they are asked for, and are those that its imports for types say."""

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import continuation


def imported(*command):
    """What a command prints, and which of the heavy packages it imports."""
    found = subprocess.run([sys.executable, "-X", "importtime", *command], capture_output=True, text=True, check=True)
    modules = {line.rpartition("|")[2].strip() for line in found.stderr.splitlines()}
    return found.stdout, modules & {"numpy", "scipy", "h5py", "attr"}


# What `pip` makes of the entry point.
SCRIPT = "import sys; sys.argv[1:] = ['--version']; from problems.commands.script import main; main()"


@pytest.mark.parametrize(
    ("command", "printed"),
    [
        (("-c", "import continuation"), ""),
        (("-m", "continuation", "--version"), f"continuation {continuation.__version__}\n"),
        (("-c", SCRIPT), f"continuation {continuation.__version__}\n"),
    ],
)
def test_the_package_by_itself_and_its_version_import_nothing(command, printed):
    assert imported(*command) == (printed, set())


def test_every_name_is_that_of_the_module_which_the_imports_for_types_say():
    tree = ast.parse(Path(continuation.__file__).read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    said = {alias.name: node.module for node in block.body for alias in node.names}
    assert sorted(continuation.__all__) == sorted([*said, "__version__"])
    for name, module in said.items():
        assert getattr(continuation, name) is getattr(sys.modules[module], name)


def test_modules_are_found_by_name_and_others_are_not():
    code = "import continuation; print(continuation.jets.__name__, hasattr(continuation, 'nothing'))"
    assert imported("-c", code)[0] == "continuation.jets False\n"
    assert {"trace", "Path", "__version__"} <= set(dir(continuation))
    with pytest.raises(AttributeError, match="module 'continuation' has no attribute 'traces'"):
        continuation.traces  # noqa: B018


@pytest.mark.parametrize("name", ["continuation", "problems", "problems.lcp", "continuation.jets"])
def test_no_public_name_hides_a_module(name):
    package = importlib.import_module(name)
    for module in pkgutil.iter_modules(package.__path__):
        assert isinstance(getattr(package, module.name, package), ModuleType), f"{name}.{module.name}"
