"""Names of homotopies: found lazily, described from what they are, quarrels and broken imports said by name."""

import sys
from importlib.metadata import EntryPoint

import pytest

from continuation.arguments import plugins
from continuation.arguments.plugins import PluginError, available, called, describe, find
from problems.bifurcation import Cusp

NOISY = "noisy_plugin:Noisy"


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


def awkward(size: int = 0):
    """Fails."""
    raise ValueError(size)


def test_listing_imports_nothing_and_a_broken_plugin_hides_no_other(installed):
    installed(("noisy", NOISY), ("bad", "broken_plugin:Homotopy"), ("noisy", NOISY))
    assert list(available()) == ["bad", "noisy"]
    assert "noisy_plugin" not in sys.modules
    # The same entry found twice is one; a module and object need no registration.
    assert find("noisy") is find(NOISY)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bad", r"bad: broken_plugin:Homotopy .*RuntimeError: half installed"),
        ("same", r"same: expected one package .* noisy_plugin:Noisy.* and other_plugin:Noisy"),
        ("bratu", r"bratu: no homotopy of this name is installed; did you mean bratu-1d\?"),
        ("zzz", r"zzz: .* known are bad, bratu-1d, number, same"),
        ("number", "number: .*cannot be loaded: TypeError: 3 is not a callable object"),
        ("broken_plugin:Homotopy", "broken_plugin:Homotopy: cannot be loaded: RuntimeError"),
        ("noisy_plugin:Missing", "noisy_plugin:Missing: cannot be loaded: AttributeError"),
    ],
)
def test_what_is_no_plugin_is_named(installed, name, words):
    installed(
        ("bad", "broken_plugin:Homotopy"), ("same", NOISY), ("same", "other_plugin:Noisy"), ("bratu-1d", NOISY),
        ("number", "noisy_plugin:number"),
    )  # fmt: skip
    with pytest.raises(PluginError, match=words):
        find(name)


@pytest.mark.parametrize(
    ("made", "summary", "said", "references"),
    [
        (Spring, "A spring that hardens.", ["stiffness", "power=3", "name='k'"], Spring.references),
        (spring, "A spring without a choice of stiffness.", ["power=3"], Spring.references),
        (awkward, "Fails.", ["size=0"], ()),
    ],
)
def test_a_class_describes_itself_and_a_function_what_it_makes(made, summary, said, references):
    described = describe(made)
    assert described.summary == summary
    assert list(described.options) == said
    assert described.references == references
    assert (described.problem_class == "one degree of freedom") == (made is not awkward)


def test_options_are_given_by_name():
    assert called("spring", Spring, {"stiffness": 2.0}).stiffness == 2.0
    with pytest.raises(TypeError, match=r"size: expected an option of spring \(stiffness, power=3, name='k'\)"):
        called("spring", Spring, {"size": 1})
    with pytest.raises(TypeError, match="stiffness: expected a value, since spring has no default"):
        called("spring", Spring)
    assert describe(Cusp).options == ("splitting=1.0", "target=(computed)")
