# SPDX-License-Identifier: Apache-2.0
"""The focus of pictures that are there already."""

from __future__ import annotations

import os
from typing import Any, Optional

import numpy as np

from . import _fathom
from ._errors import ArgumentError
from ._given import from_0, is_path, is_sequence, numbers, wished_text
from ._named import arranged, axis_of, is_named
from ._results import FocusResult, Peak
from ._types import Corner, Numbers


def focus(
    stack: Any,
    positions: Optional[Numbers] = None,
    metric: Optional[str] = None,
    window: Optional[Corner] = None,
    *,
    unit: Optional[str] = None,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
    from_: Optional[float] = None,
    to: Optional[float] = None,
    search: Optional[str] = None,
    peak: Optional[str] = None,
    tolerance: Optional[float] = None,
    frames: Optional[int] = None,
    blur: Optional[float] = None,
) -> FocusResult:
    """Where in a stack of pictures the focus is, how sure that is, and why.

    Parameters
    ----------
    stack : numpy.ndarray or xarray.DataArray
        Grey pictures (pictures, rows, columns) of uint8 or uint16, used in place as in `score`. A DataArray
        may have y, x and its pictures in any order; the coordinate of the pictures gives the positions,
        its attribute `units` the unit.
    positions : sequence of float, optional
        Where each picture was taken, in any order; 0, 1, 2, ... without it. Pictures of one position
        are averaged.
    metric : str, optional
        As in `score`, of one number a window; walsh-sequency:64 without it.
    window : (x, y), optional
        Left column and top row, px; the middle without it.
    unit : str, optional
        Of the positions.
    backend, threads : optional
        As in `score`.
    from_, to : float, optional
        Part of the positions to search.
    search : str, optional
        'auto', 'full', 'coarse', 'golden', 'fibonacci', 'brent', 'hill' or 'spectral'.
    peak : str, optional
        'fit' (a shape between the positions) or 'evaluated' (the best position).
    tolerance : float, optional
        Of searches that halve intervals, in the unit of positions.
    frames : int, optional
        Look at so many pictures at most.
    blur : float, optional
        Diameter of the disc of confusion, px, that each unit of travel adds.

    Returns
    -------
    FocusResult
        The answer of the program `fathom focus` on the same pictures, to the last bit.

    Raises
    ------
    ValueError
        For arguments that have no meaning. No focus is no error: see FocusResult.verdict.
    """
    _require_array(stack)
    if is_named(stack):
        stack = arranged(stack, 3, "stack")
    found, found_unit = axis_of(stack)
    if positions is None:
        positions = np.arange(len(stack), dtype=float) if found is None else found
    unit = wished_text(unit, "unit") or found_unit or "frames"
    metric = _fathom.search_metric if metric is None else metric
    measures = _fathom.Measures(metric, window, 1, backend, threads)
    pictures = getattr(stack, "values", stack)
    instrument = _fathom.open_stack(pictures, numbers(positions, "positions"), unit, measures)
    wishes = {"from_": from_, "to": to, "search": search, "peak": peak, "tolerance": tolerance,
              "frames": frames, "blur": blur}
    return FocusResult._of(instrument.focus(wishes, True, None, False), unit)


def _require_array(stack: Any) -> None:
    if is_path(stack):
        raise ArgumentError(f"stack is the text {os.fspath(stack)!r}; fathom.open_rig('replay:...') plays pictures "
                            "on disk")
    if not is_sequence(stack) or getattr(stack, "shape", None) == ():
        raise ArgumentError(f"stack is a {type(stack).__name__}; give an array (pictures, rows, columns), or a list "
                            "of pictures")


def fit(positions: Numbers, scores: Numbers, scatter: float = 0.0) -> Peak:
    """The peak of a focus curve that you have measured yourself.

    Parameters
    ----------
    positions : sequence of float
        In any order, none twice.
    scores : sequence of float
        Of any metric of focus, as many.
    scatter : float
        Standard deviation of a repeated score over its mean; 0 where it is not known.

    Returns
    -------
    Peak
        Of the highest hill. It is not judged: any curve has a highest point. `focus` judges.

    Raises
    ------
    ValueError
        For numbers that are not finite, of different counts, or a position twice.
    """
    return Peak._of(_fathom.fit(numbers(positions, "positions"), numbers(scores, "scores"), from_0(scatter, "scatter")))
