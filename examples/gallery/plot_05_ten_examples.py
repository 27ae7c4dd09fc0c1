"""
Ten linear complementarity problems
===================================

The examples of Dutta, Das and Jana, each traced by the KKT homotopy from the paper's start, :math:`\\lambda = 1`, to
:math:`\\lambda = 0`. The last path turns twice.
"""

import matplotlib.pyplot as plt

from problems.paper import EXAMPLES
from problems.paper_figures import draw_example
from problems.paper_report import trace_example

paths = [trace_example(example) for example in EXAMPLES]
for example, path in zip(EXAMPLES, paths):
    x = path.endpoint.y[: example.q.size].round(6) + 0.0
    print(f"{example.number:2} {path.status.name}  {len(path):3} points  x = {', '.join(f'{value:g}' for value in x)}")

# %%
# One panel an example, named after the class of matrices that the paper gives for it. The matrix's true class may
# differ: "The paper, measured" has the details.

figure, panels = plt.subplots(5, 2, figsize=(7, 12), layout="constrained")
for example, path, axes in zip(EXAMPLES, paths, panels.ravel()):
    draw_example(example, path, axes)
names = [f"$x_{{{i}}}$" for i in range(EXAMPLES[-1].q.size)]
lines = axes.get_lines()[: len(names)]
figure.legend(lines, names, loc="outside lower center", ncols=len(names), frameon=False)
