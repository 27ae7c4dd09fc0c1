"""The reliability report anew, point by point, two at a time: `make reliability`.

    python -m tests.reliability.run [--output build/reliability] [--share 1.0] [NUMBER ...]

`--share 0.1` is a tenth of each campaign; `table.md` has what was found.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path

from attrs import asdict

from .campaigns import Found
from .points import POINTS, Point

ROOT = Path(__file__).parents[2]


def tested(name: str) -> Found:
    """How many tests of a file pass."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", name]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    passed, failed = (sum(map(int, re.findall(rf"(\d+) {word}", done.stdout))) for word in ("passed", "failed"))
    return Found(passed, failed + (done.returncode != 0), f"{passed} tests pass")


def tried(index: int, k: int, size: int) -> Found:
    """The k-th campaign of a point, in this process."""
    campaign = POINTS[index].campaigns[k]
    if campaign.needs and find_spec(campaign.needs) is None:
        return Found(0, 0, f"not run: {campaign.needs} is not installed")
    with tempfile.TemporaryDirectory() as folder:
        return campaign.run(Path(folder), size)


def separately(job: tuple[int, int, int]) -> Found:
    """The same in a process of its own: campaigns fork, limit themselves, and replace functions."""
    command = [sys.executable, "-m", "tests.reliability.run", "--job", *map(str, job)]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    return Found(**json.loads(done.stdout)) if done.returncode == 0 else Found(0, 1, f"status {done.returncode}")


def table(points: Sequence[Point], found: Mapping[object, Found]) -> tuple[str, int]:
    """The report as a table, and how much is wrong in it; `found` by the function of a campaign, or the file."""
    rows, wrong = ["| | point | before | now |", "|---|---|---|---|"], 0
    for point in points:
        parts = [found[key] for key in (*point.tests, *(one.run for one in point.campaigns))]
        said = "; ".join(one.text + (f"; **{one.wrong} WRONG**" if one.wrong else "") for one in parts)
        rows.append(f"| {point.number} | {point.title} | {point.before} | {said} |")
        wrong += sum(one.wrong for one in parts)
    return "\n".join(rows) + "\n", wrong


def main() -> int:
    """Everything, and the table."""
    parser = argparse.ArgumentParser(description="The reliability report, anew.")
    parser.add_argument("points", nargs="*", metavar="NUMBER", help="as 2, 17 or H1; all by default")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "reliability")
    parser.add_argument("--share", type=float, default=1.0, help="of the full sizes")
    parser.add_argument("--job", nargs=3, type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.job:
        print(json.dumps(asdict(tried(*arguments.job))))
        return 0
    chosen = [(i, point) for i, point in enumerate(POINTS) if not arguments.points or point.number in arguments.points]
    # Each once: the same campaign, or file, may serve two points.
    campaigns = {
        one.run: (i, k, max(round(arguments.share * one.full), 1))
        for i, point in chosen
        for k, one in enumerate(point.campaigns)
    }
    tests = dict.fromkeys(test for _, point in chosen for test in point.tests)
    with ThreadPoolExecutor(2) as executor:
        found: dict[object, Found] = dict(zip(campaigns, executor.map(separately, campaigns.values())))
        found |= zip(tests, executor.map(tested, tests))
    text, wrong = table([point for _, point in chosen], found)
    arguments.output.mkdir(parents=True, exist_ok=True)
    (arguments.output / "table.md").write_text(text)
    print(text)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
