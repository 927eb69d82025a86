# SPDX-License-Identifier: Apache-2.0
"""What a screening has done so far, in small files that are written whole or not at all, and its table."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
import pathlib
import tempfile
from typing import Any, Dict, Iterable, List, NamedTuple, Optional

from ._errors import ArgumentError
from ._parquet import Column, parquet


class Row(NamedTuple):
    """One window of one field.

    plane: number, from 0, of the picture nearest to position. Both, and sigma, are None where there is no
    focus. verdict: as of FocusResult, or 'error' where the field could not be read; reason says why. warnings: what the reader and
    the measurement found, joined by "; ".
    """

    uri: str
    field: str
    x: Optional[int]
    y: Optional[int]
    n: int
    plane: Optional[int]
    position: Optional[float]
    sigma: Optional[float]
    unit: str
    confidence: Optional[float]
    verdict: str
    reason: str
    warnings: str


Done = Dict[str, List[Row]]


def write_whole(path: pathlib.Path, data: bytes, lasting: bool = True) -> None:
    """Puts a file there at once: who reads it finds the old one or the new one.

    lasting: whether a loss of power may not leave an empty one, which takes milliseconds.
    """
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            if lasting:
                file.flush()
                os.fsync(file.fileno())
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


class Parts:
    """The folder TABLE.parts: settings.json, and a file for each task that is done.

    A part has the rows of some sources under their keys, and its name follows from the keys. So a part
    that is written twice is there once, and a source that is in two parts counts once.
    """

    def __init__(self, table: pathlib.Path, settings: Dict[str, Any]):
        self.folder = table.with_name(table.name + ".parts")
        self.folder.mkdir(exist_ok=True)
        asked = self.folder / "settings.json"
        text = json.dumps(settings, sort_keys=True)
        if asked.exists() and asked.read_text(encoding="utf-8") != text:
            raise ArgumentError(f"out is {table}, and {self.folder} has parts of other settings "
                                f"({_changed(asked.read_text(encoding='utf-8'), settings)}); give another out, or "
                                "remove that folder")
        if not asked.exists():
            write_whole(asked, text.encode())

    def write(self, done: Done) -> None:
        """Keeps the rows of some sources."""
        name = hashlib.sha256("\n".join(sorted(done)).encode()).hexdigest()[:24]
        write_whole(self.folder / f"part-{name}.json", json.dumps(done).encode(), lasting=False)

    def read(self) -> Done:
        """All that is done. What is no part, such as one from a loss of power, counts as not done."""
        done: Done = {}
        for path in sorted(self.folder.glob("part-*.json")):
            try:
                part = json.loads(path.read_bytes())
                rows = {key: [Row(*row) for row in rows] for key, rows in part.items()}
            except (ValueError, TypeError, AttributeError):
                continue
            for key, mine in rows.items():
                done.setdefault(key, mine)
        return done


def _changed(before: str, settings: Dict[str, Any]) -> str:
    """What is not as it was, in words."""
    try:
        was = dict(json.loads(before))
    except (ValueError, TypeError):
        return "which cannot be read"
    names = [name for name in {**was, **settings} if was.get(name) != json.loads(json.dumps(settings.get(name)))]
    return ", ".join(f"{name} was {was.get(name)!r} and is {settings.get(name)!r}" for name in sorted(names))


def require_format(table: pathlib.Path) -> None:
    """Refuses, before anything is computed, a table that could not be written in the end."""
    if table.suffix not in (".csv", ".parquet"):
        raise ArgumentError(f"out is {table}; a table is .csv or .parquet")
    if not table.parent.is_dir():
        raise ArgumentError(f"out is {table}; there is no folder {table.parent}")


def write_table(table: pathlib.Path, rows: Iterable[Row]) -> None:
    """Writes CSV, whose numbers read back to the last bit, or Parquet."""
    data = _parquet(list(rows)) if table.suffix == ".parquet" else _csv(rows)
    write_whole(table, data)


def _csv(rows: Iterable[Row]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(Row._fields)
    writer.writerows(rows)  # floats as repr, None as nothing
    return text.getvalue().encode()


def _parquet(rows: List[Row]) -> bytes:
    kinds = {"x": "int", "y": "int", "n": "int", "plane": "int", "position": "float", "sigma": "float",
             "confidence": "float"}
    return parquet([Column(name, kinds.get(name, "str"), [getattr(row, name) for row in rows])
                    for name in Row._fields])
