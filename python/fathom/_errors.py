# SPDX-License-Identifier: Apache-2.0
"""What goes wrong, as exceptions and warnings."""

import warnings
from typing import Any, Dict, Iterable


class Error(Exception):
    """Whatever the library refuses or cannot do.

    Attributes
    ----------
    code : str
        'bad_argument', 'out_of_bounds', 'bad_data', 'io', 'unavailable', 'unsupported',
        'device_lost', 'out_of_memory', 'timeout' or 'cancelled'.
    """

    code: str

    def __init__(self, message: str, code: str = "bad_argument"):
        super().__init__(message)
        self.code = code

    def __reduce__(self) -> Any:
        return type(self), (str(self), self.code)


class ArgumentError(Error, ValueError):
    """An argument that has no meaning, or lies outside of a picture, a travel or a calibration."""


class FileError(Error, OSError):
    """The operating system refuses to read or write. Its `errno` is not known."""


class CopyWarning(UserWarning):
    """An array is copied before it is used, because its pixels do not lie side by side in a row."""


class PictureWarning(UserWarning):
    """Files have not all that they should have: pictures that are missing or damaged, or are there twice."""


_AMISS = {"damaged-pages", "damaged-description", "missing-numbers", "names-twice", "skipped-files", "unnamed-pictures"}


def amiss(warning: Dict[str, Any]) -> bool:
    """Whether a warning of a run is of files that are not as they should be."""
    return warning["kind"] in _AMISS or warning.get("missing", 0) > 0


def warn_of(warnings_of_run: Iterable[Dict[str, Any]], stacklevel: int = 3) -> None:
    """Warns of what a reader found amiss. The rest is told by the result alone."""
    for one in warnings_of_run:
        if amiss(one):
            warnings.warn(one["text"], PictureWarning, stacklevel=stacklevel)


_CLASSES = {"bad_argument": ArgumentError, "out_of_bounds": ArgumentError, "io": FileError}


def error_of(code: str, message: str) -> Error:
    """The exception for an error of the library. Called from C++."""
    return _CLASSES.get(code, Error)(message, code)
