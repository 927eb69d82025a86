# SPDX-License-Identifier: Apache-2.0
"""Scores, foci and depths of Dask's arrays: lazy, chunk by chunk, on whatever runs Dask's tasks.

Values are those of `fathom.score`, `fathom.focus` and `fathom.depth` on the whole array to the last bit, whatever the
chunks are. The backend is therefore 'cpu' and a task takes one thread, unless you say otherwise: Dask has
threads of its own, and 'auto' may choose another device on each worker.

Examples
--------
>>> import dask.array, fathom.dask
>>> pictures = dask.array.zeros((5, 300, 300), chunks=(2, 100, 100), dtype='uint8')
>>> fathom.dask.score(pictures, 'fft:64:hann', stride=32).shape
(5, 8, 8)
"""

# What Dask's functions take and give, it does not say.
# mypy: allow-untyped-calls, no-warn-return-any

from __future__ import annotations

from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np
from dask.array.core import Array as DaskArray, concatenate, map_blocks
from dask.array.overlap import overlap

from . import _fathom
from ._depth import depth as _depth_of
from ._errors import ArgumentError
from ._given import count, numbers, wished_text
from ._named import arranged, axis_of, is_named
from ._screen import try_wishes
from ._stack import focus as _focus_of
from ._types import Array, Corner, Corners, Numbers

#: What `focus` gives for each stack; nan and plane -1 where there is no focus.
RESULT = np.dtype([("position", "f8"), ("sigma", "f8"), ("confidence", "f8"), ("plane", "i8"),
                   ("verdict", "U9"), ("unit", "U16")])

#: What `depth` gives for each pixel, and `sharp` of the pixels' dtype: as of `fathom.Maps`.
MAPS = [("depth", "f4"), ("sigma", "f4"), ("confidence", "f4"), ("index", "u2"), ("classes", "u1")]

_PIXELS = (np.uint8, np.uint16, np.bool_)


def score(
    array: Any,
    metric: str = "walsh-sequency:64",
    windows: Corners = None,
    stride: Optional[int] = None,
    backend: Optional[str] = "cpu",
    threads: Optional[int] = 1,
) -> DaskArray:
    """Focus quality of windows of every picture of an array.

    Parameters
    ----------
    array : dask.array.Array, or xarray.DataArray of one
        Grey pixels of uint8, uint16 or bool, of shape (..., rows, columns), in any chunks. Windows that
        cross chunks are scored as any other; a task gets at most a window's side more of its neighbours.
    metric, windows, stride : optional
        As in `fathom.score`.
    backend, threads : optional
        As in `fathom.score`, on the workers.

    Returns
    -------
    dask.array.Array of float64
        Axes in this order: those before rows and columns; windows (K), or rows and columns of the grid;
        rings. Its chunks follow those of the array.

    Raises
    ------
    ValueError
        At once, for pixels, metric or windows that have no meaning, or a window over the edge.
    """
    pixels = _pixels(arranged(array, 2, "array") if is_named(array) else array, 2, "array")
    if stride is not None and windows is not None:
        raise ArgumentError("give windows or stride, not both")
    plan = _fathom.Plan(metric, 1, "cpu", 1)
    _require_device(backend, threads)
    n = side_of(plan)
    if min(pixels.shape[-2:]) < n:
        raise ArgumentError(f"array has pictures of {pixels.shape[-2:]} pixels; a window has {n} x {n}")
    rings = (plan.outputs,) if ":rings=" in plan.metric else ()
    call = _Call(plan.metric, backend, threads, rings)
    if stride is not None:
        return _of_grid(pixels, n, count(stride, "stride"), call)
    return _of_list(pixels, n, windows, call)


def focus(
    stacks: Any,
    positions: Optional[Numbers] = None,
    metric: Optional[str] = None,
    window: Optional[Corner] = None,
    *,
    unit: Optional[str] = None,
    backend: Optional[str] = "cpu",
    threads: Optional[int] = 1,
    **wishes: Any,
) -> DaskArray:
    """The focus of every stack of a collection.

    Parameters
    ----------
    stacks : dask.array.Array, or xarray.DataArray of one
        (..., pictures, rows, columns). A task takes whole stacks. Dimensions of a DataArray that are named
        z, y and x may stand in any order.
    positions : sequence of float, optional
        Of the pictures of every stack; of the DataArray's coordinate, or 0, 1, 2, ... without it.
    metric, window, unit, **wishes : optional
        As in `fathom.focus`: from_, to, search, peak, tolerance, frames, blur.
    backend, threads : optional
        As in `fathom.focus`, on the workers.

    Returns
    -------
    dask.array.Array of the dtype `RESULT`
        One for each stack: position, sigma, confidence, plane (the nearest picture), verdict and unit.

    Raises
    ------
    ValueError
        At once, for an array that is none of stacks, or as many positions as do not fit.
    """
    whole, places, lead, found_unit = _whole_stacks(stacks, positions)
    unit = wished_text(unit, "unit") or found_unit or "frames"
    _try_focus(whole, metric, window, backend, threads, wishes)
    wishes.update(metric=metric, window=window, backend=backend, threads=threads, unit=unit)
    return whole.map_blocks(_foci, places, wishes, drop_axis=list(range(lead, whole.ndim)), dtype=RESULT,
                            meta=np.empty((0,) * lead, RESULT))


