# SPDX-License-Identifier: Apache-2.0
"""Measure focus, and from focus, distance.

``score`` gives the focus quality of windows of pictures, ``Plan`` the same of pictures as they come.
``focus`` finds the sharpest plane of a stack, ``depth`` that of each of its pixels, ``open_rig`` and ``rig``
that of a lens; ``Calibration`` turns it into a distance. Pictures are numpy arrays of uint8 or uint16, used in place.

Examples
--------
>>> import numpy, fathom
>>> picture = numpy.zeros((256, 256), numpy.uint8)
>>> picture[100:140, 100:140] = 200
>>> fathom.score(picture, 'walsh-sequency:64', windows=[(96, 96)]).shape
(1,)
"""

import atexit as _atexit
from typing import Any as _Any

from . import _fathom, optics
from ._calibration import Calibration, Distance
from ._depth import depth
from ._errors import ArgumentError, CopyWarning, Error, FileError, PictureWarning
from ._fathom import version as __version__
from ._maps import Maps
from ._micro_manager import MicroManager, micro_manager
from ._results import Curve, Event, FocusResult, Peak, RangeResult
from ._rig import Rig, open_rig, rig
from ._screen import screen
from ._scoring import Plan, devices, score, spectrum
from ._stack import fit, focus

__all__ = [
    "ArgumentError", "Calibration", "CopyWarning", "Curve", "Distance", "Error", "Event", "FileError",
    "FocusResult", "Maps", "MicroManager", "Peak", "PictureWarning", "Plan", "RangeResult", "Rig", "depth", "devices", "fit", "focus",
    "micro_manager", "open_rig", "optics", "rig", "score", "screen", "spectrum", "__version__",
]


def __getattr__(name: str) -> _Any:
    """fathom.dask is imported when it is asked for: Dask takes a while, and need not be there."""
    if name == "dask":
        import importlib

        return importlib.import_module(".dask", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


# What calls keep for each other is given back while devices are still there.
_atexit.register(_fathom.clear_pool)
