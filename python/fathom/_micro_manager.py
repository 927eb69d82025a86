# SPDX-License-Identifier: Apache-2.0
"""Micro-Manager's cameras and stages, by its core: pymmcore, pymmcore-plus, or what has that face."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from ._errors import ArgumentError
from ._given import wished_text
from ._rig import Rig, rig
from ._types import Array


class MicroManager:
    """A Micro-Manager core as a camera and a stage for `fathom.rig`. Nothing of it is imported here.

    Parameters
    ----------
    core : object
        With snapImage, getImage, setPosition, getPosition, waitForDevice and getFocusDevice.
    stage : str, optional
        Label of the stage; the core's focus device without it.
    """

    def __init__(self, core: Any, stage: Optional[str] = None):
        for name in ("snapImage", "getImage", "setPosition", "getPosition", "waitForDevice", "getFocusDevice"):
            if not callable(getattr(core, name, None)):
                raise ArgumentError(f"core ({type(core).__name__}) has no {name}()")
        self._core = core
        self.stage = wished_text(stage, "stage") or core.getFocusDevice()
        if not self.stage:
            raise ArgumentError("core has no focus device; give stage=, its label")

    def snap(self) -> Array:
        """One picture, exposed now."""
        self._core.snapImage()
        return np.asarray(self._core.getImage())

    def move_to(self, position: float) -> None:
        """Moves and waits until the stage is no longer busy."""
        self._core.setPosition(self.stage, position)
        self._core.waitForDevice(self.stage)

    @property
    def position(self) -> float:
        """Where the stage stands, um."""
        return float(self._core.getPosition(self.stage))


def micro_manager(core: Any, stage: Optional[str] = None, *, lowest: float, highest: float,
                  resolution: float = 0.1, **options: Any) -> Rig:
    """A rig of a Micro-Manager core: `fathom.rig` of `MicroManager(core, stage)`.

    Parameters
    ----------
    core : object
        Such as pymmcore_plus.CMMCorePlus(), with its devices loaded.
    stage : str, optional
        Label of the stage; the core's focus device without it.
    lowest, highest : float
        Ends of the travel, um. Mind the objective: the core knows no limits.
    resolution : float
        Smallest move that means anything, um.
    **options
        As of `fathom.rig`.

    Returns
    -------
    Rig

    Raises
    ------
    ValueError
        For a core without these functions, or without a focus device where no stage is named.
    """
    device = MicroManager(core, stage)
    exposure = getattr(core, "getExposure", None)
    options.setdefault("exposure_ms", float(exposure()) if callable(exposure) else 0.0)
    options.setdefault("description", f"Micro-Manager, stage {device.stage}")
    return rig(device, lowest=lowest, highest=highest, resolution=resolution, unit="um", **options)