def depth(
    stacks: Any,
    positions: Optional[Numbers] = None,
    *,
    backend: Optional[str] = "cpu",
    threads: Optional[int] = 1,
    **wishes: Any,
) -> DaskArray:
    """The depth of every pixel of every stack of a collection.

    Parameters
    ----------
    stacks : dask.array.Array, or xarray.DataArray of one
        (..., pictures, rows, columns). A task takes whole stacks.
    positions : sequence of float, optional
        As in `focus`.
    **wishes
        calibration, window, stride, align, fill: as in `fathom.depth`.
    backend, threads : optional
        As in `fathom.depth`, on the workers.

    Returns
    -------
    dask.array.Array of shape (..., rows, columns)
        Of a dtype with the fields depth, sigma, confidence, index, classes and sharp, which are the arrays
        of `fathom.Maps`: `fathom.dask.depth(stacks)['depth']`.

    Raises
    ------
    ValueError
        At once, for an array that is none of stacks, or as many positions as do not fit.
    """
    whole, places, lead, _ = _whole_stacks(stacks, positions)
    _try_depth(whole, backend, threads, wishes)
    wishes.update(backend=backend, threads=threads)
    dtype = np.dtype(MAPS + [("sharp", "u1" if whole.dtype == bool else whole.dtype.newbyteorder("="))])
    return whole.map_blocks(_depths, places, wishes, dtype, drop_axis=[lead], dtype=dtype,
                            meta=np.empty((0,) * (lead + 2), dtype))


def _whole_stacks(stacks: Any, positions: Optional[Numbers]
                  ) -> Tuple[DaskArray, Array, int, Optional[str]]:
    """Stacks in one chunk each, positions of their pictures, how many axes stand before a stack's, and the unit."""
    unit = None
    if is_named(stacks) and stacks.ndim >= 3:
        stacks = arranged(stacks, 3, "stacks")
        found, unit = axis_of(stacks, -3)
        positions = found if positions is None else positions
    pixels = _pixels(stacks, 3, "stacks")
    planes = pixels.shape[-3]
    places = np.arange(planes, dtype=float) if positions is None else np.array(numbers(positions, "positions"))
    if places.shape != (planes,):
        raise ArgumentError(f"positions holds {places.size} of them, and a stack {planes} pictures")
    lead = pixels.ndim - 3
    return pixels.rechunk({axis: -1 for axis in range(lead, pixels.ndim)}), places, lead, unit


def _require_device(backend: Optional[str], threads: Optional[int]) -> None:
    wished_text(backend, "backend")
    if threads is not None:
        count(threads, "threads")


def _try_focus(stacks: DaskArray, metric: Optional[str], window: Any, backend: Optional[str], threads: Optional[int],
               wishes: Dict[str, Any]) -> None:
    """Says at once what each task would say."""
    if unknown := wishes.keys() - {"from_", "to", "search", "peak", "tolerance", "frames", "blur"}:
        raise TypeError(f"focus() got an unexpected argument {sorted(unknown)[0]!r}")
    _require_device(backend, threads)
    _focus_of(np.zeros((1,) + stacks.shape[-2:], np.uint8), None, metric, window, backend="cpu", threads=1)
    plan = _fathom.Plan(_fathom.search_metric if metric is None else metric, 1, "cpu", 1)
    try_wishes(plan.metric, wishes)


def _try_depth(stacks: DaskArray, backend: Optional[str], threads: Optional[int], wishes: Dict[str, Any]) -> None:
    """Says at once what each task would say, by a small blank stack."""
    if unknown := wishes.keys() - {"calibration", "window", "stride", "align", "fill", "unit"}:
        raise TypeError(f"depth() got an unexpected argument {sorted(unknown)[0]!r}")
    _require_device(backend, threads)
    if stacks.shape[-3] < 3:
        raise ArgumentError(f"stacks have {stacks.shape[-3]} pictures each; a map needs 3 positions at least")
    rows, columns = (min(side, 512) for side in stacks.shape[-2:])
    _depth_of(np.zeros((3, rows, columns), np.uint8), backend="cpu", threads=1, **wishes)


