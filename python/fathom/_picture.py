# SPDX-License-Identifier: Apache-2.0
"""A focus curve as a picture: with matplotlib where there is one, as SVG in a notebook."""

from __future__ import annotations

import html
import math
from typing import Any, List, Tuple

_WIDTH, _HEIGHT, _EDGE = 480, 220, 24


def plot(curve: Any, peak: Any, ax: Any = None) -> Any:
    """Draws onto `ax`, or new axes. Raises ImportError where there is no matplotlib."""
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.figure().add_subplot()
    ax.plot(curve.positions, curve.scores, "o-", markersize=3)
    if peak is not None:
        ax.axvline(peak.position, linestyle="--")
        ax.axvspan(peak.position - peak.sigma, peak.position + peak.sigma, alpha=0.2)
    ax.set_xlabel(f"position ({curve.unit})" if curve.unit else "position")
    ax.set_ylabel("focus quality")
    return ax


def _scale(values: List[float], low: float, high: float) -> List[float]:
    least, most = min(values), max(values)
    span = (most - least) or 1.0
    return [low + (value - least) / span * (high - low) for value in values]


def _points(curve: Any) -> List[Tuple[float, float]]:
    xs = _scale(list(curve.positions), _EDGE, _WIDTH - _EDGE)
    ys = _scale(list(curve.scores), _HEIGHT - _EDGE, _EDGE)
    return list(zip(xs, ys))


def _mark(curve: Any, peak: Any) -> str:
    low, high = float(curve.positions[0]), float(curve.positions[-1])
    if peak is None or not math.isfinite(peak.position) or high <= low:
        return ""
    x = _EDGE + (peak.position - low) / (high - low) * (_WIDTH - 2 * _EDGE)
    return (f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_EDGE}" y2="{_HEIGHT - _EDGE}" '
            'stroke="#c33" stroke-dasharray="4"/>')


def svg(curve: Any, peak: Any) -> str:
    """The curve as SVG; empty where there is nothing to draw."""
    if len(curve) == 0:
        return ""
    points = _points(curve)
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="#247"/>' for x, y in points)
    ends = f"{curve.positions[0]:g} to {curve.positions[-1]:g} {curve.unit}"
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_HEIGHT}">'
            f'<polyline points="{line}" fill="none" stroke="#247"/>{dots}{_mark(curve, peak)}'
            f'<text x="{_EDGE}" y="{_HEIGHT - 6}" font-size="11">{html.escape(ends)}</text></svg>')
