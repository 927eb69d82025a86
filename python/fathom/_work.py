# SPDX-License-Identifier: Apache-2.0
"""What a worker does: the foci of some sources."""

from __future__ import annotations

import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ._errors import amiss
from ._fields import Field, fields_of, heard, is_played
from ._parts import Done, Row
from ._rig import open_rig
from ._stack import focus
from ._types import Array, Corner

Source = Tuple[str, Any]  # key, and what fields_of takes


class Settings(NamedTuple):
    """What is measured of every field. Small: it goes with every task."""

    metric: str
    n: int
    windows: Optional[List[Corner]]
    positions: Optional[List[float]]
    unit: Optional[str]
    backend: Optional[str]
    threads: Optional[int]
    wishes: Dict[str, Any]


class Outcome(NamedTuple):
    """Of one task: rows of each source, the keys of those that failed, how long it took, and what readers said."""

    rows: Done
    failed: List[str]
    seconds: float
    said: Dict[str, List[str]] = {}


def work(sources: List[Source], settings: Settings) -> Outcome:
    """Measures some sources. A source that fails costs only itself."""
    start = time.perf_counter()
    rows: Done = {}
    failed = []
    said: Dict[str, List[str]] = {}
    for key, source in sources:
        words: List[str] = []
        with heard(words):
            rows[key] = list(_rows_of(source, settings, words))
        if words:
            said[key] = list(dict.fromkeys(words))
        if any(row.verdict == "error" for row in rows[key]):
            failed.append(key)
    return Outcome(rows, failed, time.perf_counter() - start, said)


def _rows_of(source: Any, settings: Settings, said: List[str]) -> Iterator[Row]:
    """said: takes what readers say."""
    uri = source if isinstance(source, str) else ""
    name = ""
    try:
        if uri and is_played(uri):
            yield from _rig_rows(uri, settings, said)
            return
        for field in fields_of(source):
            name = field.name
            yield from _field_rows(uri, field, settings, said)
    except Exception as problem:  # whatever a reader of strangers' files raises
        yield error_row(uri, name, settings, problem, said)


def error_row(uri: str, name: str, settings: Settings, problem: BaseException, said: Sequence[str] = ()) -> Row:
    words = " ".join(str(problem).split()) or type(problem).__name__
    return Row(uri, name, None, None, settings.n, None, None, None, "", None, "error", words, _joined(said))


def _field_rows(uri: str, field: Field, settings: Settings, said: List[str]) -> Iterator[Row]:
    try:
        stack, planes, words = field.read()
        said += words
        if stack.ndim == 2:
            stack = stack[None]
        stack = stack.astype(stack.dtype.newbyteorder("="), order="C", copy=False)
        numbers = np.arange(len(stack)) if planes is None else np.asarray(planes)
        places, unit = field.places(int(numbers[-1]) + 1)
        if settings.positions is not None:
            places, unit = np.asarray(settings.positions), settings.unit or "frames"
        if planes is not None:
            places = places[numbers]
        unit = settings.unit or unit
        middle = [((stack.shape[2] - settings.n) // 2, (stack.shape[1] - settings.n) // 2)]
        for corner in settings.windows or middle:
            result = focus(stack, places, settings.metric, corner, unit=unit, backend=settings.backend,
                           threads=settings.threads, **settings.wishes)
            yield _row(uri, field.name, corner, settings, result, places, numbers, said)
    except Exception as problem:
        yield error_row(uri, field.name, settings, problem, said)


def _rig_rows(uri: str, settings: Settings, said: List[str]) -> Iterator[Row]:
    """Of a folder, as the program plays it."""
    text = uri if uri.startswith("replay:") else f"replay:{uri}"
    anywhere: List[Optional[Corner]] = [None]
    for corner in settings.windows or anywhere:
        with open_rig(text, settings.metric, corner, backend=settings.backend, threads=settings.threads) as rig:
            result = rig._focus(settings.wishes, stay=False)
            x, y, _ = rig.about["window"]
            said += [one["text"] for one in result.values["warnings"] if amiss(one)]
            places = np.asarray(rig.about["stops"])
            yield _row(uri, "", (x, y), settings, result, places, np.arange(len(places)), ())


def _row(uri: str, name: str, corner: Corner, settings: Settings, result: Any, places: Array,
         numbers: Array, said: Sequence[str]) -> Row:
    """places: of the pictures, whose numbers in the file these are."""
    plane = int(numbers[np.argmin(np.abs(places - result.position))]) if result else None
    return Row(uri, name, *corner, settings.n, plane, result.position, result.sigma, result.unit,
               result.confidence, result.verdict, result.reason, _joined([*said, *result.warnings]))


def _joined(said: Sequence[str]) -> str:
    return "; ".join(dict.fromkeys(said))
