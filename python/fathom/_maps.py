# SPDX-License-Identifier: Apache-2.0
"""What a stack tells of the depth of every pixel."""

from __future__ import annotations

import base64
import datetime
import html
import math
import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np

from . import _fathom
from ._errors import ArgumentError
from ._given import flag, path as path_of
from ._types import Array

_WIDEST_PX = 640


@dataclass(frozen=True, eq=False)
class Maps:
    """A map of depth with its uncertainty, and the picture that is sharp everywhere.

    All arrays have the rows and columns of a picture.

    Attributes
    ----------
    depth : numpy.ndarray of float32
        Where each pixel is sharp, in `unit`; nan where that is not known.
    sigma : numpy.ndarray of float32
        Its standard uncertainty, in `unit`; nan likewise.
    confidence : numpy.ndarray of float32
        How sure it is, 0 to 1, that this is a focus, and the right one.
    index : numpy.ndarray of uint16
        Which picture of the stack is the sharpest there, from 0 on; the first one of its position.
    classes : numpy.ndarray of uint8
        What is known of each pixel: a place in `class_names`.
    sharp : numpy.ndarray of uint8 or uint16
        The picture that is sharp everywhere: grey, or (rows, columns, 3) of a stack of colours.
    unit : str
        Of depth and sigma: that of the positions, or 'mm' with a calibration.
    positions : numpy.ndarray of float64
        Where each picture of the stack was taken, in `lens_unit`.
    lens_unit : str
        Of positions.
    warnings : list of str
        What should be known of the pictures.
    values : dict
        How it was made: summary (low, high, nearest, farthest, median_sigma, parts of the classes),
        blur, facts (window, stride, align, moved_px, backend, seconds), seen (a row of each position:
        scale, angle_rad, dx_px and dy_px by which the picture lies off the first one, and the gain
        that makes it as bright).
    class_names : tuple of str
        'known', 'filled', 'no-texture', 'two-depths', 'at-end', 'outside'.
    """

    depth: Array
    sigma: Array
    confidence: Array
    index: Array
    classes: Array
    sharp: Array
    unit: str
    positions: Array
    lens_unit: str
    warnings: List[str] = field(default_factory=list)
    values: Dict[str, Any] = field(repr=False, default_factory=dict)
    class_names: Tuple[str, ...] = _fathom.depth_classes

    @classmethod
    def _of(cls, values: Dict[str, Any], positions: Array, places: Array) -> "Maps":
        """places: which of the map's positions each picture of the stack belongs to."""
        arrays = {name: values.pop(name) for name in ("depth", "sigma", "confidence", "classes", "sharp")}
        values["places"] = places
        index = values.pop("index")
        if not np.array_equal(places, np.arange(len(places))):
            _, first = np.unique(places, return_index=True)
            index = first.astype(np.uint16)[index]
        return cls(index=index, unit=values["unit"], lens_unit=values["lens_unit"], positions=positions,
                   warnings=[one["text"] for one in values.pop("warnings", [])], values=values, **arrays)

    def where(self, name: str) -> Array:
        """Which pixels are of a class: an array of bool."""
        if name not in self.class_names:
            raise ArgumentError(f"name is {name!r}; the classes are {', '.join(self.class_names)}")
        return np.equal(self.classes, self.class_names.index(name))

    def save(self, folder: Union[str, "os.PathLike[str]"], *, ply: bool = False, obj: bool = False,
             sharp_tiff: bool = False) -> List[str]:
        """Writes what `fathom depth -o folder` writes, all or nothing, and returns the names.

        depth.tif, sigma.tif, confidence.tif and index.tif (numbers), sharp.png, depth.png, hill.png and
        class.png (pictures), report.json, and view.html to look at. index.tif counts positions in the
        order of report.json.

        Parameters
        ----------
        folder : str or path
            Made where it is not there.
        ply, obj : bool
            depth.ply, depth.obj: a surface with colours, too.
        sharp_tiff : bool
            sharp.tif in place of sharp.png.

        Raises
        ------
        OSError
            Where the system refuses to write.
        """
        now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        target = path_of(folder, "folder")
        extra = {"ply": flag(ply, "ply"), "obj": flag(obj, "obj"), "sharp_tiff": flag(sharp_tiff, "sharp_tiff")}
        places = self.values["places"]
        index = np.asarray(places, np.uint16)[self.index]
        arrays = {"depth": self.depth, "sigma": self.sigma, "confidence": self.confidence, "index": index,
                  "classes": self.classes, "sharp": self.sharp}
        return _fathom.save_depth({**self.values, **arrays}, target, now, extra)

    def plot(self, ax: Any = None) -> Any:
        """Draws the depth with matplotlib, with a bar of its colours, and returns the axes."""
        if ax is None:
            from matplotlib import pyplot

            ax = pyplot.figure().add_subplot()
        low, high = self._span()
        picture = ax.imshow(self.depth, vmin=low, vmax=high)
        ax.figure.colorbar(picture, ax=ax, label=f"depth ({self.unit})")
        return ax

    def _span(self) -> Tuple[Optional[float], Optional[float]]:
        summary = self.values["summary"]
        return (summary["low"], summary["high"]) if math.isfinite(summary["low"]) else (None, None)

    def __str__(self) -> str:
        summary, (rows, columns) = self.values["summary"], self.depth.shape
        parts = ", ".join(f"{name} {100 * part:.1f} %" for name, part in summary["parts"].items()
                          if part > 0 or name == "known")
        text = f"{columns} x {rows} px: {parts}"
        if not math.isfinite(summary["low"]):
            return text
        return (f"{text}; depths from {summary['low']:.5g} to {summary['high']:.5g} {self.unit}, "
                f"sigma {summary['median_sigma']:.2g} {self.unit} in the middle")

    def __repr__(self) -> str:
        return f"<Maps {self}>"

    def _repr_html_(self) -> str:
        step = max(1, -(-max(self.depth.shape) // _WIDEST_PX))
        depth = np.ascontiguousarray(self.depth[::step, ::step])
        low, high = (math.nan if end is None else end for end in self._span())
        png = base64.b64encode(_fathom.depth_png(depth, low, high, self.unit)).decode("ascii")
        lines = [f"<p>{html.escape(str(self))}</p>", f'<img src="data:image/png;base64,{png}"/>']
        lines += [f"<p>{html.escape(one)}</p>" for one in self.warnings]
        return "".join(lines)
