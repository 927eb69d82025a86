# SPDX-License-Identifier: Apache-2.0
"""Arguments as numbers, texts and stacks, or a refusal that names them."""

from __future__ import annotations

import math
import operator
import os
from typing import Any, Iterable, List, Optional

import numpy as np

from ._errors import ArgumentError


_MOST = 2**31 - 1  # of counts in the library


def number(value: Any, name: str) -> float:
    """A float. Raises ArgumentError."""
    if not isinstance(value, (str, bytes, bool, np.bool_)):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise _refused(value, name, "a number")


def numbers(values: Iterable[Any], name: str) -> List[float]:
    """Floats. Raises ArgumentError, naming the one that is none."""
    if isinstance(values, (str, bytes, dict)) or not hasattr(values, "__iter__"):
        raise _refused(values, name, "a sequence of numbers")
    return [number(value, f"{name}[{i}]") for i, value in enumerate(values)]


def finite(value: Any, name: str) -> float:
    """A number that is neither infinite nor nan. Raises ArgumentError."""
    found = number(value, name)
    if not math.isfinite(found):
        raise _refused(value, name, "a finite number")
    return found


def above_0(value: Any, name: str) -> float:
    """A finite number above 0. Raises ArgumentError."""
    found = finite(value, name)
    if found <= 0:
        raise _refused(value, name, "above 0")
    return found


def from_0(value: Any, name: str) -> float:
    """A finite number, 0 or more. Raises ArgumentError."""
    found = finite(value, name)
    if found < 0:
        raise _refused(value, name, "0 or more")
    return found


def count(value: Any, name: str, least: int = 1) -> int:
    """An integer from `least` on. Raises ArgumentError."""
    try:
        found = operator.index(value)
    except TypeError:
        found = None
    if found is None or isinstance(value, bool):
        raise _refused(value, name, "an integer")
    if found < least:
        raise _refused(value, name, f"{least} or more")
    if found > _MOST:
        raise _refused(value, name, "an integer that is not so large")
    return found


def text(value: Any, name: str) -> str:
    """A text that can be written as UTF-8. Raises ArgumentError."""
    if isinstance(value, str):
        try:
            value.encode()
            return value
        except UnicodeEncodeError:
            pass
    raise _refused(value, name, "a text")


def wished_text(value: Any, name: str) -> Optional[str]:
    """A text, or None. Raises ArgumentError."""
    return None if value is None else text(value, name)


def flag(value: Any, name: str) -> bool:
    """True or False. Raises ArgumentError."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise _refused(value, name, "True or False")


def path(value: Any, name: str) -> str:
    """A file's or folder's name. Raises ArgumentError."""
    try:
        return text(os.fsdecode(value), name)
    except TypeError:
        raise _refused(value, name, "a path") from None


def function(value: Any, name: str) -> Any:
    """What can be called, or None. Raises ArgumentError."""
    if value is None or callable(value):
        return value
    raise _refused(value, name, "a function, or None")


def _refused(value: Any, name: str, kind: str) -> ArgumentError:
    """Long values, such as arrays, are named by their type."""
    shown = ascii(value)
    if len(shown) > 60 or "\n" in shown:
        shown = f"a {type(value).__name__}"
    return ArgumentError(f"{name} is {shown}; it is {kind}")


def is_sequence(stack: Any) -> bool:
    """Whether pictures can be counted and asked for one by one."""
    return hasattr(stack, "__len__") and hasattr(stack, "__getitem__") and not hasattr(stack, "keys")


def is_path(stack: Any) -> bool:
    """Whether it names pictures, or a rig, and holds none."""
    return isinstance(stack, (str, os.PathLike))
