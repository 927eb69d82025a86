# SPDX-License-Identifier: Apache-2.0
"""Types that several modules name."""

from __future__ import annotations

from typing import Any, Sequence, Tuple, Union

import numpy as np

Array = np.ndarray[Any, Any]
Floats = np.ndarray[Any, np.dtype[np.float64]]
Numbers = Union[Sequence[float], Array]
Corner = Tuple[int, int]  # left column and top row, px
Corners = Union[None, Corner, Sequence[Corner], Array]
