# SPDX-License-Identifier: Apache-2.0
"""Cameras and lenses that are measured with."""

from __future__ import annotations

import queue
import threading
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _fathom
from ._calibration import Calibration
from ._errors import ArgumentError, warn_of
from ._given import above_0, count, finite, flag, from_0, function, number, numbers, text as text_of, wished_text
from ._results import Curve, Event, FocusResult, RangeResult
from ._types import Array, Corner, Numbers

Observer = Callable[[Event], None]


class Rig:
    """A camera, a lens and a metric. Made by `open_rig` and `rig`; a context manager.

    One thread at a time measures with a rig. Ctrl-C ends a measurement with KeyboardInterrupt after the
    lens was put back; a second Ctrl-C ends the way back, too.

    An observer is called with each `Event` of a measurement while it runs, in the measuring thread. What
    it raises ends the measurement, and the lens goes back.
    """

    def __init__(self, instrument: "_fathom.Instrument"):
        self._instrument = instrument

    def focus(self, *, stay: bool = True, observer: Optional[Observer] = None, frames_too: bool = False,
              **wishes: Any) -> FocusResult:
        """Searches for the focus and leaves the lens there.

        Parameters
        ----------
        stay : bool
            Whether the lens stays at the focus; it goes back where there is none.
        observer : callable(Event), optional
            Told of everything.
        frames_too : bool
            Whether the observer gets copies of the pictures as well.
        **wishes
            from_, to, search, peak, tolerance, frames, start, blur: as in `fathom.focus`. start is where a
            search by spectra begins. moving: whether pictures are taken while the lens travels.

        Returns
        -------
        FocusResult

        Raises
        ------
        ValueError, OSError, fathom.Error
            For wishes that have no meaning; where camera or lens fail.
        """
        result = self._focus(wishes, stay, observer, frames_too)
        warn_of(result.values["warnings"])
        return result

    def _focus(self, wishes: Dict[str, Any], stay: bool = True, observer: Optional[Observer] = None,
               frames_too: bool = False) -> FocusResult:
        """As focus, which warns of what the result says of files."""
        tell, frames = _teller(observer), flag(frames_too, "frames_too")
        values = self._instrument.focus(wishes, flag(stay, "stay"), tell, frames and tell is not None)
        return FocusResult._of(values, self.unit)

    def sweep(self, from_: Optional[float] = None, to: Optional[float] = None, step: Optional[float] = None,
              *, observer: Optional[Observer] = None, frames_too: bool = False) -> Curve:
        """Scores every position of the travel, or of a part of it, and puts the lens back.

        Parameters
        ----------
        from_, to : float, optional
            Ends of the part, in `unit`; those of the travel without them.
        step : float, optional
            Between the positions, in `unit`; some hundred positions without it.
        observer, frames_too : optional
            As in `focus`.

        Returns
        -------
        Curve

        Raises
        ------
        ValueError, OSError, fathom.Error
            For a part that the travel has not; where camera or lens fail.
        """
        tell, frames = _teller(observer), flag(frames_too, "frames_too")
        values = self._instrument.sweep(from_, to, step, tell, frames and tell is not None)
        found = values.pop("warnings")
        warn_of(found)
        warnings = [one["text"] for one in found]
        return Curve(unit=self.unit, warnings=warnings, **values)

    def range(self, calibration: Calibration, *, repeat: int = 1, extrapolate: bool = False,
              observer: Optional[Observer] = None, **wishes: Any) -> RangeResult:
        """Measures how far away the target is, and puts the lens back.

        Parameters
        ----------
        calibration : Calibration
            Of this rig.
        repeat : int
            Focus runs whose mean position counts.
        extrapolate : bool
            Whether positions outside of the calibration are answered.
        observer : callable(Event), optional
            As in `focus`.
        **wishes
            As in `focus`.

        Returns
        -------
        RangeResult

        Raises
        ------
        ValueError
            For a calibration of another unit, or a position that it does not cover.
        """
        if not isinstance(calibration, Calibration):
            raise ArgumentError(f"calibration is a {type(calibration).__name__}; it is a fathom.Calibration, as "
                                "Calibration.fit or Calibration.load gives it")
        values = self._instrument.range(calibration._core, wishes, repeat, flag(extrapolate, "extrapolate"),
                                        _teller(observer), False)
        warn_of(values["warnings"])
        return RangeResult._of(values, self.unit)

    def capture(self, position: Union[None, float, Numbers] = None) -> Array:
        """Takes a picture, (rows, columns), where the lens stands or at a position, and stays there.

        Several positions give a stack (positions, rows, columns); then the lens goes back.
        """
        if position is None or isinstance(position, (int, float)) or np.isscalar(position):
            return self._instrument.capture(position)
        places = numbers(position, "position")
        if not places:
            raise ArgumentError("position is empty")
        start = self.position
        try:
            return np.stack([self._instrument.capture(place) for place in places])
        finally:
            self.move_to(start)

    def events(self, measurement: str = "focus", **arguments: Any) -> Iterator[Event]:
        """The events of a measurement, as they come; the last is 'done', with the result.

        measurement: 'focus', 'sweep' or 'range', with its own arguments. It runs in a thread of its own.
        Who stops iterating stops it, and the lens is put back.
        """
        if not isinstance(measurement, str) or measurement not in ("focus", "sweep", "range"):
            raise ArgumentError(f"measurement is {measurement!r}; it is 'focus', 'sweep' or 'range'")
        return self._events(getattr(self, measurement), arguments)

    def _events(self, measure: Callable[..., Any], arguments: Dict[str, Any]) -> Iterator[Event]:
        events: "queue.Queue[Any]" = queue.Queue()

        def work() -> None:
            try:
                result = measure(observer=events.put, **arguments)
                events.put(Event("done", {"result": result}))
            except BaseException as problem:  # it is raised where somebody iterates
                events.put(problem)

        thread = threading.Thread(target=work, name="fathom", daemon=True)
        thread.start()
        try:
            while True:
                event = events.get()
                if isinstance(event, BaseException):
                    raise event
                yield event
                if event.name == "done":
                    return
        finally:
            if thread.is_alive():
                self.stop()
            thread.join()

    def move_to(self, position: float) -> float:
        """Moves the lens, waits until it has settled, and returns where it stands."""
        return self._instrument.move_to(position)

    @property
    def position(self) -> float:
        """Where the lens stands, in `unit`."""
        return self._instrument.position()

    @property
    def unit(self) -> str:
        """Of positions."""
        return str(self._instrument.about()["unit"])

    @property
    def travel(self) -> Tuple[float, float]:
        """Lowest and highest position."""
        about = self._instrument.about()
        return about["lowest"], about["highest"]

    @property
    def about(self) -> Dict[str, Any]:
        """What it is: description, metric, window (x, y, n), unit, lowest, highest, resolution, stops, backend."""
        return self._instrument.about()

    @property
    def conditions(self) -> Dict[str, Any]:
        """What `Calibration.fit` should know: `Calibration.fit(foci, distances, **rig.conditions)`."""
        about = self._instrument.about()
        return {"rig": about["description"], "metric": about["metric"], "unit": about["unit"],
                "window": about["window"]}

    @property
    def target_mm(self) -> Optional[float]:
        """Distance of the target, of a rig that places it itself (sim:); else None."""
        return self._instrument.target_mm()

    def place_target(self, distance_mm: float) -> None:
        """Puts the target there. Raises fathom.Error 'unsupported' where the rig cannot."""
        self._instrument.place_target(distance_mm)

    def stop(self) -> None:
        """Ends the measurement that is under way, from an observer or another thread."""
        self._instrument.stop()

    def close(self) -> None:
        """Gives camera and lens back."""
        self._instrument.close()

    def __enter__(self) -> "Rig":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        try:
            return f"<fathom.Rig {self.about['description']}>"
        except ArgumentError:
            return "<fathom.Rig, closed>"


