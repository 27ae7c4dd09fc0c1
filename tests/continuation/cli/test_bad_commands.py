"""Bad input to the shell: status 2 and one line on stderr that names the argument; never a traceback."""

import json

import numpy as np
import pytest

from continuation import Budget, trace
from continuation.cli import BAD_INPUT
from problems.bifurcation import Cusp

A, Q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])
NAN = np.nan
CONTENTS = {
    "nan": {"A": A * NAN, "q": Q},
    "short": {"A": A, "q": Q[:1]},
    "other": {"B": A},
    "objects": {"A": np.array([[1, "a"], [2, 3]], object), "q": Q},
    "complex": {"A": A + 1j, "q": Q},
    "empty": {},
    "order0": {"A": np.zeros((0, 0)), "q": np.zeros(0)},
    "text": {"A": np.array([["a", "b"], ["c", "d"]]), "q": Q},
    "infinite": {"A": A, "q": [np.inf, 1]},
    "wide": {"A": np.ones((2, 3)), "q": Q},
    "unsolvable": {"A": -np.eye(2), "q": [-1.0, -1.0]},
    "good": {"A": A, "q": Q},
}
MODULE = """
class Good:
    target = 1.0
    def start(self): return [0.0], 0.0
    def residual(self, y, lam): return [y[0] - lam]
class NoStart: pass
instance, number = Good(), 5
def nothing(): return None
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Files of all kinds of trouble, in the working directory."""
    folder = tmp_path_factory.mktemp("shell")
    for name, arrays in CONTENTS.items():
        np.savez(folder / f"{name}.npz", **arrays)
    np.savez(folder / "x0.npz", x0=[-1.0, 1.0])
    for name, text in {
        "junk.npz": "junk", "junk.h5": "junk", "x.xyz": "1", "q3.txt": "1 2 3", "words.txt": "a b", "empty.txt": "",
        "bad.json": "{", "deep.json": "[" * 100_000, "A.csv": "2,1\n1,2\n", "syntax_of.py": "def (",
        "trouble.py": MODULE, "q.txt": "-5 -6",
    }.items():  # fmt: skip
        (folder / name).write_text(text)
    (folder / "good.json").write_text(json.dumps({"A": A.tolist(), "q": Q.tolist()}))
    trace(Cusp(), archive=folder / "ended.h5")
    trace(Cusp(), archive=folder / "half.h5", budget=Budget(steps=10))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.syspath_prepend(str(folder))
        yield folder


