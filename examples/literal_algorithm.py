"""The algorithm of Dutta, Das and Jana as printed, beside the path that it means to follow.

Run it with ``python examples/literal_algorithm.py`` (about twenty seconds). On example 1 the algorithm ends at a point
that solves nothing, since it accepts whatever has ||H|| <= 1; on example 8 it takes 3,289 steps of length at most 1.
"""

from problems.literal import run_literally
from problems.paper import EXAMPLES
from problems.paper_report import show, trace_example


def main() -> None:
    print(f" #  printed  literal  {'its x':<34} residual  |  steps  {'traced x':<26} residual")
    for example in EXAMPLES:
        literal = run_literally(example.problem, example.x0, example.z1, example.z2)
        path = trace_example(example)
        x = path.endpoint.y[: example.q.size]
        print(
            f"{example.number:>2}  {example.printed_iterations:>7}  {literal.iterations:>7}  {show(literal.x, 4):<34}"
            f" {literal.residual:>8.0e}  |  {path.counts.accepted:>5}  {show(x, 4):<26}"
            f" {example.problem.natural_residual(x):>8.0e}"
        )


if __name__ == "__main__":
    main()
