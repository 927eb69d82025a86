# SPDX-License-Identifier: Apache-2.0
"""What a measurement came to."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional

import numpy as np

from . import _picture
from ._types import Floats


@dataclass(frozen=True)
class Peak:
    """One hill of a focus curve. Positions in the lens's unit, scores in the metric's.

    Attributes
    ----------
    position, sigma : float
        Where it is, and the standard uncertainty of that.
    score : float
        There.
    half_width : float
        Half of the width at half the height; 0 where it is not known.
    r_squared : float
        Part of the points' variance that the shape explains; 0 where no point is left to judge it by.
    shape : str
        'gaussian', 'lorentzian', 'parabola' or 'none'.
    points : int
        How many the shape was fitted to.
    """

    position: float
    sigma: float
    score: float
    half_width: float
    r_squared: float
    shape: str
    points: int

    @classmethod
    def _of(cls, values: Dict[str, Any]) -> "Peak":
        return cls(**values)


@dataclass(frozen=True)
class Curve:
    """Scores over positions, in order of position.

    Attributes
    ----------
    positions, scores : numpy.ndarray of float64, of one length
    unit : str
        Of the positions.
    warnings : list of str
        What should be known of the pictures.
    """

    positions: Floats
    scores: Floats
    unit: str = ""
    warnings: List[str] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.positions)

    def plot(self, ax: Any = None) -> Any:
        """Draws it with matplotlib and returns the axes."""
        return _picture.plot(self, None, ax)

    def _repr_html_(self) -> str:
        return _picture.svg(self, None)


@dataclass(frozen=True)
class FocusResult:
    """Where the focus is, how sure that is, and why. True where there is one.

    Attributes
    ----------
    position : float or None
        Of the focus, in `unit`; None unless `verdict` is 'focused'.
    sigma : float or None
        Its standard uncertainty, in `unit`.
    confidence : float
        How sure the focus is, 0 to 1.
    verdict : str
        'focused', 'no-focus', 'at-limit' (the focus may lie beyond) or 'ambiguous' (two peaks).
    why : str
        What decided, such as 'stands-out' or 'within-noise'.
    reason : str
        The same in words.
    curve : Curve
        What was evaluated.
    peak : Peak
        The highest peak, whatever the verdict.
    lobes : list of Peak
        All hills, the highest first.
    warnings : list of str
        What should be known of the pictures.
    unit : str
        Of positions.
    values : dict
        All numbers of the reason, of the way there (`journey`) and the object's `spectrum`.
    """

    position: Optional[float]
    sigma: Optional[float]
    confidence: float
    verdict: str
    why: str
    reason: str
    curve: Curve
    peak: Peak
    lobes: List[Peak]
    warnings: List[str]
    unit: str
    values: Dict[str, Any] = field(repr=False, default_factory=dict)

    @classmethod
    def _of(cls, values: Dict[str, Any], unit: str) -> "FocusResult":
        peak = Peak._of(values["peak"])
        focused = values["verdict"] == "focused"
        return cls(
            position=peak.position if focused else None,
            sigma=peak.sigma if focused else None,
            confidence=values["confidence"],
            verdict=values["verdict"],
            why=values["reason"]["why"],
            reason=values["reason"]["text"],
            curve=Curve(unit=unit, **values["curve"]),
            peak=peak,
            lobes=[Peak._of(lobe) for lobe in values["lobes"]],
            warnings=[one["text"] for one in values.get("warnings", [])],
            unit=unit,
            values=values,
        )

    def __bool__(self) -> bool:
        return self.verdict == "focused"

    def __str__(self) -> str:
        if not self:
            return f"{self.verdict}: {self.reason}"
        return (f"focused at {self.position:.6g} +- {self.sigma:.2g} {self.unit}, "
                f"confidence {self.confidence:.2f}")

    def plot(self, ax: Any = None) -> Any:
        """Draws curve and peak with matplotlib and returns the axes."""
        return _picture.plot(self.curve, self.peak, ax)

    def _repr_html_(self) -> str:
        lines = [f"<p>{html.escape(str(self))}</p>", _picture.svg(self.curve, self.peak)]
        lines += [f"<p>{html.escape(one)}</p>" for one in self.warnings]
        return "".join(lines)


@dataclass(frozen=True)
class RangeResult:
    """How far away the target is. True where there is an answer.

    Attributes
    ----------
    distance_mm, sigma_mm : float or None
        The distance and its standard uncertainty; None where most runs found no focus.
    position : float or None
        Mean position of the foci.
    foci : list of FocusResult
        One for each run.
    warnings : list of str
    values : dict
        All numbers.
    """

    distance_mm: Optional[float]
    sigma_mm: Optional[float]
    position: Optional[float]
    foci: List[FocusResult]
    warnings: List[str]
    values: Dict[str, Any] = field(repr=False, default_factory=dict)

    @classmethod
    def _of(cls, values: Dict[str, Any], unit: str) -> "RangeResult":
        return cls(
            distance_mm=values["distance_mm"],
            sigma_mm=values.get("sigma_mm"),
            position=values.get("position"),
            foci=[FocusResult._of(one, unit) for one in values["foci"]],
            warnings=[one["text"] for one in values.get("warnings", [])],
            values=values,
        )

    def __bool__(self) -> bool:
        return self.distance_mm is not None

    def __str__(self) -> str:
        if not self:
            return f"no distance: {self.foci[-1]}"
        return f"distance {self.distance_mm:.1f} mm +- {self.sigma_mm:.1f} mm"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(str(self))}</p>" + self.foci[-1]._repr_html_()


@dataclass(frozen=True)
class Event:
    """One thing that happened in a measurement.

    Attributes
    ----------
    name : str
        'began', 'frame', 'evaluated', 'found', 'warned' or 'done'.
    values : dict
        evaluated: position, score. frame: image, position, score. warned: kind and its numbers.
        began: scatter, repeats, positions. done: result.
    """

    name: str
    values: Dict[str, Any]

    @property
    def text(self) -> str:
        """In words, of a warning; else empty."""
        return str(self.values["text"]) if self.name == "warned" else ""
