# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends what would take hours. A call that does not listen runs into the time limit of all tests."""

import _thread
import threading

import fathom
import numpy as np
import pytest

LARGE = np.broadcast_to(np.arange(8000, dtype=np.uint16).view(np.uint8)[:8000] * 37, (8000, 8000)).copy()
ENDLESS = np.broadcast_to(LARGE[None, :512, :512], (100_000, 512, 512))

CALLS = {
    "a grid": lambda: fathom.score(LARGE, "fft:512:hann", stride=2, backend="cpu"),
    "a list": lambda: fathom.score(LARGE, "fft:512:hann", windows=np.zeros((2_000_000, 2), int), backend="cpu"),
    "the oracle": lambda: fathom.score(LARGE, "fft:64:hann", stride=2, backend="reference"),
    "a stack": lambda: fathom.score(ENDLESS, "fft:64", stride=4, backend="cpu"),
    "a focus": lambda: fathom.focus(ENDLESS, metric="fft:512", search="full", backend="cpu"),
    "a map": lambda: fathom.depth(np.broadcast_to(LARGE[None, :2000, :2000], (60_000, 2000, 2000)), stride=500),
}


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_ends(name):
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            CALLS[name]()
    finally:
        timer.join()
    # What was interrupted leaves nothing behind.
    assert fathom.score(LARGE, "walsh-sequency:64", windows=[(0, 0)], backend="cpu") == fathom.score(
        LARGE[:64, :64], "walsh-sequency:64", backend="cpu")
