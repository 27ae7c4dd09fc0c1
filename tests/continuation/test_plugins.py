"""Names of homotopies: found lazily, described from what they are, quarrels and broken imports said by name."""

import sys
from importlib.metadata import EntryPoint

import pytest

from continuation.arguments import plugins
from continuation.arguments.plugins import PluginError, available, describe, find, make, options


@pytest.fixture
def installed(monkeypatch, tmp_path):
    """Entry points as if packages had them: (name, value) pairs."""
    (tmp_path / "broken_plugin.py").write_text("raise RuntimeError('half installed')\n")
    (tmp_path / "noisy_plugin.py").write_text("imported = True\nclass Noisy: pass\nnumber = 3\n")
    monkeypatch.syspath_prepend(tmp_path)

    def install(*pairs):
        points = [EntryPoint(name, value, plugins.GROUP) for name, value in pairs]
        monkeypatch.setattr(plugins, "entry_points", lambda group: points)

    yield install
    for module in ("broken_plugin", "noisy_plugin"):
        sys.modules.pop(module, None)


class Spring:
    """A spring that hardens.

    More.
    """

    problem_class = "one degree of freedom"
    references = ("@misc{Spring,\n title = {On springs},\n}",)

    def __init__(self, stiffness: float, power: int = 3, *, name: str = "k"):
        self.stiffness = stiffness


def spring(power: int = 3) -> Spring:
    """A spring without a choice of stiffness."""
    return Spring(1.0, power)


def test_listing_imports_nothing(installed):
    installed(("noisy", "noisy_plugin:Noisy"), ("bad", "broken_plugin:Homotopy"))
    assert list(available()) == ["bad", "noisy"]
    assert "noisy_plugin" not in sys.modules


def test_a_broken_plugin_hides_no_other_and_is_named(installed):
    installed(("bad", "broken_plugin:Homotopy"), ("noisy", "noisy_plugin:Noisy"))
    assert find("noisy").__name__ == "Noisy"
    with pytest.raises(PluginError, match=r"bad: broken_plugin:Homotopy .*RuntimeError: half installed"):
        find("bad")


def test_one_name_from_two_packages_names_both(installed):
    installed(("same", "noisy_plugin:Noisy"), ("same", "other_plugin:Noisy"))
    with pytest.raises(PluginError, match=r"same: expected one package .* noisy_plugin:Noisy.* and other_plugin:Noisy"):
        find("same")


def test_the_same_entry_found_twice_is_one(installed):
    installed(("same", "noisy_plugin:Noisy"), ("same", "noisy_plugin:Noisy"))
    assert find("same").__name__ == "Noisy"


def test_an_unknown_name_gets_suggestions(installed):
    installed(("bratu-1d", "noisy_plugin:Noisy"))
    with pytest.raises(PluginError, match=r"bratu: no homotopy of this name is installed; did you mean bratu-1d\?"):
        find("bratu")
    with pytest.raises(PluginError, match=r"zzz: .* known are bratu-1d"):
        find("zzz")


def test_what_cannot_be_called_is_no_plugin(installed):
    installed(("number", "noisy_plugin:number"))
    with pytest.raises(PluginError, match="number: expected a class or function that makes a homotopy, found int"):
        find("number")


def test_a_module_and_object_need_no_registration(installed):
    installed()
    assert find("noisy_plugin:Noisy").__name__ == "Noisy"
    with pytest.raises(PluginError, match="broken_plugin:Homotopy: cannot be loaded: RuntimeError"):
        find("broken_plugin:Homotopy")
    with pytest.raises(PluginError, match="noisy_plugin:Missing: cannot be loaded: AttributeError"):
        find("noisy_plugin:Missing")


def test_a_class_describes_itself():
    described = describe(Spring)
    assert described.summary == "A spring that hardens."
    assert [str(option) for option in described.options] == ["stiffness", "power=3", "name='k'"]
    assert described.options[0].required
    assert described.problem_class == "one degree of freedom"
    assert described.references == Spring.references


def test_a_function_is_described_by_what_it_makes():
    described = describe(spring)
    assert described.summary == "A spring without a choice of stiffness."
    assert described.problem_class == "one degree of freedom"


def test_a_function_that_fails_without_arguments_is_still_described():
    def awkward(size: int = 0):
        """Fails."""
        raise ValueError(size)

    assert describe(awkward).summary == "Fails."
    assert describe(awkward).references == ()


def test_options_are_given_by_name(installed, monkeypatch):
    installed(("spring", "noisy_plugin:Spring"))
    monkeypatch.setattr(plugins, "find", lambda name: Spring)
    assert make("spring", {"stiffness": 2.0}).stiffness == 2.0
    with pytest.raises(TypeError, match=r"size: expected an option of spring \(stiffness, power=3, name='k'\)"):
        make("spring", {"size": 1})
    with pytest.raises(TypeError, match="stiffness: expected a value, since spring has no default"):
        make("spring")


def test_a_default_that_is_computed_is_said_to_be():
    from problems.bifurcation import Cusp

    assert [str(option) for option in options(Cusp)] == ["splitting=1.0", "target=(computed)"]
