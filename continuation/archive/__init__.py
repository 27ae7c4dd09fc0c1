"""The path archive: HDF5 files written during a trace, which `resume` continues exactly.

An archive holds tables of points and of paths. Each commit appends a checked block of rows and a checkpoint. Any
netCDF-4 tool (h5py, xarray) reads these files.
"""

from continuation.archive.atomic import ArchiveError, ArchiveExistsError
from continuation.archive.codec import SupportsArchive
from continuation.archive.reader import Archive, open_archive
from continuation.archive.resume import add_proof, recheck, resume
from continuation.archive.rows import Table
from continuation.archive.schema import SCHEMA
from continuation.archive.sweep import trace_many
from continuation.archive.transfer import describe, export, merge, recover
from continuation.archive.writer import Limits, PathLog

__all__ = [
    "SCHEMA",
    "Archive",
    "ArchiveError",
    "ArchiveExistsError",
    "Limits",
    "PathLog",
    "SupportsArchive",
    "Table",
    "add_proof",
    "describe",
    "export",
    "merge",
    "open_archive",
    "recheck",
    "recover",
    "resume",
    "trace_many",
]
