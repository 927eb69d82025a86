# SPDX-License-Identifier: Apache-2.0
"""What a lens does, in numbers: where the image is, how far it is sharp.

Distances are from a thin lens, mm. Every function raises ValueError for what no lens has, and for what is no
number. An object may be at infinity (`math.inf`). The formulas are in docs/optics.md.
"""

# Bodies are the library's: the functions here say names, types and words.
# mypy: disable-error-code="empty-body"

from __future__ import annotations

import functools
import inspect
from typing import Any, Callable, Tuple, TypeVar, cast

from ._errors import ArgumentError
from ._fathom import optics as _optics
from ._given import number as _number

__all__ = [
    "airy_radius_um", "cutoff_cycles_per_mm", "defocused_otf", "depth_of_field", "depth_of_focus_mm",
    "diffraction_mtf", "disc_of_confusion_mm", "extension_mm", "hyperfocal_mm", "image_distance_mm",
    "magnification", "object_at_extension_mm", "object_distance_mm", "working_f_number",
]


_Function = TypeVar("_Function", bound=Callable[..., Any])

_NUMBERS = {
    "focal_mm": "Focal length, mm.",
    "object_mm": "Distance of the object from the lens, mm.",
    "image_mm": "Distance of the image from the lens, mm.",
    "sensor_mm": "Distance of the sensor from the lens, mm.",
    "extension_mm": "How much farther than for infinity the lens stands from the sensor, mm.",
    "f_number": "Of the lens focused on infinity.",
    "circle_mm": "Largest disc that still looks sharp, mm across.",
    "aperture_mm": "Diameter of the lens's opening, mm.",
    "wavelength_nm": "Of the light, nm.",
    "working_f_number": "f-number of the light that meets the sensor.",
    "cutoff_part": "Spatial frequency over that from which on no contrast is left.",
    "waves": "Path difference between the rim and the middle of the pupil, wavelengths.",
}


def _of_numbers(function: _Function) -> _Function:
    """The function of the same name of the library, of numbers; a refusal shows all of them."""
    signature = inspect.signature(function)
    computed = getattr(_optics, function.__name__)

    @functools.wraps(function)
    def checked(*positional: Any, **named: Any) -> Any:
        given = signature.bind(*positional, **named).arguments
        numbers = {name: _number(value, name) for name, value in given.items()}
        try:
            return computed(**numbers)
        except ArgumentError as refusal:
            shown = ", ".join(f"{name} = {value:g}" for name, value in numbers.items())
            raise ArgumentError(f"{shown}: {refusal}", refusal.code) from None

    checked.__doc__ = _described(function, signature)
    return cast(_Function, checked)


def _described(function: Callable[..., Any], signature: inspect.Signature) -> str:
    """The docstring with numpydoc's sections, which are alike for all."""
    lines = [str(function.__doc__), "", "Parameters", "----------"]
    for name in signature.parameters:
        lines += [f"{name} : float", f"    {_NUMBERS[name]}"]
    kind = "float" if signature.return_annotation == "float" else "tuple of float"
    lines += ["", "Returns", "-------", kind, "    As said above.", "", "Raises", "------", "ValueError",
              "    For what no lens has, and for what is no number."]
    return "\n".join(lines) + "\n"


@_of_numbers
def image_distance_mm(focal_mm: float, object_mm: float) -> float:
    """Where an object comes to focus, mm: f X/(X - f)."""


@_of_numbers
def object_distance_mm(focal_mm: float, image_mm: float) -> float:
    """The object in focus on a sensor at this distance, mm; infinite at the focal length."""


@_of_numbers
def extension_mm(focal_mm: float, object_mm: float) -> float:
    """How much farther than for infinity the lens stands from the sensor, mm: f^2/(X - f)."""


@_of_numbers
def object_at_extension_mm(focal_mm: float, extension_mm: float) -> float:
    """The object that a lens so far out is focused on, mm; infinite at 0."""


@_of_numbers
def magnification(focal_mm: float, object_mm: float) -> float:
    """Size on the sensor over size of the object: f/(X - f)."""


@_of_numbers
def working_f_number(focal_mm: float, f_number: float, object_mm: float) -> float:
    """f-number of the light that meets the sensor: N (1 + magnification)."""


@_of_numbers
def depth_of_field(focal_mm: float, f_number: float, circle_mm: float, object_mm: float) -> Tuple[float, float]:
    """Nearest and farthest distance, mm, at which an object looks sharp (eq. 3-3)."""


@_of_numbers
def hyperfocal_mm(focal_mm: float, f_number: float, circle_mm: float) -> float:
    """From here on the far limit is infinite, mm: f^2/(C N)."""


@_of_numbers
def depth_of_focus_mm(focal_mm: float, f_number: float, circle_mm: float, object_mm: float) -> float:
    """How far the sensor may be moved, between both ends, mm."""


@_of_numbers
def disc_of_confusion_mm(focal_mm: float, f_number: float, image_mm: float, sensor_mm: float) -> float:
    """Diameter of the disc that a point becomes beside its image, mm."""


@_of_numbers
def airy_radius_um(focal_mm: float, aperture_mm: float, wavelength_nm: float) -> float:
    """Radius of the Airy disc, um: 1.22 lambda f/d."""


@_of_numbers
def cutoff_cycles_per_mm(working_f_number: float, wavelength_nm: float) -> float:
    """Frequency on the sensor from which on no contrast is left, cycles/mm."""


@_of_numbers
def diffraction_mtf(cutoff_part: float) -> float:
    """MTF of a perfect lens in focus, 0 to 1, at a part of the cutoff."""


@_of_numbers
def defocused_otf(cutoff_part: float, waves: float) -> float:
    """Transfer function of a perfect lens out of focus by so many waves (Hopkins 1955)."""
