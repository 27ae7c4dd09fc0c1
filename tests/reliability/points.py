"""The points of the first reliability report, with what it counted, and what counts now: tests of theirs, campaigns.

Sizes: `smoke` in the suite, `full` for `make reliability`, which are at least those of the first report where something
held. The tests named are those of the suite, in the folders of what they test.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from attrs import frozen

from . import campaigns
from .campaigns import Found

ARCHIVE, LCP, BAD = "tests/continuation/archive/", "tests/problems/lcp/", "tests/continuation/bad_input/"


@frozen
class Campaign:
    """A campaign of a point, and its sizes; `needs` is a module that may be absent."""

    run: Callable[[Path, int], Found]
    smoke: int
    full: int
    needs: str = ""


@frozen
class Point:
    """One defect, or one thing that holds.

    Attributes
    ----------
    number : str
        As in the first report; H1, H2, ... are what held.
    title : str
    before : str
        The figures of the first report.
    tests : tuple of str
    campaigns : tuple of Campaign
    """

    number: str
    title: str
    before: str
    tests: tuple[str, ...] = ()
    campaigns: tuple[Campaign, ...] = ()


KILLS = Campaign(campaigns.kills, 3, 1332)
DAMAGE = Campaign(campaigns.damage, 20, 1723)
TRUTH = Campaign(campaigns.tally("truth"), 60, 54_000)
FULL = Campaign(campaigns.full, 4, 90)

POINTS = (
    Point("1", "opening an archive runs code", "7 of 7 operations", (ARCHIVE + "test_archive_trust.py",)),
    Point(
        "2", "a common factor of A and q changes the answer", "of 100 problems, 49 false SOLVED at 1e-12",
        (LCP + "test_units.py",), (Campaign(campaigns.tally("factor"), 12, 1000),),
    ),
    Point(
        "3", "a damaged CSR matrix corrupts memory", "SIGSEGV or SIGABRT in 5 of 9 variants",
        (LCP + "data/test_door.py", LCP + "data/test_hostile_files.py"),
    ),
    Point(
        "4", "recover, merge and export name a file before it is closed", "2 of 377 kills left it unreadable",
        (ARCHIVE + "test_archive_accidents.py", ARCHIVE + "test_archive_crash.py"), (KILLS,),
    ),
    Point(
        "5", "opening a damaged file never returns", "328 of 868 damaged files",
        (ARCHIVE + "test_archive_others.py",), (DAMAGE,),
    ),
    Point(
        "6", "Ctrl-C in lcp.solve ends one path, and the next begins", "19 signals in 40 s",
        ("tests/continuation/test_interrupted.py",), (Campaign(campaigns.interrupts, 5, 100),),
    ),
    Point(
        "7", "a worker of a sweep dies", "10 of 39 sweeps raised; half a path over dask",
        (ARCHIVE + "test_archive_workers.py", ARCHIVE + "test_archive_sweep.py"),
        (Campaign(campaigns.dask_sweep, 1, 6, "distributed"),),
    ),
    Point(
        "8", "two resumes of one file at once", "13 of 20 lost rows",
        (ARCHIVE + "test_archive_accidents.py",), (Campaign(campaigns.resumes, 2, 40),),
    ),
    Point(
        "9", "full disks and size limits", "13 of 28 without an ArchiveError; 76 of 76 archives refused",
        (ARCHIVE + "test_archive_accidents.py", "tests/continuation/cli/test_no_room.py"),
        (FULL,),
    ),
    Point(
        "10", "damaged numbers are read without a word", "289 of 1,723 files; 80 resumed to another path",
        (ARCHIVE + "test_archive_hostile.py",), (DAMAGE,),
    ),
    Point(
        "11", "lcp.solve raises, or warns, on finite data", "649 raised of 54,000, 1,027 warned",
        (LCP + "test_guarantees_strained.py",), (TRUTH,),
    ),
    Point(
        "12", "max_step that is NaN loops for ever", "no return in 15 s",
        ("tests/continuation/step/test_capabilities.py",),
    ),
    Point(
        "13", "wrong input is taken, a finish believed", "8 kinds",
        ("tests/continuation/step/test_capabilities.py", BAD + "test_bad_homotopies.py", LCP + "data/test_door.py"),
    ),
    Point("14", "names that no file can hold", "written, and not to be read", (ARCHIVE + "test_archive_accidents.py",)),
    Point("15", "modes, links, files of others, process ids", "4 defects", (ARCHIVE + "test_archive_accidents.py",)),
    Point(
        "16", "hostile HDF5", "/etc/passwd read, a FIFO hangs, MemoryError",
        (ARCHIVE + "test_archive_hostile.py", LCP + "data/test_hostile_files.py"),
    ),
    Point(
        "17", "bad input", "of 990: 117 obscure, 55 taken, 23 with warnings",
        (BAD, LCP + "test_bad_lcp_input.py", "tests/continuation/cli/test_bad_commands.py"),
        (Campaign(campaigns.bad_input, 1, 1),),
    ),
    Point(
        "18", "memory of a long path", "1.45 KB a point",
        (ARCHIVE + "test_archive_keep.py",), (Campaign(campaigns.memory, 1_000, 1_000_000),),
    ),
    Point("H1", "kills lose nothing that was committed", "1,332 kills, none lost; 410 resumed exactly", (), (KILLS,)),
    Point("H2", "files cut off", "114 clear errors of 114", (ARCHIVE + "test_archive_limits.py",), (DAMAGE,)),
    Point("H3", "files opened while they grow", "1,350, none wrong", (), (Campaign(campaigns.growing, 15, 1_350),)),
    Point("H4", "no room while tracing", "90 of 90", (), (FULL,)),
    Point(
        "H5", "claims about LCPs are true", "33,479 SOLVED and 11,420 UNSOLVABLE, none false", (),
        (TRUTH,),
    ),
    Point(
        "H6", "the same bits, whatever the hash seed, the threads of BLAS, or threads", "held", (),
        (Campaign(campaigns.determinism, 2, 6),),
    ),
    Point("H7", "memory over many solves", "flat over 20,000", (), (Campaign(campaigns.solves, 200, 20_000),)),
    Point("H8", "no pickle in files of problems", "held", (LCP + "data/test_hostile_files.py",)),
)  # fmt: skip
