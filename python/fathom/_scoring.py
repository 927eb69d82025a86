# SPDX-License-Identifier: Apache-2.0
"""Focus quality of windows of pictures."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Union, overload

import numpy as np

from . import _fathom
from ._named import arranged, is_named
from ._types import Array, Corner, Corners, Floats

@overload
def score(image: Any, metric: str, windows: Union[Sequence[Corner], Array], stride: None = ...,
          backend: Optional[str] = ..., threads: Optional[int] = ...) -> Floats: ...
@overload
def score(image: Any, metric: str = ..., *, windows: Union[Sequence[Corner], Array], stride: None = ...,
          backend: Optional[str] = ..., threads: Optional[int] = ...) -> Floats: ...
@overload
def score(image: Any, metric: str = ..., windows: None = ..., *, stride: int, backend: Optional[str] = ...,
          threads: Optional[int] = ...) -> Floats: ...
@overload
def score(image: Any, metric: str = ..., windows: Optional[Corner] = ..., stride: Optional[int] = ...,
          backend: Optional[str] = ..., threads: Optional[int] = ...) -> Any: ...


def score(
    image: Any,
    metric: str = "walsh-sequency:64",
    windows: Corners = None,
    stride: Optional[int] = None,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
) -> Any:
    """Focus quality of windows of a picture, or of every picture of a stack.

    Parameters
    ----------
    image : numpy.ndarray
        Grey pixels of uint8, uint16 or bool: (rows, columns), or a stack (pictures, rows, columns).
        Used in place where the pixels of a row lie side by side, whatever the strides of rows and
        pictures are. Others (Fortran order, negative strides, the other byte order) are copied once,
        which the warning CopyWarning says. An xarray.DataArray may have y and x anywhere.
    metric : str
        TRANSFORM:N and what may follow, such as 'fft:64:hann:power:rings=8'. N is the side of the
        windows, px: a power of two from 8 to 512.
    windows : (x, y), sequence of (x, y), or integer array of shape (K, 2), optional
        Left column and top row of each window, px. Without it, the one window in the middle.
    stride : int, optional
        Instead of windows: a grid of them from (0, 0) on, so many px apart.
    backend : str, optional
        'auto', 'cpu', 'reference', 'vulkan', 'opencl', or one device of them, 'vulkan:1'. Without it,
        what the environment variable FATHOM_BACKEND says, else 'auto'.
    threads : int, optional
        Processors that this call may use. Without it, what FATHOM_THREADS says, else all.

    Returns
    -------
    float or numpy.ndarray of float64
        One value for each window, K of them with rings=K. Axes in this order, each only where there
        is one: pictures of the stack; windows (K), or rows and columns of the grid; rings. A float
        where there is no axis. The values have the unit of the metric (docs/metrics.md).

    Raises
    ------
    ValueError
        For pixels, metric or windows that have no meaning, or a window over the edge.
    fathom.Error
        With `code` 'unavailable' or 'unsupported' for a backend that is not there or declines.

    Notes
    -----
    Python's lock is released while it computes, so several threads work at once. What a call needs is
    kept for the next one of the same metric, backend, threads and number of windows.
    """
    if type(image) is not np.ndarray and is_named(image):
        image = arranged(image, 2, "image").values
    return _fathom.score(image, metric, windows, stride, backend, threads)


def spectrum(
    image: Any,
    metric: str = "fft:64",
    window: Optional[Corner] = None,
    backend: Optional[str] = None,
    threads: Optional[int] = None,
) -> Array:
    """Coefficients of the transform of one window, with 1/N^2 in front and the taper applied.

    Parameters
    ----------
    image : numpy.ndarray
        One grey picture, as `score` takes it.
    metric : str
        TRANSFORM:N and a taper; what else it says does not count.
    window : (x, y), optional
        Left column and top row, px; the middle of the picture without it.
    backend, threads : optional
        As in `score`.

    Returns
    -------
    numpy.ndarray of shape (N, N)
        complex128 for fft, zero frequency at [N/2, N/2]; float64 for the others, in their own order.

    Raises
    ------
    ValueError, fathom.Error
        As `score`.
    """
    return _fathom.spectrum(image, metric, window, backend, threads)


class Plan:
    """Scores windows of pictures as they come: the next is on its way while the last is computed.

    Parameters
    ----------
    metric : str
        As in `score`.
    capacity : int
        Most windows of one picture.
    backend, threads : optional
        As in `score`.

    Raises
    ------
    ValueError, fathom.Error
        As `score`; ValueError, too, where two threads use one plan at the same time.

    Examples
    --------
    >>> with Plan('fft:64:hann', 4, backend='cpu') as plan:
    ...     ticket = plan.submit(np.zeros((64, 64), np.uint8), [(0, 0)])
    ...     values = plan.wait(ticket)
    >>> values.shape
    (1,)
    """

    def __init__(
        self,
        metric: str,
        capacity: int = 1,
        backend: Optional[str] = None,
        threads: Optional[int] = None,
    ):
        self._plan = _fathom.Plan(metric, capacity, backend, threads)

    def submit(self, image: Any, windows: Corners = None, out: Optional[Floats] = None) -> int:
        """Starts to score a picture; waits where the device's queue is full.

        Parameters
        ----------
        image : numpy.ndarray
            One grey picture, as `score` takes it. It is held, and must not be written to, until `wait`.
        windows : (x, y), sequence of (x, y), or integer array of shape (K, 2), optional
            As in `score`; not more than `capacity`.
        out : numpy.ndarray of float64, optional
            Of shape (windows,) or (windows, rings): room for the values, so that no array is made.

        Returns
        -------
        int
            A ticket for `wait`.

        Raises
        ------
        ValueError
            As `score`, and for more windows than `capacity`, or an `out` of another shape.
        """
        return self._plan.submit(image, windows, out)

    def wait(self, ticket: int) -> Floats:
        """The values of a ticket, once they are there; each ticket is waited for once.

        Returns
        -------
        numpy.ndarray of float64
            (windows,) or (windows, rings); `out`, where there was one.

        Raises
        ------
        ValueError
            For a ticket of no batch in flight.
        fathom.Error
            With `code` 'timeout' or 'device_lost', of a device that does not answer.
        """
        return self._plan.wait(ticket)

    def score(self, image: Any, windows: Corners = None, out: Optional[Floats] = None) -> Floats:
        """`submit` and `wait` at once: image, windows and out as there."""
        return self._plan.wait(self._plan.submit(image, windows, out))

    def close(self) -> None:
        """Waits for what is in flight and gives the device back."""
        self._plan.close()

    def __enter__(self) -> "Plan":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    @property
    def metric(self) -> str:
        """The metric's canonical text."""
        return self._plan.metric

    @property
    def outputs(self) -> int:
        """Numbers that one window gives."""
        return self._plan.outputs

    @property
    def capacity(self) -> int:
        """Most windows of one picture."""
        return self._plan.capacity

    @property
    def device(self) -> str:
        """What computes, and why it was chosen, in one line."""
        return self._plan.device


def devices() -> List[Dict[str, str]]:
    """What can compute here, as the drivers tell.

    Returns
    -------
    list of dict
        backend, name, kind and details of each device, all texts.
    """
    return _fathom.devices()
