# SPDX-License-Identifier: Apache-2.0
"""Tables as Parquet, read by a reader that knows the format from its documents alone; by pyarrow where there is one."""

import io
import struct

import fathom
import numpy as np
import pytest
from fathom._parquet import Column, parquet
from pictures import noise, stack


class Thrift:
    """The compact protocol: structs as {number: value}, lists as lists."""

    def __init__(self, data, at):
        self.data, self.at = data, at

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def varint(self):
        value, shift = 0, 0
        while True:
            one = self.byte()
            value |= (one & 127) << shift
            shift += 7
            if one < 128:
                return value

    def value(self, kind):
        if kind in (5, 6):
            raw = self.varint()
            return -(raw + 1) // 2 if raw & 1 else raw // 2
        if kind == 8:
            count = self.varint()
            self.at += count
            return self.data[self.at - count:self.at]
        if kind == 9:
            head = self.byte()
            count = head >> 4 if head >> 4 < 15 else self.varint()
            return [self.value(head & 15) for _ in range(count)]
        assert kind == 12, kind
        return self.struct()

    def struct(self):
        found, number = {}, 0
        while (head := self.byte()) != 0:
            number += head >> 4
            found[number] = self.value(head & 15)
        return found


def page_values(data, at, count, kind):
    """Of one column of a group: its page's header, levels and values."""
    reader = Thrift(data, at)
    header = reader.struct()
    start, size = reader.at, header[3]
    assert header[1] == 0 and header[2] == size and header[5] == {1: count, 2: 0, 3: 3, 4: 3}
    length, = struct.unpack_from("<i", data, start)
    levels = Thrift(data, start + 4)
    groups = levels.varint()
    assert groups & 1 and levels.at + (groups >> 1) == start + 4 + length
    is_there = [data[levels.at + i // 8] >> i % 8 & 1 for i in range(count)]
    place, values = start + 4 + length, []
    for one in is_there:
        if not one:
            values.append(None)
        elif kind == 6:
            length, = struct.unpack_from("<i", data, place)
            values.append(data[place + 4:place + 4 + length].decode())
            place += 4 + length
        else:
            values.append(struct.unpack_from("<q" if kind == 2 else "<d", data, place)[0])
            place += 8
    assert place == start + size
    return values


def read(data):
    """Names and values of the columns, in order."""
    length, = struct.unpack("<i", data[-8:-4])
    assert data[:4] == data[-4:] == b"PAR1"
    about = Thrift(data, len(data) - 8 - length).struct()
    root, *schema = about[2]
    assert root[5] == len(schema) and all(one[3] == 1 for one in schema)
    columns = {one[4].decode(): [] for one in schema}
    for group in about[4]:
        for one, chunk in zip(schema, group[1]):
            told = chunk[3]
            assert told[3] == [one[4]] and told[1] == one[1] and told[4] == 0 and told[5] == group[3]
            columns[one[4].decode()] += page_values(data, told[9], group[3], one[1])
    assert all(len(values) == about[3] for values in columns.values())
    return columns


SOME = [
    {"a": ("int", [1, None, -2**63, 2**63 - 1]), "b": ("float", [0.1, None, float("inf"), -0.0])},
    {"text": ("str", ["", None, "p\u00fcr \u00b5m", "x" * 300])},
    {f"column {i}": ("int", [i]) for i in range(20)},
    {"nothing": ("float", [None] * 9), "none": ("str", [None] * 9)},
    {"many": ("int", list(range(250_000)))},
    {"empty": ("str", []), "too": ("int", [])},
]


@pytest.mark.parametrize("columns", SOME, ids=lambda columns: next(iter(columns)))
def test_what_is_written_is_read(columns):
    data = parquet([Column(name, *told) for name, told in columns.items()])
    expected = {name: values for name, (_, values) in columns.items()}
    assert read(data) == expected
    try:
        import pyarrow.parquet
    except ImportError:
        return
    assert pyarrow.parquet.read_table(io.BytesIO(data)).to_pydict() == expected


def test_a_screening_has_what_its_csv_has(tmp_path):
    tifffile = pytest.importorskip("tifffile")
    fields = np.stack([stack(planes=9, focus=3.3, side=64), noise((9, 64, 64))])
    tifffile.imwrite(tmp_path / "a.tif", fields, photometric="minisblack")
    rows = fathom.screen(tmp_path / "a.tif", "walsh-sequency:32", out=tmp_path / "table.parquet")
    columns = read((tmp_path / "table.parquet").read_bytes())
    assert [dict(zip(columns, row)) for row in zip(*columns.values())] == [row._asdict() for row in rows]
    assert rows and rows == fathom.screen(tmp_path / "a.tif", "walsh-sequency:32", out=tmp_path / "table.csv")
