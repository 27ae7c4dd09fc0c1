"""The path archive: HDF5 files written safely while paths are traced, resumed exactly, and read by anybody.

The idea: an archive is two tables, of points and of paths, that grow by checked blocks. A block is what one commit
writes: rows, a checksum of each column, a checkpoint; then a record that the block is whole (`store`, `checks`).
A reader takes whole blocks and compares them (`contents`). All else is "read whole blocks, append them elsewhere"
(`copies.Share`): merging, export and recovery (`transfer`), resuming, diagrams and the paths of a sweep.

The schema is `continuation-path-2` (`continuation.archive.schema`): h5py, xarray (engines h5netcdf and netCDF4) and
every netCDF-4 tool read it without this package.
"""

from continuation.archive.atomic import ArchiveError, ArchiveExistsError
from continuation.archive.certificates import add_proof, recheck
from continuation.archive.codec import SupportsArchive
from continuation.archive.page import describe
from continuation.archive.reader import Archive, open_archive
from continuation.archive.resume import resume
from continuation.archive.schema import SCHEMA
from continuation.archive.sweep import trace_many
from continuation.archive.tables import Table
from continuation.archive.transfer import export, merge, recover
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
