"""Five hundred sections of the cusp in one file, and an analysis of that file with xarray alone.

`analyse` knows nothing of this library: it is what somebody runs who has only the file.
"""

import tempfile
from pathlib import Path

import numpy as np
import xarray


def write(file: Path, paths: int = 500) -> None:
    """mu + lambda x - x^3 = 0 over mu, lambda from -1 to 2: folds at mu = +-2 (lambda / 3)^(3/2) where lambda > 0."""
    from continuation.archive import trace_many
    from problems.bifurcation import Cusp

    with trace_many([Cusp(splitting) for splitting in np.linspace(-1.0, 2.0, paths)], archive=file) as archive:
        print(archive)


def analyse(file: Path) -> None:
    """How many paths turn, where, and how that depends on lambda."""
    data = xarray.open_dataset(file).load()
    flags = dict(zip(data.kind.flag_meanings.split(), data.kind.flag_values, strict=True))
    folds = data.isel(point=np.flatnonzero(data.kind == flags["turning_point"]))
    turns = folds.parameter.groupby(folds.path_index).count()
    print(f"{data.sizes['path']} paths, {turns.size} of them turn, {folds.sizes['point']} turning points")
    counts, edges = np.histogram(folds.parameter, bins=8)
    for count, low, high in zip(counts, edges, edges[1:]):
        print(f"  {low:8.3f} .. {high:8.3f}  {count:4d}  {'#' * (count // 3)}")
    exact = 2.0 * (data.homotopy_splitting[folds.path_index] / 3.0) ** 1.5
    print(f"largest distance from the formula: {float(abs(abs(folds.parameter) - exact).max()):.1e}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / "sections.h5")
        analyse(Path(folder) / "sections.h5")
