# SPDX-License-Identifier: Apache-2.0
"""Maps of depth of stacks that are there already, in memory, one by one, or on disk."""

from __future__ import annotations

import os
from typing import Any, Dict, Iterable, Iterator, List, Optional, Tuple, Union

import numpy as np

from . import _fathom
from ._calibration import Calibration
from ._errors import ArgumentError, FileError, warn_of
from ._given import flag, is_path, is_sequence, numbers, path as path_of, wished_text
from ._maps import Maps
from ._named import arranged, axis_of, is_named
from ._types import Array, Numbers

_Path = Union[str, "os.PathLike[str]"]


def depth(
    stack: Any,
    positions: Optional[Numbers] = None,
    calibration: Union[None, Calibration, _Path] = None,
    window: Union[str, int] = "auto",
    stride: Optional[int] = None,
    align: str = "similarity",
    fill: bool = False,
    *,
    unit: Optional[str] = None,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
) -> Maps:
    """How far away every pixel of a stack is, how sure that is, and the picture that is sharp everywhere.

    Parameters
    ----------
    stack : array, sequence or iterable of arrays, xarray.DataArray, path or rig text
        Pictures of uint8 or uint16, grey (rows, columns) or colours (rows, columns, 3): as one array with
        the pictures along its first axis, a list, anything with a length and an index (read picture by
        picture, so it may be larger than the memory), or an iterator, which takes `positions`. An
        iterator gives its pictures in the order of their positions, so that neighbours look alike; it
        may give the same buffer again and again. A DataArray may have its dimensions z, y and x in any order; the coordinate
        of the pictures gives the positions, its attribute `units` the unit. Or a folder of pictures, a TIFF, or a text
        'replay:...', read as `fathom depth --rig` does.
    positions : sequence of float, optional
        Where each picture was taken, in any order; 0, 1, 2, ... without it. Pictures of one position are
        averaged.
    calibration : Calibration or path, optional
        Turns positions into distances: `depth` and `sigma` are then in mm.
    window : 'auto' or int
        Side of the windows, px (8, 16, 32, 64, 128 or 256); 'auto' takes several, weighed by what they
        tell.
    stride : int, optional
        Pixels between windows; as dense as the number of pictures allows without it.
    align : str
        How the picture may move with the lens: 'similarity' (it grows, turns, shifts), 'scale' (it
        grows) or 'none'.
    fill : bool
        Whether what has no depth is closed smoothly; its class is then 'filled'.
    unit : str, optional
        Of the positions.
    backend, threads : optional
        As in `score`.

    Returns
    -------
    Maps
        What the program `fathom depth` gives of the same pictures, to the last bit.

    Raises
    ------
    ValueError
        For arguments that have no meaning, fewer than 3 positions, pictures that differ in size.
    OSError, fathom.Error
        For a folder or file that cannot be read, or a backend that is not there.

    Notes
    -----
    Python's lock is released while it computes. Ctrl-C ends it between two pictures.
    """
    wishes = _wishes(calibration, window, stride, align, fill, backend, threads)
    if is_path(stack):
        if positions is not None or unit is not None:
            raise ArgumentError("positions and unit of a recording stand in its manifest.csv; leave them out")
        return _of_recording(_rig_text(stack), wishes)
    if is_named(stack):
        stack = arranged(stack, 3, "stack")
    found, found_unit = axis_of(stack)
    places, order = _order(stack, positions if positions is not None else found)
    wishes["rig"] = ""
    stops, counts = _stops(places[order])
    taker = _fathom.DepthTaker(wishes, stops, counts, wished_text(unit, "unit") or found_unit or "frames")
    for name, picture in _pictures(stack, order):
        taker.take(picture, name)
    groups = np.empty(len(order), int)
    groups[order] = np.repeat(np.arange(len(counts)), counts)
    return Maps._of(taker.finish(), places, groups)


