"""No import circles, and an engine that knows no problems: all imports, those inside functions and for types too."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[1]

UPWARDS = {("continuation.path.path", "continuation.archive.growing")}
"""`Path.save`, `to_xarray` and `to_dataframe`: a path is below the archive that reads paths. No other arrow runs up."""


def modules(root, *packages):
    """Dotted name to source of every module; a package goes by its own name."""
    files = [file for package in packages for file in sorted((root / package).rglob("*.py"))]
    return {
        ".".join((file.parent if file.stem == "__init__" else file.with_suffix("")).relative_to(root).parts): file
        for file in files
    }


def imports(name, file):
    """Every dotted name that a module imports, `from a import b` as a.b; Python's own import of parents is no part."""
    package = name.split(".") if file.stem == "__init__" else name.split(".")[:-1]
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            yield from (f"{source}.{alias.name}" for alias in node.names)


def graph(root, *packages):
    """The modules that each module imports; a name that is no module comes from the module that holds it."""
    known = modules(root, *packages)
    found = {}
    for name, file in known.items():
        wanted = (target if target in known else target.rpartition(".")[0] for target in imports(name, file))
        found[name] = {
            target for target in wanted if target in known and target != name and (name, target) not in UPWARDS
        }
    return found


def test_no_module_imports_itself_by_way_of_others():
    # A CycleError names the modules of a circle.
    TopologicalSorter(graph(ROOT, "continuation", "problems")).prepare()


def test_the_engine_imports_no_problems():
    outside = {
        (name, target)
        for name, file in modules(ROOT, "continuation").items()
        for target in imports(name, file)
        if target.split(".")[0] == "problems"
    }
    assert outside == set()
