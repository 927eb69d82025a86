# SPDX-License-Identifier: Apache-2.0
"""Tables as Parquet: plain pages without compression, which every reader takes.

https://parquet.apache.org/docs/file-format. Debian packs no writer of it.
"""

from __future__ import annotations

import struct
from typing import Any, List, NamedTuple, Sequence, Tuple

import numpy as np

_INT32, _INT64, _BINARY, _LIST, _STRUCT = 5, 6, 8, 9, 12  # of Thrift's compact protocol
_TYPES = {"int": 2, "float": 5, "str": 6}  # INT64, DOUBLE, BYTE_ARRAY
_PLAIN, _RLE = 0, 3
_OPTIONAL, _UTF8 = 1, 0
_ROWS = 100_000  # of a group, which readers take one by one
_MAGIC = b"PAR1"

Value = Tuple[int, Any]  # type of Thrift, and what it is


class Column(NamedTuple):
    """kind: 'int', 'float' or 'str'. values: as many as there are rows; None where there is none."""

    name: str
    kind: str
    values: Sequence[Any]


def parquet(columns: Sequence[Column]) -> bytes:
    """A file of these columns. All may have None."""
    rows = len(columns[0].values)
    file = bytearray(_MAGIC)
    groups = []
    for first in range(0, rows, _ROWS):
        part = [one._replace(values=one.values[first:first + _ROWS]) for one in columns]
        groups.append(_group(part, file))
    schema = [_struct({4: _text("rows"), 5: (_INT32, len(columns))}), *(_element(one) for one in columns)]
    footer = _encoded(_struct({1: (_INT32, 1), 2: (_LIST, schema), 3: (_INT64, rows), 4: (_LIST, groups),
                               6: _text("fathom")}))
    return bytes(file) + footer + struct.pack("<i", len(footer)) + _MAGIC


def _element(column: Column) -> Value:
    fields = {1: (_INT32, _TYPES[column.kind]), 3: (_INT32, _OPTIONAL), 4: _text(column.name)}
    if column.kind == "str":
        fields |= {6: (_INT32, _UTF8), 10: _struct({1: _struct({})})}
    return _struct(fields)


def _group(columns: Sequence[Column], file: bytearray) -> Value:
    """Puts a page for each column at the end of the file."""
    start, chunks = len(file), []
    for column in columns:
        at, count = len(file), len(column.values)
        page = _page(column)
        about = _struct({1: (_INT32, count), 2: (_INT32, _PLAIN), 3: (_INT32, _RLE), 4: (_INT32, _RLE)})
        file += _encoded(_struct({1: (_INT32, 0), 2: (_INT32, len(page)), 3: (_INT32, len(page)), 5: about})) + page
        size = (_INT64, len(file) - at)
        told = _struct({1: (_INT32, _TYPES[column.kind]), 2: (_LIST, [(_INT32, _PLAIN), (_INT32, _RLE)]),
                        3: (_LIST, [_text(column.name)]), 4: (_INT32, 0), 5: (_INT64, count), 6: size, 7: size,
                        9: (_INT64, at)})
        chunks.append(_struct({2: (_INT64, at), 3: told}))
    return _struct({1: (_LIST, chunks), 2: (_INT64, len(file) - start), 3: (_INT64, len(columns[0].values))})


def _page(column: Column) -> bytes:
    """Which rows have a value, a bit each, and the values."""
    is_there = np.array([value is not None for value in column.values])
    bits = np.packbits(is_there, bitorder="little").tobytes()
    levels = _varint(len(bits) << 1 | 1) + bits
    values = [value for value in column.values if value is not None]
    return struct.pack("<i", len(levels)) + levels + _plain(column.kind, values)


def _plain(kind: str, values: List[Any]) -> bytes:
    if kind == "str":
        texts = [value.encode() for value in values]
        return b"".join(struct.pack("<i", len(text)) + text for text in texts)
    return np.array(values, "<i8" if kind == "int" else "<f8").tobytes()


# Thrift's compact protocol -------------------------------------------------------------------------

def _struct(fields: Any) -> Value:
    return _STRUCT, fields


def _text(value: str) -> Value:
    return _BINARY, value.encode()


def _varint(value: int) -> bytes:
    found = bytearray()
    while value > 0x7F:
        found.append(value & 0x7F | 0x80)
        value >>= 7
    found.append(value)
    return bytes(found)


def _encoded(value: Value) -> bytes:
    kind, what = value
    if kind == _STRUCT:
        return _encoded_struct(what)
    if kind == _LIST:
        short = len(what) < 15
        head = bytes([(len(what) if short else 15) << 4 | (what[0][0] if what else _STRUCT)])
        return head + (b"" if short else _varint(len(what))) + b"".join(_encoded(one) for one in what)
    if kind == _BINARY:
        return _varint(len(what)) + bytes(what)
    return _varint(what << 1 if what >= 0 else ~what << 1 | 1)  # zigzag


def _encoded_struct(fields: Any) -> bytes:
    found, last = bytearray(), 0
    for number, value in fields.items():
        found.append((number - last) << 4 | value[0])
        found += _encoded(value)
        last = number
    return bytes(found) + b"\0"