def _wishes(calibration: Union[None, Calibration, _Path], window: Union[str, int], stride: Optional[int],
            align: str, fill: bool, backend: Optional[str], threads: Optional[int]) -> Dict[str, Any]:
    if isinstance(window, str) and window == "auto":
        side = None
    elif isinstance(window, (int, np.integer)) and not isinstance(window, bool):
        side = int(window)
    else:
        raise ArgumentError(f"window is {window!r}; it is 'auto' or the side of the windows, px")
    name = ""
    if calibration is not None and not isinstance(calibration, Calibration):
        name = path_of(calibration, "calibration")
        calibration = Calibration.load(name)
    elif calibration is not None:
        name = calibration.equation
    return {"window": side, "stride": stride, "align": align, "fill": flag(fill, "fill"), "backend": backend,
            "threads": threads, "calibration": None if calibration is None else calibration._core,
            "calibration_name": name}


def _rig_text(stack: _Path) -> str:
    """A path that is there is a recording, unless it is a rig file; all else is a rig text already."""
    text = os.fspath(stack)
    is_there = os.path.exists(text)
    if not is_there and (isinstance(stack, os.PathLike) or ":" not in text):
        raise FileError(f"stack is {text!r}, and there is no such file or folder", "io")
    return f"replay:{text}" if is_there and not text.endswith(".toml") else text


def _of_recording(rig: str, wishes: Dict[str, Any]) -> Maps:
    values = _fathom.depth_of(rig, wishes)
    warn_of(values.get("warnings", []), stacklevel=4)
    positions = np.asarray(values["positions"])
    return Maps._of(values, positions, np.arange(len(positions)))


def _order(stack: Any, positions: Optional[Iterable[float]]) -> Tuple[Array, Array]:
    """Positions of all pictures, and in which order they are taken."""
    if not is_sequence(stack):
        return _order_as_given(stack, positions)
    _require_stack(stack)
    if positions is None:
        positions = range(len(stack))
    places = _floats(positions)
    if len(places) != len(stack):
        raise ArgumentError(f"positions holds {len(places)} of them, and stack {len(stack)} pictures")
    return places, np.argsort(places, kind="stable")


def _order_as_given(stack: Any, positions: Optional[Iterable[float]]) -> Tuple[Array, Array]:
    if not hasattr(stack, "__iter__") or hasattr(stack, "keys"):
        raise ArgumentError(f"stack is a {type(stack).__name__}; give an array, pictures one by one, or a path")
    if positions is None:
        raise ArgumentError("stack is an iterator, and nobody knows how many pictures come; give positions")
    places = _floats(positions)
    return places, np.arange(len(places))


def _floats(positions: Iterable[float]) -> Array:
    places = np.array(numbers(positions, "positions"))
    for i, place in enumerate(places):
        if not np.isfinite(place):
            raise ArgumentError(f"positions[{i}] is no finite number")
    return places


def _require_stack(stack: Any) -> None:
    shape = getattr(stack, "shape", None)
    if shape is None:
        return
    is_stack = len(shape) == 3 or (len(shape) == 4 and shape[3] in (3, 4))
    if not is_stack or (len(shape) == 3 and shape[2] <= 4):
        raise ArgumentError(f"stack has shape {tuple(shape)}; a stack has the axes (pictures, rows, columns), and a "
                         "last one of 3 for colours")
    if isinstance(stack, np.ma.MaskedArray):
        raise ArgumentError("stack is a masked array; give its .data, for every pixel counts")


def _stops(places: Array) -> Tuple[List[float], List[int]]:
    """Each position where pictures are taken one after the other, and how many."""
    starts = np.flatnonzero(np.r_[True, places[1:] != places[:-1]]) if len(places) else np.zeros(0, int)
    return places[starts].tolist(), np.diff(np.r_[starts, len(places)]).tolist()


def _pictures(stack: Any, order: Array) -> Iterator[Tuple[str, Array]]:
    """Name and array of each picture; those of lazy arrays are computed one by one."""
    if isinstance(stack, np.ndarray):  # what is said of one picture holds for all
        for i in order:
            yield "stack", stack[i]
    elif is_sequence(stack):
        for i in order:
            yield f"stack[{i}]", np.asanyarray(stack[int(i)])
    else:
        for i, picture in enumerate(stack):
            yield f"stack[{i}]", np.asanyarray(picture)
