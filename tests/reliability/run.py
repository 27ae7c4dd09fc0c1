"""The reliability report anew, point by point, two at a time: `make reliability`.

    python -m tests.reliability.run [--output build/reliability] [--share 1.0] [NUMBER ...]

Each campaign writes its figures when it is done, and `table.md` is made of those that are there, so that one that was
interrupted goes on where it was. `--share 0.1` is a tenth of each.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from .points import POINTS, Campaign, Point

ROOT = Path(__file__).parents[2]
Job = tuple[str, int]
"""The name of what is run, and its size; 0 for tests."""


def job_of(campaign: Campaign, share: float) -> Job:
    """What is run for it: the same campaign may serve two points."""
    index = next(
        (i, k) for i, point in enumerate(POINTS) for k, one in enumerate(point.campaigns) if one.run is campaign.run
    )
    return f"campaign-{index[0]}-{index[1]}", max(round(share * campaign.full), 1)


def campaign_of(name: str) -> Campaign:
    """The campaign of a job."""
    _, i, k = name.split("-")
    return POINTS[int(i)].campaigns[int(k)]


def jobs(points: list[Point], share: float) -> list[Job]:
    """Each campaign and each file of tests once, the longest first, so that two processes end together."""
    wanted = {job_of(one, share): None for point in points for one in point.campaigns}
    tests = {(f"tests {test}", 0): None for point in points for test in point.tests}
    return [*sorted(wanted, key=lambda job: -job[1]), *tests]


def file_of(output: Path, name: str) -> Path:
    """Where a job's figures go."""
    return output / (re.sub(r"\W+", "-", name).strip("-") + ".json")


def done(output: Path, job: Job) -> dict[str, Any] | None:
    """What is known of a job of this size, from now or before."""
    file = file_of(output, job[0])
    if not file.exists():
        return None
    found: dict[str, Any] = json.loads(file.read_text())
    return found if found["size"] == job[1] else None


def do(output: Path, job: Job) -> None:
    """Run a job, in this process, and write its figures."""
    name, size = job
    if size == 0:
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", name.removeprefix("tests ")]
        found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        passed, failed = (sum(map(int, re.findall(rf"(\d+) {word}", found.stdout))) for word in ("passed", "failed"))
        counted = {"done": passed, "wrong": failed + (found.returncode != 0), "text": f"{passed} tests"}
        if counted["wrong"]:
            print(found.stdout[-2000:], flush=True)
    else:
        campaign = campaign_of(name)
        if campaign.needs and find_spec(campaign.needs) is None:
            counted = {"done": 0, "wrong": 0, "text": f"not run: {campaign.needs} is not installed"}
        else:
            with tempfile.TemporaryDirectory() as folder:
                result = campaign.run(Path(folder), size)
            counted = {"done": result.done, "wrong": result.wrong, "text": result.text}
    # Of the processor, with its children's: the machine may be busy with something else.
    file_of(output, name).write_text(json.dumps({**counted, "size": size, "seconds": sum(os.times()[:4])}))


def table(output: Path, points: list[Point], share: float) -> tuple[str, int]:
    """The report as a table, and how much is wrong or missing in it."""
    rows, wrong = ["| | point | before | now |", "|---|---|---|---|"], 0
    for point in points:
        parts = []
        known = [done(output, job_of(one, share)) for one in point.campaigns]
        tests = [done(output, (f"tests {test}", 0)) for test in point.tests]
        if tests and all(tests):
            parts.append(f"{sum(one['done'] for one in tests if one)} tests pass")
        parts += ["not run" if one is None else one["text"] for one in known]
        for one in (*known, *tests):
            wrong += 1 if one is None else one["wrong"]
            if one is not None and one["wrong"]:
                parts.append(f"**{one['wrong']} WRONG**")
        rows.append(f"| {point.number} | {point.title} | {point.before} | {'; '.join(parts) or 'not run'} |")
    spent = sum(found["seconds"] for job in jobs(points, share) if (found := done(output, job)))
    return "\n".join([*rows, "", f"{spent / 60:.0f} minutes of the processor"]) + "\n", wrong


def main() -> int:
    """Everything that was not done before, and the table."""
    parser = argparse.ArgumentParser(description="The reliability report, anew.")
    parser.add_argument("points", nargs="*", metavar="NUMBER", help="as 2, 17 or H1; all by default")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "reliability")
    parser.add_argument("--share", type=float, default=1.0, help="of the full sizes")
    parser.add_argument("--job", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    output: Path = arguments.output
    output.mkdir(parents=True, exist_ok=True)
    if arguments.job:
        do(output, (arguments.job[0], int(arguments.job[1])))
        return 0
    points = [point for point in POINTS if not arguments.points or point.number in arguments.points]

    def separately(job: Job) -> None:
        # A process for each: campaigns fork, limit themselves, and replace functions.
        command = [sys.executable, "-m", "tests.reliability.run", "--output", str(output), "--job", *map(str, job)]
        status = subprocess.run(command, cwd=ROOT, check=False).returncode
        print(f"{job[0]}: {'done' if status == 0 else f'STATUS {status}'}", flush=True)

    missing = [job for job in jobs(points, arguments.share) if done(output, job) is None]
    with ThreadPoolExecutor(2) as executor:
        list(executor.map(separately, missing))
    text, wrong = table(output, points, arguments.share)
    (output / "table.md").write_text(text)
    print(text)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