def side_of(plan: Any) -> int:
    """Side of the windows of a plan's metric, px: the second word of its canonical text."""
    return int(plan.metric.split(":")[1])


def _pixels(array: Any, axes: int, name: str) -> DaskArray:
    pixels = array.data if is_named(array) else array
    if not isinstance(pixels, DaskArray):
        raise ArgumentError(f"{name} is a {type(array).__name__}; dask.array.from_array makes a Dask array of it")
    if pixels.dtype.newbyteorder("=") not in _PIXELS:
        raise ArgumentError(f"{name} has dtype {pixels.dtype}; pixels are uint8, uint16 or bool")
    if pixels.ndim < axes:
        raise ArgumentError(f"{name} has {pixels.ndim} axes; it needs {axes} at least, rows and columns last")
    if any(np.isnan(size) for size in pixels.shape):
        raise ArgumentError(f"{name} has chunks of unknown size; call its compute_chunk_sizes()")
    return pixels


class _Call:
    """What is computed of each block. Small, and the same for all of them."""

    def __init__(self, metric: str, backend: Optional[str], threads: Optional[int], rings: Tuple[int, ...]):
        self.metric, self.backend, self.threads, self.rings = metric, backend, threads, rings

    def __dask_tokenize__(self) -> Tuple[Any, ...]:
        return "fathom.dask", self.metric, self.backend, self.threads, self.rings

    def __call__(self, pixels: Array, windows: Any = None, stride: Optional[int] = None) -> Array:
        """Scores of (..., rows, columns), with the leading axes in front."""
        lead = pixels.shape[:-2]
        # A block is small: what does not lie as the engine needs it is copied without a word.
        stack = pixels.astype(pixels.dtype.newbyteorder("="), order="C", copy=False)
        stack = stack.reshape((-1,) + pixels.shape[-2:])
        values = _fathom.score(stack, self.metric, windows, stride, self.backend, self.threads)
        return values.reshape(lead + values.shape[1:])

    def lay_out(self, blocks: DaskArray, function: Callable[..., Array], axes: List[Tuple[int, ...]],
                **arguments: Any) -> DaskArray:
        """Maps blocks whose last two axes, rows and columns, become these, and rings behind them."""
        lead = blocks.ndim - 2
        axes = axes + [(ring,) for ring in self.rings]
        new = list(range(lead, lead + len(axes)))
        return map_blocks(function, blocks, call=self, dtype=float, chunks=blocks.chunks[:lead] + tuple(axes),
                             drop_axis=[lead, lead + 1], new_axis=new,
                             meta=np.empty((0,) * (lead + len(axes))), **arguments)


def _of_grid(pixels: DaskArray, n: int, stride: int, call: _Call) -> DaskArray:
    lead = pixels.ndim - 2
    cuts = [_cut(pixels.chunks[axis], n, stride) for axis in (lead, lead + 1)]
    pixels = pixels.rechunk({lead: cuts[0], lead + 1: cuts[1]})
    counts = [_corners(cut, n, stride) for cut in cuts]
    if max(len(cut) for cut in cuts) > 1:
        depth = {axis: 0 for axis in range(lead)}
        depth.update({lead: (0, n - 1), lead + 1: (0, n - 1)})
        pixels = overlap(pixels, depth, boundary="none", allow_rechunk=False)
    # The axes stay: only their chunks become others. Blocks are known by their place.
    chunks = pixels.chunks[:lead] + tuple(tuple(count for _, count in axis) for axis in counts)
    chunks += tuple((ring,) for ring in call.rings)
    return map_blocks(_grid_block, pixels, call=call, n=n, stride=stride, counts=counts, dtype=float,
                         chunks=chunks, new_axis=[pixels.ndim] if call.rings else None,
                         meta=np.empty((0,) * len(chunks)))


