"""Real matrices, dense and sparse, of MAT-files of level 5 (MATLAB 5 to 7), every length and type checked.

`scipy.io.loadmat` believes a file's numbers of types, and a damaged one ends the process. The format is that of
"MAT-File Format" (The MathWorks).
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Matrix

_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_MATRIX, _COMPRESSED = 14, 15
_SPARSE, _NUMERIC = 5, range(6, 16)
"""Classes of matrices; the others are cells, structures, objects and text."""

_COMPLEX = 0x800
_HEAD = 128

Elements = Iterator[tuple[int, memoryview]]


def read_level5(raw: bytes, limit: int) -> Mapping[str, Any]:
    """The variables of a file by name; of what is no real matrix a word for what it is.

    `raw`: The file. `limit`: Bytes that all its compressed variables may unfold to. Raises `ValueError` if it is of
    another level, or damaged.
    """
    order = {b"IM": "<", b"MI": ">"}.get(raw[126:_HEAD])
    if order is None or struct.unpack(order + "H", raw[124:126])[0] != 0x100:
        raise ValueError("it is no MAT-file of the versions 5 to 7; save it with -v7")
    found: dict[str, Any] = {}
    for kind, data in _elements(memoryview(raw)[_HEAD:], order):
        inner: Elements = iter([(kind, data)])
        if kind == _COMPRESSED:
            whole = _unfolded(data, limit)
            limit -= len(whole)
            inner = _elements(memoryview(whole), order)
        for kind_within, body in inner:
            if kind_within == _MATRIX and len(body):
                name, value = _variable(body, order)
                found[name] = value
    return found


def _unfolded(data: memoryview, limit: int) -> bytes:
    unfolding = zlib.decompressobj()
    whole = unfolding.decompress(data, limit + 1)
    if len(whole) > limit:
        raise ValueError(f"it unfolds to more than the limit of {limit} bytes")
    if not unfolding.eof:
        raise ValueError("a compressed variable is cut off")
    return whole


def _elements(data: memoryview, order: str) -> Elements:
    """Type and content of one element after another."""
    at = 0
    while at < len(data):
        if len(data) - at < 8:
            raise ValueError("it is cut off")
        kind, size = struct.unpack_from(order + "II", data, at)
        begin = at + 8
        if kind >> 16:
            # A short one has its length in the upper half of the word, and its content in the place of the length.
            kind, size, begin = kind & 0xFFFF, kind >> 16, at + 4
        if size > (4 if begin == at + 4 else len(data) - begin):
            raise ValueError(f"it claims {size} bytes where {len(data) - begin} are left")
        yield kind, data[begin : begin + size]
        at = at + 8 if begin == at + 4 else begin + (size if kind == _COMPRESSED else -(-size // 8) * 8)


def _variable(body: memoryview, order: str) -> tuple[str, Any]:
    parts = _elements(body, order)
    flags = _numbers(next(parts, (0, body[:0])), order)
    shape = tuple(_numbers(next(parts, (0, body[:0])), order).tolist())
    name = bytes(next(parts, (0, body[:0]))[1]).decode("latin-1")
    if not flags.size or len(shape) < 2 or min(shape) < 0:
        raise ValueError(f"the head of the variable {name!r} is damaged")
    kind, complex_numbers = int(flags[0]) & 0xFF, int(flags[0]) & _COMPLEX
    if complex_numbers or kind not in (_SPARSE, *_NUMERIC):
        return name, "complex numbers" if complex_numbers else "no matrix of numbers"
    return name, _sparse(parts, shape, order) if kind == _SPARSE else _dense(parts, shape, order)


def _dense(parts: Elements, shape: tuple[int, ...], order: str) -> Matrix:
    values = _numbers(next(parts, (9, memoryview(b""))), order)
    if values.size != math.prod(shape):
        raise ValueError(f"a matrix of shape {shape} has {values.size} numbers")
    return values.reshape(shape, order="F")


def _sparse(parts: Elements, shape: tuple[int, ...], order: str) -> Matrix:
    rows, starts, values = (_numbers(next(parts, (9, memoryview(b""))), order) for _ in range(3))
    if len(shape) != 2 or starts.size != shape[1] + 1 or not 0 <= starts[-1] <= min(rows.size, values.size):
        raise ValueError(f"a sparse matrix of shape {shape} has {values.size} numbers in {starts.size - 1} columns")
    count = int(starts[-1])
    return sp.csc_array((values[:count].astype(float), rows[:count].astype("i4"), starts.astype("i4")), shape=shape)


def _numbers(element: tuple[int, memoryview], order: str) -> np.ndarray[Any, Any]:
    kind, data = element
    if kind not in _NUMBERS:
        raise ValueError(f"it holds numbers of the type {kind}, which does not exist")
    return np.frombuffer(data, np.dtype(order + _NUMBERS[kind])).astype("=" + _NUMBERS[kind])
