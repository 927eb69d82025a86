# SPDX-License-Identifier: Apache-2.0
"""From lens position to distance."""

from __future__ import annotations

import html
import operator
import os
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from . import _fathom
from ._errors import ArgumentError
from ._given import finite, flag, from_0, number, numbers, path as path_of, text
from ._results import FocusResult
from ._types import Array, Numbers


class Distance(NamedTuple):
    """A distance and its standard uncertainty, mm."""

    mm: float
    sigma_mm: float


class Calibration:
    """A curve between lens positions and distances, fitted to targets at known distances.

    Made by `fit` or `load`; immutable.

    Examples
    --------
    >>> calibration = Calibration.fit([100, 200, 300, 400], [400, 200, 133.3, 100], model='inverse')
    >>> round(calibration.distance_mm(250))
    160
    """

    def __init__(self, core: "_fathom.Calibration"):
        self._core = core

    @classmethod
    def fit(
        cls,
        positions: Union[Array, Sequence[Union[float, FocusResult]], Sequence[FocusResult], Sequence[float]],
        distances_mm: Numbers,
        model: Optional[str] = None,
        sigmas: Optional[Numbers] = None,
        **conditions: Any,
    ) -> "Calibration":
        """Fits positions by least squares, without outliers.

        Parameters
        ----------
        positions : sequence of float or FocusResult
            Lens positions of the foci. A FocusResult gives its sigma, its unit and the object's spectrum,
            too; one without a focus is refused.
        distances_mm : sequence of float
            Of the target at each of them.
        model : str, optional
            'inverse', 'power', 'dioptre' or 'thin-lens'; without it the one that predicts best what it has not seen.
        sigmas : sequence of float, optional
            Standard uncertainties of the positions.
        **conditions
            What was measured with: rig, metric, unit (texts), window (x, y, n).

        Raises
        ------
        ValueError
            For too few points, or points that no lens has, or foci in different units.
        TypeError
            For a condition that there is not.
        """
        if unknown := conditions.keys() - {"rig", "metric", "unit", "window"}:
            raise TypeError(f"fit() got an unexpected argument {sorted(unknown)[0]!r}")
        if isinstance(positions, (str, bytes, dict)) or not hasattr(positions, "__iter__"):
            raise ArgumentError(f"positions is {positions!r}; it is a sequence of numbers or of FocusResult")
        positions = list(positions)
        _require_conditions(conditions)
        foci = [p for p in positions if isinstance(p, FocusResult)]
        for i, focus in enumerate(positions):
            if isinstance(focus, FocusResult) and not focus:
                raise ArgumentError(f"positions[{i}] is no focus: {focus}")
        if foci and foci[0].unit:
            conditions.setdefault("unit", foci[0].unit)
        for i, focus in enumerate(positions):
            if isinstance(focus, FocusResult):
                _require_unit(focus, f"positions[{i}]", conditions.get("unit", ""))
        places = numbers([p.position if isinstance(p, FocusResult) else p for p in positions], "positions")
        own = [p.sigma or 0.0 if isinstance(p, FocusResult) else 0.0 for p in positions]
        spectra = [p.values.get("spectrum", []) if isinstance(p, FocusResult) else [] for p in positions]
        places = [finite(place, f"positions[{i}]") for i, place in enumerate(places)]
        given = own if sigmas is None else [from_0(s, f"sigmas[{i}]") for i, s in enumerate(numbers(sigmas, "sigmas"))]
        distances = [finite(d, f"distances_mm[{i}]") for i, d in enumerate(numbers(distances_mm, "distances_mm"))]
        return cls(_fathom.Calibration.fit(places, distances, given, spectra, model, conditions))

    @classmethod
    def load(cls, path: Union[str, "os.PathLike[str]"]) -> "Calibration":
        """Reads what `save` or `fathom calibrate` wrote. Raises OSError, or fathom.Error 'bad_data'."""
        return cls(_fathom.Calibration.load(path_of(path, "path")))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes JSON that `load` and the program read. Raises OSError."""
        self._core.save(path_of(path, "path"))

    def distance(self, position: Union[float, FocusResult], sigma: float = 0.0,
                 extrapolate: bool = False) -> Distance:
        """The distance at a lens position, with sigma.

        Parameters
        ----------
        position : float or FocusResult
            A FocusResult brings its own sigma.
        sigma : float
            Standard uncertainty of the position.
        extrapolate : bool
            Whether positions outside of the calibration are answered.

        Raises
        ------
        ValueError
            For a position that the calibration does not cover, or a FocusResult without a focus or in another unit.
        """
        beyond = flag(extrapolate, "extrapolate")
        if isinstance(position, FocusResult):
            if position.position is None:
                raise ArgumentError(f"position is no focus: {position}")
            _require_unit(position, "position", self.conditions.get("unit", ""))
            return Distance(*self._core.distance(position.position, position.sigma or 0.0, beyond))
        return Distance(*self._core.distance(number(position, "position"), number(sigma, "sigma"), beyond))

    def distance_mm(self, position: float) -> float:
        """The curve alone, without any check; inf beyond the focus on infinity."""
        return self._core.distance_mm(number(position, "position"))

    def interval(self, position: float, coverage: float = 0.95) -> Tuple[float, float]:
        """From where to where, mm, the target of one more focus at a position lies, with the probability `coverage`."""
        return self._core.interval(number(position, "position"), number(coverage, "coverage"))

    def position_for(self, distance_mm: float) -> float:
        """The position that focuses a distance; nan where none does."""
        return self._core.position_for(number(distance_mm, "distance_mm"))

    def covers(self, position: float) -> bool:
        """Whether the calibration may be asked for this position."""
        return self._core.covers(number(position, "position"))

    @property
    def model(self) -> str:
        """'inverse', 'power', 'dioptre' or 'thin-lens'."""
        return self._core.model

    @property
    def equation(self) -> str:
        """The formula with its values in it."""
        return self._core.equation

    @property
    def parameters(self) -> Dict[str, Tuple[float, float]]:
        """Value and standard uncertainty of each parameter."""
        return self._core.parameters

    @property
    def points(self) -> List[Tuple[float, float, float, bool]]:
        """Position, distance in mm, sigma of the position, and whether it is left out, of each point."""
        return self._core.points

    @property
    def r_squared(self) -> float:
        """Coefficient of determination of the distances."""
        return self._core.r_squared

    @property
    def position_scatter(self) -> float:
        """Standard uncertainty of one position about the curve; 0 where nothing can be said."""
        return self._core.position_scatter

    @property
    def travel(self) -> Tuple[float, float]:
        """Lowest and highest position that it covers."""
        return self._core.lowest_position, self._core.highest_position

    @property
    def conditions(self) -> Dict[str, Any]:
        """What was measured with: rig, metric, unit, window."""
        return self._core.conditions

    def __reduce__(self) -> Any:
        return _parse, (self._core.json(),)

    def __repr__(self) -> str:
        return f"<Calibration {self.equation}, R^2 = {self.r_squared:.4f}, {len(self.points)} points>"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{p:g}</td><td>{d:g}</td></tr>" for p, d, _, _ in self.points)
        return (f"<p>{html.escape(repr(self))}</p><table><tr><th>position</th><th>mm</th></tr>"
                f"{rows}</table>")

    def plot(self, ax: Any = None) -> Any:
        """Draws points and curve with matplotlib and returns the axes."""
        if ax is None:
            from matplotlib import pyplot

            ax = pyplot.figure().add_subplot()
        ax.plot([p[0] for p in self.points], [p[1] for p in self.points], "o")
        low, high = self.travel
        places = [low + (high - low) * i / 100 for i in range(101)]
        ax.plot(places, [self.distance_mm(place) for place in places])
        ax.set_xlabel("position")
        ax.set_ylabel("distance (mm)")
        return ax


def _require_unit(focus: FocusResult, name: str, unit: str) -> None:
    """Positions are compared by their numbers alone, so they must count the same."""
    if focus.unit and unit and focus.unit != unit:
        raise ArgumentError(f"{name} is a focus in {focus.unit}, and the calibration is in {unit}; where these are the "
                            f"same, measure with unit={unit!r}")


def _require_conditions(conditions: Dict[str, Any]) -> None:
    for name in ("rig", "metric", "unit"):
        if name in conditions:
            conditions[name] = text(conditions[name], name)
    if "window" in conditions:
        window = conditions["window"]
        try:
            x, y, n = (operator.index(value) for value in window)
        except (TypeError, ValueError):
            raise ArgumentError(f"window is {window!r}; it is (x, y, n), as rig.conditions has it") from None
        conditions["window"] = (x, y, n)


def _parse(json: str) -> Calibration:
    return Calibration(_fathom.Calibration.parse(json))
