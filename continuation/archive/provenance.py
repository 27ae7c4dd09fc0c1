"""Provenance: an archive's root attributes, and checkpoints with all that a path needs to go on."""

from __future__ import annotations

import json
import math
import os
import platform
import secrets
import socket
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from functools import lru_cache
from importlib import metadata
from typing import Any, Literal

import attrs
import h5py
import numpy as np
import scipy
from attrs import frozen

from continuation.archive.codec import (
    ENTRY_POINTS,
    UnknownError,
    UnstorableError,
    class_path,
    decode,
    described,
    encode,
    inline,
)
from continuation.archive.hdf5 import order
from continuation.archive.schema import SCHEMA
from continuation.step.settings import Settings
from continuation.step.state import State
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
    """Versions, BLAS and threads: they decide the last bits."""
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
    """Archive parameters without large arrays."""
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


HEAD = struct.Struct("<QQI")
"""Sequence number, length and CRC-32 of the body."""

OPTIONS = tuple(attrs.fields_dict(Settings))
"""The options of `continuation.Tracer` that determine a path."""

_INLINE_BYTES = 1 << 16


@frozen(eq=False)
class Checkpoint:
    """A point after `rows` rows from which a path continues exactly.

    `counts`, `seconds`: work so far. `run`: options and homotopy.
    """

    sequence: int
    path: int
    rows: int
    state: State
    counts: Mapping[str, int]
    seconds: float
    run: Mapping[str, Any]


def major(version: str) -> str:
    """The part of a version that files to resume share: "2" of 2.3.1, "0.2" of 0.2.5."""
    first, second, *_ = (*version.split("."), "")
    return first if first != "0" else f"0.{second}"


def _fetched(raw: bytes) -> Callable[[Any], Any]:
    made: list[np.ndarray[Any, Any]] = []

    def fetch(place: Any) -> Any:
        if place["number"] == len(made):
            begin = sum(array.nbytes for array in made)
            made.append(numbers(raw[begin:], place["dtype"], place["shape"]).copy())
        return made[place["number"]]

    return fetch


def numbers(raw: bytes, dtype: str, shape: Sequence[int], order: Literal["C", "F"] = "C") -> np.ndarray[Any, Any]:
    """The first bytes as an array; `ValueError` if it is not numeric or longer."""
    kind = np.dtype(dtype)
    count = math.prod(shape)
    if kind.kind not in "fiubc" or min(shape, default=0) < 0 or count * kind.itemsize > len(raw):
        raise ValueError(f"no array of {dtype!r:.20} of shape {shape!r:.60} in {len(raw)} bytes")
    return np.frombuffer(raw, kind, count).reshape(shape, order=order)


def describe_run(tracer: Tracer, first: bool = False) -> dict[str, Any]:
    """Options and homotopy as JSON, or why they are "unstorable".

    `first`: the problem group describes the homotopy.
    """
    values = {name: getattr(tracer.settings, name) for name in OPTIONS}
    own, watched = tuple(getattr(tracer.homotopy, "events", ())), tracer.settings.events
    if own:
        # A new tracer adds the homotopy's events again.
        begin = 0 if own[0] in watched[:1] else 1
        values["events"] = watched[begin + len(own) :]
    options = {name: described(value, _whole) for name, value in values.items()}
    homotopy = {"problem": True} if first else described(tracer.homotopy, _whole)
    return {"options": options, "homotopy": homotopy}


def _whole(name: str, array: Any) -> Any:
    if array.nbytes > _INLINE_BYTES:
        raise UnstorableError(f"{name} is an array of {array.nbytes} bytes in a homotopy that is not the file's first")
    lying = order(array)
    raw = array.tobytes(lying).hex()
    return {"dtype": array.dtype.str, "shape": list(array.shape), "order": lying, "hex": raw}


def whole(place: Any) -> Any:
    """The array, from JSON."""
    return numbers(bytes.fromhex(place["hex"]), place["dtype"], place["shape"], place["order"]).copy("K")


def pack(checkpoint: Checkpoint) -> bytes:
    """Head, JSON, run, arrays."""
    arrays: dict[int, np.ndarray[Any, Any]] = {}

    def place(name: str, array: Any) -> Any:
        arrays.setdefault(id(array), array)
        number = list(arrays).index(id(array))
        return {"number": number, "dtype": array.dtype.str, "shape": list(array.shape)}

    tree = {
        "version": __version__,
        "path": checkpoint.path,
        "rows": checkpoint.rows,
        "counts": dict(checkpoint.counts),
        "seconds": checkpoint.seconds,
        "state": encode(checkpoint.state, place),
    }
    raw = b"".join(np.ascontiguousarray(array).tobytes() for array in arrays.values())
    body = b"\n".join((json.dumps(tree).encode(), json.dumps(dict(checkpoint.run)).encode(), raw))
    return HEAD.pack(checkpoint.sequence, len(body), zlib.crc32(body)) + body


def unpack(raw: bytes) -> Checkpoint | None:
    """The checkpoint; None if missing, torn or of another major version. No class that the bytes name is imported."""
    try:
        sequence, length, crc = HEAD.unpack_from(raw)
        body = raw[HEAD.size : HEAD.size + length]
        if not length or len(body) < length or zlib.crc32(body) != crc:
            return None
        head, ran, arrays = body.split(b"\n", 2)
        tree, run = json.loads(head), dict(json.loads(ran))
        if major(str(tree["version"])) != major(__version__):
            return None
        state = decode(tree["state"], _fetched(arrays), hint=State)
        counts = {str(name): int(value) for name, value in tree["counts"].items()}
        path, rows, seconds = int(tree["path"]), int(tree["rows"]), float(tree["seconds"])
    except (struct.error, UnknownError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    sensible = _consistent(state) and path >= 0 and rows > 0
    return Checkpoint(sequence, path, rows, state, counts, seconds, run) if sensible else None


def _consistent(state: State) -> bool:
    knots = (*state.history, state.origin)
    vectors = [state.weights, *state.anchor, state.origin_weights, *(v for k in knots for v in (k.u, k.tangent))]
    return bool(state.history) and all(v.dtype == float and v.shape == (vectors[0].size,) for v in vectors)