# What is typed, and the word that the one line begins with after the program's name.
SOLVE = [
    *[(f"solve {file}", "FILE") for file in (
        "gone.npz", ".", "x.xyz", "junk.npz", "junk.h5", "bad.json", "deep.json", "empty.txt", "A.csv", "good.json:/g",
        "junk.h5:/g", *(f"{name}.npz" for name in list(CONTENTS)[:-2]),
    )],
    *[(f"solve A.csv --q {file}", "--q") for file in ("q3.txt", "words.txt", "gone.txt", ".", "empty.txt", "x.xyz")],
    *[(f"solve good.npz --x0 {file}", "--x0") for file in ("x0.npz", "q3.txt", "gone", "x0.npz --relaxed")],
    *[(f"solve good.npz --archive {file}", "--archive") for file in ("no/a.h5", "good.npz", ".")],
    *[(f"solve good.npz --plot {file}", "--plot") for file in ("a.xyz", "no/a.png", ".png", "a")],
    *[(f"solve good.npz --budget-seconds {value}", "--budget-seconds") for value in ("0", "-1", "nan", "x")],
    ("solve good.npz --homotopy simplex", "--homotopy"),
    ("solve", "the following arguments are required: FILE"),
    ("solve good.npz extra", "unrecognized arguments: extra"),
]  # fmt: skip
OTHERS = [
    ("", "the following arguments are required: COMMAND"),
    ("color", "COMMAND"),
    ("--color", "the following arguments are required: COMMAND"),
    ("classify", "the following arguments are required: FILE"),
    *[(f"classify {name}.npz", "FILE") for name in ("nan", "other", "complex", "order0", "wide", "text", "empty")],
    *[(f"classify good.npz --width {value}", "--width") for value in ("0", "-5", "a", "1.5")],
    ("paper --methods color", "--methods"),
    ("paper --output good.npz", "--output"),
    ("chart color", "NAME"),
    ("chart --smoke --full", "--full"),
    ("plugins color", "color"),
    ("plugins trouble:", "trouble:"),
    ("check color", "color"),
    ("check cusp --steps 0", "--steps"),
]
TRACE = [
    ("trace", "the following arguments are required: NAME"),
    *[(f"trace {name}", name) for name in (
        "color", "trouble:gone", "trouble:number", "trouble:nothing", "trouble:NoStart", "no_module:X", "syntax_of:X",
        "trouble:", ":Good", "os:getcwd",
    )],
    *[(f"trace cusp splitting={s}", "splitting") for s in ("abc", "nan", "1e400", "[1]", "None", "1 splitting=2")],
    *[(f"trace exponential-cosine n={value}", "n") for value in ("0", "2.5", "-1", "True", "a")],
    *[(f"trace cusp {word}", "KEY=VALUE") for word in ("splitting", "=1", "1=2")],
    *[(f"trace kkt example={value}", "example") for value in ("0", "11", "a")],
    ("trace cusp color=1", "color"),
    ("trace os:system", "command"),
    *[(f"trace cusp --{option} {value}", f"--{option}") for option, values in {
        "tolerance": ("0", "-1", "nan", "inf", "abc"),
        "target": ("nan", "inf", "abc"),
        "direction": ("0", "2", "up"),
        "preset": ("quick",),
        "turning-points": ("0", "-1", "x"),
        "budget-steps": ("0", "-5", "1.5"),
        "budget-seconds": ("0", "nan", "-1"),
        "archive": ("no/a.h5", "good.npz", "."),
        "plot": ("a.xyz", "no/a.png"),
        "chart": ("good.npz",),
        "chart-tolerances": ("a", "0", "1e-3,x"),
    }.items() for value in values],
]  # fmt: skip
ARCHIVES = [
    *[(f"{command} {file}", "FILE") for command in ("inspect", "resume", "recover", "plot") for file in (
        "gone.h5", "junk.h5", ".", "good.npz",
    )],
    ("inspect", "the following arguments are required: FILE"),
    ("resume ended.h5", "FILE"),
    ("resume half.h5", "FILE"),
    ("resume half.h5 --steps 0", "--steps"),
    ("resume half.h5 --steps 20 --archive half.h5", "--archive"),
    ("resume half.h5 --steps 20 --trust color", "--trust"),
    ("resume half.h5 --steps 20 --trust no_module:X", "--trust"),
    ("export ended.h5 a.txt", "TARGET"),
    ("export ended.h5 half.h5", "TARGET"),
    ("export gone.h5 a.csv", "FILE"),
    ("export ended.h5 no/a.csv", "FILE"),
    *[(f"export ended.h5 a.nc --compression {value}", "--compression") for value in ("99", "-1", "x")],
    ("merge m.h5", "the following arguments are required: FILE"),
    ("merge m.h5 gone.h5", "FILE"),
    ("merge half.h5 ended.h5", "OUT"),
    ("merge m.h5 ended.h5 junk.h5", "FILE"),
    ("merge no/m.h5 ended.h5", "FILE"),
    *[(f"plot ended.h5 --path {value}", "--path") for value in ("5", "-1", "a")],
    *[(f"plot ended.h5 --components {value}", "--components") for value in ("9", "a", "-1", "0,9")],
    ("plot ended.h5 --output a.xyz", "--output"),
    ("plot ended.h5 --against time", "--against"),
    ("plot ended.h5 --diagram --components 0,0", "--components"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "argument"), SOLVE + OTHERS + TRACE + ARCHIVES)
def test_one_line_that_names_the_argument(run, place, line, argument):
    status, _, err = run(*line.split())
    assert status == BAD_INPUT, err
    said = err.partition(": ")[2]
    assert said.startswith(argument), err
    assert len(err) < 500


@pytest.mark.parametrize("words", [("solve", ""), ("trace", "cusp", "--archive", ""), ("trace", "cusp", "--plot", "")])
def test_an_argument_of_no_letters(run, place, words):
    assert run(*words)[0] == BAD_INPUT


def test_nothing_of_it_has_written_a_file(place):
    assert not {path.name for path in place.iterdir()} & {"a.h5", "a.nc", "a.csv", "m.h5", "a.png", "a", "s.h5"}