def _teller(observer: Optional[Observer]) -> Optional[Callable[[str, Dict[str, Any]], None]]:
    tell = function(observer, "observer")
    if tell is None:
        return None

    def told(name: str, values: Dict[str, Any]) -> None:
        tell(Event(name, values))

    return told


def _measures(metric: Optional[str], window: Optional[Corner], average: int, backend: Optional[str],
              threads: Optional[int]) -> "_fathom.Measures":
    return _fathom.Measures(_fathom.search_metric if metric is None else metric, window, average, backend, threads)


def open_rig(
    text: str,
    metric: Optional[str] = None,
    window: Optional[Corner] = None,
    *,
    average: int = 1,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
) -> Rig:
    """Opens camera and lens by a text, as the program does.

    Parameters
    ----------
    text : str
        'sim:target=seedling,distance=1800', 'replay:FOLDER', or a rig file 'webcam.toml' (docs/rigs.md).
    metric : str, optional
        As in `fathom.score`, of one number a window; walsh-sequency:64 without it.
    window : (x, y), optional
        Left column and top row, px; the middle of the picture without it.
    average : int
        Frames averaged for each picture.
    backend, threads : optional
        As in `fathom.score`.

    Returns
    -------
    Rig

    Raises
    ------
    ValueError
        For a text or a setting that has no meaning.
    OSError, fathom.Error
        Where camera or lens is not there, in use, or fails.
    """
    return Rig(_fathom.open_rig(text, _measures(metric, window, average, backend, threads)))


