"""The public names: all there, none hidden behind another."""

import importlib
import pkgutil
from types import ModuleType

import pytest

import continuation


@pytest.mark.parametrize("name", ["continuation", "problems", "problems.lcp", "continuation.jets"])
def test_no_public_name_hides_a_module(name):
    package = importlib.import_module(name)
    for module in pkgutil.iter_modules(package.__path__):
        assert isinstance(getattr(package, module.name, package), ModuleType), f"{name}.{module.name}"


def test_every_public_name_is_there_and_plug_in_points_are_among_them():
    assert all(hasattr(continuation, name) for name in continuation.__all__)
    points = {"Event", "Predictor", "Corrector", "Controller", "Metric", "Observer", "Homotopy"}
    assert points | {"Automatic", "EvaluationError", "Settings", "Options"} <= set(continuation.__all__)
