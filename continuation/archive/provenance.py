"""Root attributes of an archive: what ran, when, with which software."""

from __future__ import annotations

import json
import os
import platform
import secrets
import socket
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import lru_cache
from importlib import metadata
from typing import Any

import h5py
import numpy as np
import scipy

from continuation.archive.checkpoint import OPTIONS
from continuation.archive.codec import ENTRY_POINTS, UnknownError, class_path, decode, described, inline
from continuation.archive.schema import SCHEMA
from continuation.step.tracer import Tracer
from continuation.version import __version__

_THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def now() -> str:
    """UTC time, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def history(attributes: Mapping[str, Any], what: str) -> dict[str, str]:
    """`history` with a new line (CF)."""
    line = f"{now()} {what} (continuation {__version__})"
    return {"history": "\n".join(filter(None, (attributes.get("history", ""), line)))}


@lru_cache
def software() -> dict[str, str]:
    """Versions; BLAS and threads decide the last bits."""
    blas = np.show_config(mode="dicts").get("Build Dependencies", {}).get("blas", {})
    given = [f"{os.environ[name]} ({name})" for name in _THREADS if name in os.environ]
    return {
        "library": "continuation",
        "library_version": __version__,
        "python_version": platform.python_version(),
        "numpy_version": np.__version__,
        "scipy_version": scipy.__version__,
        "h5py_version": h5py.__version__,
        "hdf5_version": h5py.version.hdf5_version,
        "blas": f"{blas.get('name', 'unknown')} {blas.get('version', '')}".strip(),
        "blas_threads": given[0] if given else f"{os.cpu_count()} (cores)",
        "machine": f"{platform.machine()} {platform.system()}",
        "host": socket.gethostname(),
    }


@lru_cache
def _entry_point(path: str) -> metadata.EntryPoint | None:
    return next((point for point in metadata.entry_points(group=ENTRY_POINTS) if point.value == path), None)


def process() -> dict[str, Any]:
    """The writing process."""
    return {"created": now(), "process": np.int64(os.getpid()), **software()}


def parameters(homotopy: Any) -> dict[str, Any]:
    """Public fields or attributes of the homotopy."""
    slots = (getattr(cls, "__slots__", ()) for cls in type(homotopy).__mro__)
    names = [name for own in slots for name in ((own,) if isinstance(own, str) else own)]
    names += [name for name in getattr(homotopy, "__dict__", {}) if name.isidentifier()]
    public = (name for name in dict.fromkeys(names) if not name.startswith("_"))
    return {name: getattr(homotopy, name) for name in public if hasattr(homotopy, name)}


def scalars(homotopy: Any) -> dict[str, float]:
    """Numeric parameters; None becomes NaN."""
    return {
        name: np.nan if value is None else float(value)
        for name, value in parameters(homotopy).items()
        if value is None or (isinstance(value, (bool, int, float, np.number)) and not isinstance(value, complex))
    }


def stored_parameters(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """The archive's parameters without large arrays."""
    found = {}
    with suppress(ValueError, AttributeError):
        tree = json.loads(str(attributes.get("parameters", "{}")))
        for name, value in tree.get("dict", tree).items():
            with suppress(UnknownError):
                found[str(name)] = decode(value, lambda place: np.array(place["values"], dtype=place["dtype"]))
    return found


def root_attributes(tracer: Tracer | None, title: str, made_with: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes of a new archive.

    `made_with`: parameters that the homotopy's attributes lack.
    """
    attributes: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "featureType": "trajectory",
        "schema": SCHEMA,
        "title": title,
        "identifier": secrets.token_hex(8),
        **process(),
        **history({}, "created"),
    }
    if tracer is None:
        return attributes
    homotopy = tracer.homotopy
    path, own = class_path(type(homotopy)), {**parameters(homotopy), **made_with}
    point = _entry_point(path)
    dist = None if point is None else point.dist
    return attributes | {
        "title": title or f"Paths of {type(homotopy).__name__}",
        "homotopy": path,
        "homotopy_entry_point": point.name if point is not None else "",
        "homotopy_distribution": "" if dist is None else f"{dist.name} {dist.version}",
        "parameters": json.dumps({name: described(value, inline) for name, value in own.items()}),
        **tracer.path.labels.attributes(),
        "settings": json.dumps({name: described(getattr(tracer.settings, name), inline) for name in OPTIONS}),
        "references": "\n\n".join(tracer.references),
    }