def _cut(chunks: Sequence[int], n: int, stride: int) -> Tuple[int, ...]:
    """Chunks that have a window's corner each, and n - 1 px at least for the one before them."""
    last = (sum(chunks) - n) // stride * stride
    sizes: List[int] = []
    start = size = 0
    for chunk in chunks:
        size += chunk
        first = -(-start // stride) * stride
        if size >= n - 1 and first <= last and first < start + size:
            sizes.append(size)
            start, size = start + size, 0
    sizes[-1] += size  # what lies behind the last corner
    return tuple(sizes)


def _corners(sizes: Sequence[int], n: int, stride: int) -> List[Tuple[int, int]]:
    """Of each chunk: where in it the first corner lies, and how many there are."""
    last = (sum(sizes) - n) // stride * stride
    found, start = [], 0
    for size in sizes:
        first = -(-start // stride) * stride
        found.append((first - start, (min(start + size - 1, last) - first) // stride + 1))
        start += size
    return found


def _grid_block(block: Array, call: _Call, n: int, stride: int, counts: Any,
                block_id: Any = None) -> Array:
    (top, rows), (left, columns) = (
        counts[axis][block_id[block.ndim - 2 + axis]] for axis in (0, 1))
    part = block[..., top:top + (rows - 1) * stride + n, left:left + (columns - 1) * stride + n]
    if block.size == 0:
        return np.empty(block.shape[:-2] + (rows, columns) + call.rings)
    return call(part, stride=stride)


def _of_list(pixels: DaskArray, n: int, windows: Any, call: _Call) -> DaskArray:
    rows, columns = pixels.shape[-2:]
    corners, is_one = _corner_list(windows, rows, columns, n)
    lead = pixels.ndim - 2
    parts, order = [], []
    for group in _by_chunk(corners, pixels.chunks[-1], pixels.chunks[-2]):
        mine = corners[group]
        (left, top), (right, bottom) = mine.min(axis=0), mine.max(axis=0) + n
        part = pixels[..., top:bottom, left:right].rechunk({lead: -1, lead + 1: -1})
        parts.append(call.lay_out(part, _list_block, [(len(group),)], corners=mine - [left, top]))
        order.append(group)
    values = parts[0] if len(parts) == 1 else concatenate(parts, axis=lead)
    back = np.argsort(np.concatenate(order), kind="stable")
    if is_one:
        return values[(slice(None),) * lead + (0,)]
    if np.array_equal(back, np.arange(len(back))):
        return values
    return values[(slice(None),) * lead + (back,)]


def _corner_list(windows: Any, rows: int, columns: int, n: int) -> Tuple[Array, bool]:
    """Corners (K, 2), and whether a single window was asked for."""
    if windows is None:
        return np.array([[(columns - n) // 2, (rows - n) // 2]]), True
    corners = np.asarray(windows)
    if corners.size == 0:
        raise ArgumentError("windows is empty")
    if corners.shape[-1:] != (2,) or corners.ndim > 2 or corners.dtype.kind not in "iu":
        raise ArgumentError("windows is (x, y), or a sequence of them, in whole pixels")
    is_one = corners.ndim == 1
    corners = corners.reshape(-1, 2).astype(np.int64)
    outside = (corners < 0).any(axis=1) | (corners + n > [columns, rows]).any(axis=1)
    if outside.any():
        at = int(np.argmax(outside))
        name = "windows" if is_one else f"windows[{at}]"
        raise ArgumentError(f"{name} is outside of the picture: {n} x {n} px at x = {corners[at][0]}, "
                         f"y = {corners[at][1]} of {columns} x {rows} px")
    return corners, is_one


def _by_chunk(corners: Array, along_x: Sequence[int], along_y: Sequence[int]) -> List[Array]:
    """Numbers of the windows whose corners lie in one chunk, chunk by chunk."""
    column = np.searchsorted(np.cumsum(along_x), corners[:, 0], side="right")
    row = np.searchsorted(np.cumsum(along_y), corners[:, 1], side="right")
    chunk = row * len(along_x) + column
    return [np.flatnonzero(chunk == one) for one in np.unique(chunk)]


def _list_block(block: Array, call: _Call, corners: Array) -> Array:
    if block.size == 0:
        return np.empty(block.shape[:-2] + (len(corners),) + call.rings)
    return call(block, windows=corners)


def _foci(block: Array, places: Array, wishes: Any) -> Array:
    found = np.empty(block.shape[:-3], RESULT)
    for at in np.ndindex(found.shape):
        stack = block[at].astype(block.dtype.newbyteorder("="), order="C", copy=False)
        found[at] = row_of(_focus_of(stack, places, **wishes), places)
    return found


def _depths(block: Array, places: Array, wishes: Any, dtype: "np.dtype[Any]") -> Array:
    found = np.empty(block.shape[:-3] + block.shape[-2:], dtype)
    for at in np.ndindex(block.shape[:-3]):
        stack = block[at].astype(block.dtype.newbyteorder("="), order="C", copy=False)
        maps = _depth_of(stack, places, **wishes)
        for name in dtype.names or ():
            found[name][at] = getattr(maps, name)
    return found


def row_of(result: Any, places: Array) -> Tuple[float, float, float, int, str, str]:
    """A FocusResult as an element of the dtype `RESULT`."""
    if not result:
        return np.nan, np.nan, result.confidence, -1, result.verdict, result.unit
    plane = int(np.argmin(np.abs(places - result.position)))
    return result.position, result.sigma, result.confidence, plane, result.verdict, result.unit
