"""The pictures of the README and the documentation: ``python examples/draw_images.py [FOLDER]``; needs matplotlib."""

import sys
from pathlib import Path

from matplotlib.figure import Figure

import continuation
from continuation.plot import plot_bifurcation, plot_steps
from problems.bifurcation import Bratu1D
from problems.paper import EXAMPLES
from problems.paper_figures import draw_examples
from problems.paper_report import trace_example

FOLDER = Path(__file__).parent.parent / "docs" / "images"


def paper(file: Path) -> None:
    """The ten paths of the paper."""
    draw_examples(EXAMPLES, [trace_example(example) for example in EXAMPLES]).savefig(file, dpi=110)


def bratu(file: Path) -> None:
    """Bratu's problem through its fold, with the steps that the controller took."""
    upper_end = continuation.TargetValue(1.0, direction=-1)
    path = continuation.trace(Bratu1D(n=200), target=None, direction=1, events=[upper_end])
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    plot_bifurcation(path, left)
    plot_steps(path, right)
    left.set_title(f"fold at $\\lambda$ = {path.turning_points[0].lam:.9f}", fontsize="small")
    figure.savefig(file, dpi=110)


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (paper, bratu):
        file = folder / f"{draw.__name__}.png"
        draw(file)
        print(file)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
