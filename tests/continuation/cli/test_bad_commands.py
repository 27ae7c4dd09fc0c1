"""Bad input to the shell: status 2 and one line on stderr that names the argument; never a traceback."""

import json

import h5py
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
    with h5py.File(folder / "foreign.h5", "w") as file:
        file["y"] = [1.0]
    for name, text in {
        "junk.npz": "junk", "junk.h5": "junk", "x.xyz": "1", "q3.txt": "1 2 3", "words.txt": "a b", "empty.txt": "",
        "bad.json": "{", "deep.json": "[" * 100_000, "A.csv": "2,1\n1,2\n", "syntax_of.py": "def (",
        "trouble.py": MODULE, "q.txt": "-5 -6",
    }.items():  # fmt: skip
        (folder / name).write_text(text)
    (folder / "good.json").write_text(json.dumps({"A": A.tolist(), "q": Q.tolist()}))
    trace(Cusp(), archive=folder / "ended.h5")
    trace(Cusp(), archive=folder / "half.h5", budget=Budget(steps=3))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.syspath_prepend(str(folder))
        yield folder


# What is typed, and how the one line begins after the program's name; behind dots, what comes later in it.
SOLVE = [
    *[(f"solve {file}", "FILE") for file in (
        ".", "junk.h5", "bad.json", "deep.json", "empty.txt", "A.csv", "good.json:/g",
        "junk.h5:/g", *(f"{name}.npz" for name in ("other", "objects", "complex", "empty", "text", "infinite")),
    )],
    ("solve gone.npz", "FILE: expected a file, found nothing"),
    ("solve junk.npz", "FILE: expected a .npz file, found one that cannot be read"),
    ("solve x.xyz", "FILE: expected one of .npz, .json"),
    ("solve nan.npz", "FILE: A: expected finite numbers, found nan"),
    ("solve wide.npz", "FILE: A: expected a square matrix, found shape (2, 3)"),
    ("solve short.npz", "FILE: q: expected 2 numbers, one a row of A, found 1"),
    ("solve order0.npz", "FILE: A: expected a square matrix, found shape (0, 0)"),
    ("solve A.csv --q gone.txt", "--q: expected a file, found nothing"),
    ("solve A.csv --q q3.txt", "--q: expected 2 numbers, one a row of A, found 3"),
    ("solve good.npz --x0 q3.txt", "--x0: expected 2 numbers, found 3"),
    ("solve good.npz --x0 x0.npz --homotopy kkt", "--x0: expected positive"),
    ("solve good.npz --archive good.npz", "--archive: good.npz: exists already, and is never overwritten"),
    ("solve good.npz --archive no/a.h5", "--archive: no/a.h5: there is no directory no"),
    ("solve good.npz --plot a.xyz", "--plot: expected a name in .png, .pdf, .svg"),
    ("solve good.npz --plot no/a.png", "--plot: expected a place to write to, found 'no/a.png' (No such"),
    ("solve gone.npz --seconds 0", "--budget-seconds/--seconds: expected a positive number"),
    *[(f"solve gone.npz {bad}", bad.split()[0]) for bad in (
        "--tolerance 2", "--seed -1", "--restarts 1.5",
    )],
    *[(f"solve A.csv --q {file}", "--q") for file in ("words.txt", ".", "empty.txt", "x.xyz")],
    *[(f"solve good.npz --x0 {file}", "--x0") for file in ("gone", "x0.npz")],
    ("solve good.npz --archive .", "--archive"),
    *[(f"solve good.npz --plot {file}", "--plot") for file in (".png", "a")],
    *[(f"solve good.npz --budget-seconds {value}", "--budget-seconds") for value in ("0", "-1", "nan", "x")],
    ("solve good.npz --homotopy simplex", "--homotopy: invalid choice: 'simplex' (choose from"),
    ("solve", "the following arguments are required: FILE"),
    ("solve good.npz extra", "unrecognized arguments: extra"),
    ("solve scene", "NAME: expected the name of a scene, found none"),
    ("solve scene blok", "blok: no scene of this name is installed; did you mean block?"),
    ("solve scene block mass=-1", "mass: expected a positive finite number, found -1"),
    ("solve scene block color=1", "color: expected an option of block"),
    ("solve scene block --x0 a.npy", "--x0: expected a problem in a file, found a scene"),
]  # fmt: skip
OTHERS = [
    ("", "the following arguments are required: COMMAND"),
    ("color", "COMMAND: invalid choice: 'color'"),
    ("--color", "the following arguments are required: COMMAND"),
    ("classify", "the following arguments are required: FILE"),
    *[(f"classify {name}.npz", "FILE") for name in ("nan", "other", "complex", "order0", "text", "empty")],
    ("classify wide.npz", "FILE ... (2, 3)"),
    ("classify gone.npz", "FILE: expected a file, found nothing"),
    *[(f"classify good.npz --width {value}", "--width") for value in ("0", "-5", "a", "1.5")],
    ("paper --methods kkt,color", "--methods: expected all or some of kkt, wang ... 'color'"),
    ("paper --output good.npz", "--output: expected a directory, or a new one"),
    ("chart color", "color: no study of this name"),
    ("chart --smoke --full", "--full"),
    ("plugins color", "color"),
    ("plugins trouble:", "trouble:"),
    ("check color", "color"),
    ("check cusp --steps 0", "--steps"),
]
TRACE = [
    ("trace", "the following arguments are required: NAME"),
    *[(f"trace {name}", name) for name in (
        "trouble:number", "trouble:nothing", "no_module:X", "syntax_of:X", "trouble:", ":Good", "os:getcwd",
    )],
    *[(f"trace cusp splitting={s}", "splitting") for s in ("abc", "nan", "1e400", "[1]", "None")],
    *[(f"trace exponential-cosine n={value}", "n") for value in ("0", "2.5", "-1", "True", "a")],
    *[(f"trace cusp {word}", "KEY=VALUE") for word in ("splitting", "=1", "1=2")],
    *[(f"trace kkt example={value}", "example") for value in ("0", "a")],
    ("trace color", "color: no homotopy of this name is installed"),
    ("trace bratu1d", "bratu1d ... did you mean bratu-1d"),
    ("trace trouble:gone", "trouble:gone: cannot be loaded: AttributeError"),
    ("trace trouble:NoStart", "trouble:NoStart: homotopy: expected a method `start`, found none on NoStart"),
    ("trace bratu-1d n=0", "n: expected at least 1, found 0"),
    ("trace bratu-1d n=many", "n: expected an integer, found 'many'"),
    ("trace bratu-1d m=3", "m: expected an option of bratu-1d (n=100, target=None)"),
    ("trace bratu-1d n", "KEY=VALUE: expected an option like n=10, found 'n'"),
    ("trace kkt file=gone.npz", "file: expected a file"),
    ("trace kkt example=11", "example: expected a number from 1 to 10, found 11"),
    ("trace circle --target soon", "--target: expected a finite number or none, found 'soon'"),
    ("trace circle --tolerance 0", "--tolerance: expected a positive number"),
    ("chart scenes --output good.npz", "--output: expected a directory"),
    ("trace circle --plot path.txt", "--plot: expected a name in .png"),
    ("check circle radius=2", "radius: expected an option of circle (none)"),
    ("trace cusp color=1", "color"),
    ("trace os:system", "command"),
    *[(f"trace cusp --{option} {value}", f"--{option}") for option, values in {
        "tolerance": ("-1", "nan", "inf", "abc"),
        "target": ("nan", "inf", "abc"),
        "direction": ("0", "2", "up"),
        "preset": ("quick",),
        "turning-points": ("0", "-1", "x"),
        "budget-steps": ("0", "-5", "1.5"),
        "budget-seconds": ("0", "nan", "-1"),
        "archive": ("no/a.h5", "good.npz", "."),
        "plot": ("no/a.png",),
    }.items() for value in values],
]  # fmt: skip
ARCHIVES = [
    *[(f"{command} {file}", "FILE") for command in ("inspect", "resume", "recover", "plot") for file in (
        "gone.h5", "junk.h5", ".", "good.npz",
    )],
    ("inspect", "the following arguments are required: FILE"),
    ("inspect junk.h5", "FILE ... is not an HDF5 file"),
    ("inspect foreign.h5", "FILE ... not an archive of paths"),
    ("resume ended.h5", "FILE ... nothing to resume"),
    ("resume half.h5", "FILE"),
    ("resume half.h5 --steps 0", "--steps: expected a positive integer, found '0'"),
    ("resume half.h5 --steps 20 --archive half.h5", "--archive"),
    ("resume half.h5 --steps 20 --trust color", "--trust"),
    ("resume half.h5 --steps 20 --trust no_module:X", "--trust"),
    ("export ended.h5 a.txt", "TARGET: expected a suffix .nc"),
    ("export ended.h5 half.h5", "TARGET"),
    ("export gone.h5 a.csv", "FILE"),
    ("export ended.h5 no/a.csv", "FILE"),
    ("merge m.h5", "the following arguments are required: FILE"),
    ("merge m.h5 gone.h5", "FILE"),
    ("merge half.h5 ended.h5", "OUT"),
    ("merge m.h5 ended.h5 junk.h5", "FILE"),
    ("merge no/m.h5 ended.h5", "FILE"),
    *[(f"plot ended.h5 --path {value}", "--path") for value in ("-1", "a")],
    ("plot ended.h5 --path 1", "--path: expected a number below 1, found 1"),
    ("plot ended.h5 --components 9", "--components: expected numbers from"),
    ("plot ended.h5 --components x", "--components: expected numbers like"),
    *[(f"plot ended.h5 --components {value}", "--components") for value in ("-1", "0,9")],
    ("plot ended.h5 --output a.xyz", "--output: expected a name in .png, .pdf, .svg"),
    ("plot ended.h5 --against time", "--against: invalid choice: 'time'"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "argument"), SOLVE + OTHERS + TRACE + ARCHIVES)
def test_one_line_that_names_the_argument(run, place, line, argument):
    err = run(*line.split(), status=BAD_INPUT).err
    start, _, more = argument.partition(" ... ")
    said = err.partition(": ")[2]
    assert said.startswith(start), err
    assert more in said
    assert len(err) < 500


def test_nothing_of_it_has_written_a_file(place):
    assert not {path.name for path in place.iterdir()} & {"a.h5", "a.nc", "a.csv", "m.h5", "a.png", "a", "s.h5"}
