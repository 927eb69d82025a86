# SPDX-License-Identifier: Apache-2.0
"""xarray's arrays by the names of their dimensions. Nothing of xarray is imported here."""

from __future__ import annotations

from typing import Any, List, Optional, Tuple

import numpy as np

from ._errors import ArgumentError
from ._types import Array

_ROWS = ("y", "row", "rows")
_COLUMNS = ("x", "column", "columns", "col", "cols")
_PLANES = ("z", "plane", "planes", "position", "focus", "depth")
_COLOURS = ("c", "channel", "channels", "rgb", "band", "s")


def is_named(array: Any) -> bool:
    """Whether it is a DataArray, or what has its face."""
    return hasattr(array, "dims") and hasattr(array, "coords") and hasattr(array, "transpose")


def arranged(array: Any, axes: int, name: str) -> Any:
    """A DataArray with its pictures' dimensions last: [z,] y, x[, colours], whatever the order was.

    axes: 2 of pictures, 3 of stacks, which may have colours. Names that nobody knows stay in their order. Raises
    ArgumentError where rows and columns are named, and no dimension is left for the pictures of a stack.
    """
    dims = list(array.dims)
    rows, columns = _of(dims, _ROWS), _of(dims, _COLUMNS)
    if rows is None or columns is None:
        return array
    last = [rows, columns]
    others = [one for one in dims if one not in last]
    colours = _of(others, _COLOURS)
    if axes == 3 and len(others) > 1 and colours is not None and array.sizes[colours] in (3, 4):
        others.remove(colours)
        last.append(colours)
    if axes == 3:
        if not others:
            raise ArgumentError(f"{name} has the dimensions {tuple(dims)}; one is missing, that of the pictures")
        planes = _of(others, _PLANES) or others[-1]
        others.sort(key=lambda one: bool(one == planes))  # stays in order but for that one
    return array.transpose(*others, *last)


def _of(dims: List[Any], names: Tuple[str, ...]) -> Optional[Any]:
    return next((one for wanted in names for one in dims if str(one).lower() == wanted), None)


def axis_of(stack: Any, axis: int = 0) -> Tuple[Optional[Array], Optional[str]]:
    """Positions and unit of an axis of a DataArray; None where it says none."""
    if not is_named(stack) or stack.dims[axis] not in stack.coords:
        return None, None
    coordinate = stack.coords[stack.dims[axis]]
    attributes = getattr(coordinate, "attrs", {})
    try:
        places = np.asarray(coordinate.values, dtype=float)
    except (TypeError, ValueError):
        raise ArgumentError(f"coordinate {stack.dims[axis]} is of {coordinate.dtype}; positions are numbers") from None
    unit = attributes.get("units") or attributes.get("unit")
    return places, None if unit is None else str(unit)