def rig(
    camera: Any,
    stage: Any = None,
    *,
    lowest: float,
    highest: float,
    resolution: Optional[float] = None,
    unit: str = "um",
    position: Optional[float] = None,
    coarse_spacing: float = 0.0,
    blur: Optional[float] = None,
    exposure_ms: float = 0.0,
    stale_frames: int = 0,
    description: Optional[str] = None,
    metric: Optional[str] = None,
    window: Optional[Corner] = None,
    average: int = 1,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
) -> Rig:
    """Makes a rig of any Python camera and stage.

    Parameters
    ----------
    camera : object
        `snap()` returns one grey picture (rows, columns) whose exposure began after the call.
    stage : object, optional
        `move_to(position)` returns when the stage stands still. A `position`, attribute or method, says
        where that is. The camera itself without it.
    lowest, highest : float
        Ends of the travel that may be searched, in `unit`.
    resolution : float, optional
        Smallest move that means anything; a two-thousandth of the travel without it.
    unit : str
        Of positions.
    position : float, optional
        Where the stage stands now, if it does not say so itself.
    coarse_spacing : float
        Widest spacing at which no peak hides between two pictures; 0 where nobody knows.
    blur : float, optional
        Diameter of the disc of confusion, px, that each unit of travel adds: searches become shorter.
    exposure_ms : float
        Of the camera, if known.
    stale_frames : int
        Pictures that `snap()` may still give from before a move; they are thrown away.
    description : str, optional
        What it is, for calibrations and run files; the names of the types without it.
    metric, window, average, backend, threads : optional
        As in `open_rig`.

    Returns
    -------
    Rig

    Raises
    ------
    ValueError
        For objects without these functions, a travel upside down, or a picture that is none.
    """
    stage = camera if stage is None else stage
    _require_faces(camera, stage, position)
    lowest, highest = number(lowest, "lowest"), number(highest, "highest")
    if not (np.isfinite(lowest) and np.isfinite(highest) and lowest < highest):
        raise ArgumentError(f"lowest is {lowest} and highest is {highest}; the travel needs lowest < highest")
    step = (highest - lowest) / 2000 if resolution is None else above_0(resolution, "resolution")
    types = dict.fromkeys(type(one).__name__ for one in (camera, stage))
    name = wished_text(description, "description") or " and ".join(types)
    travel = {"description": name, "unit": text_of(unit, "unit"), "lowest": lowest, "highest": highest,
              "resolution": step, "coarse_spacing": from_0(coarse_spacing, "coarse_spacing"),
              "blur": None if blur is None else above_0(blur, "blur")}
    start = lowest if position is None else finite(position, "position")
    own = {"snap": camera.snap, "move_to": stage.move_to, "position": _position_of(stage),
           "start": start, "exposure_ms": from_0(exposure_ms, "exposure_ms"),
           "stale": count(stale_frames, "stale_frames", least=0), "travel": travel}
    return Rig(_fathom.open_own(own, _measures(metric, window, average, backend, threads)))


def _require_faces(camera: Any, stage: Any, position: Optional[float]) -> None:
    if not callable(getattr(camera, "snap", None)):
        raise ArgumentError(f"camera ({type(camera).__name__}) has no snap()")
    if not callable(getattr(stage, "move_to", None)):
        raise ArgumentError(f"stage ({type(stage).__name__}) has no move_to(position)")
    if position is None and not hasattr(stage, "position"):
        raise ArgumentError("stage has no position, so nobody knows where it stands; give position=")


def _position_of(stage: Any) -> Optional[Callable[[], float]]:
    if not hasattr(stage, "position"):
        return None
    return lambda: float(stage.position() if callable(stage.position) else stage.position)
