# SPDX-License-Identifier: Apache-2.0
"""What there is to screen: the stacks of TIFFs, OME-Zarr images, folders and arrays, read when asked for."""

from __future__ import annotations

import contextlib
import functools
import glob
import hashlib
import logging
import math
import os
import re
import threading
import warnings
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ._errors import ArgumentError, FileError, PictureWarning
from ._given import path as path_of
from ._named import arranged, axis_of, is_named
from ._types import Array, Numbers


class Reading(NamedTuple):
    """A stack as it could be read.

    pixels: (pictures, rows, columns). planes: the number of each in the file, where some are missing. said: what the
    reader found amiss.
    """

    pixels: Array
    planes: Optional[List[int]] = None
    said: Tuple[str, ...] = ()


class Field(NamedTuple):
    """One stack. `read` gives its pictures."""

    name: str
    read: Callable[[], Reading]
    spacing_um: Optional[float] = None
    positions: Optional[Numbers] = None
    unit: Optional[str] = None

    def places(self, count: int) -> Tuple[Array, str]:
        """Positions of its pictures, and their unit."""
        if self.positions is not None:
            return np.asarray(self.positions, dtype=float), self.unit or "frames"
        if self.spacing_um is None:
            return np.arange(count, dtype=float), "frames"
        return self.spacing_um * np.arange(count), "um"


_MICROMETRES = {
    "um": 1, "micron": 1, "microns": 1, "micrometer": 1, "micrometers": 1, "micrometre": 1, "\\u00B5m": 1,
    "\u00b5m": 1, "\u03bcm": 1, "nm": 1e-3, "nanometer": 1e-3, "mm": 1e3, "millimeter": 1e3, "cm": 1e4, "m": 1e6,
}


def micrometres(length: Any, unit: Any) -> Optional[float]:
    """A spacing in um, or None where it says nothing."""
    try:
        value = float(length) * _MICROMETRES.get(str(unit), 0)
    except (TypeError, ValueError):
        return None
    return value if value > 0 and math.isfinite(value) else None


def stacks_of(axes: str, shape: Sequence[int]) -> Iterator[Tuple[str, Tuple[Any, ...]]]:
    """The stacks of an array: the name of each, and its index. axes: a letter for each, 'tczyx'."""
    if not axes.endswith("yx") or len(set(axes)) != len(axes):
        raise ArgumentError(f"its axes are {axes.upper()}; a field has grey pictures, rows and columns last")
    others = [axis for axis in axes if axis not in "zyx"]
    for place in np.ndindex(*[shape[axes.index(axis)] for axis in others]):
        at = dict(zip(others, place))
        yield ",".join(f"{axis}={i}" for axis, i in at.items()), tuple(at.get(axis, slice(None)) for axis in axes)


def _joined(*names: str) -> str:
    return ",".join(name for name in names if name)


# TIFF ----------------------------------------------------------------------------------------------

def _tiff(path: str) -> Iterator[Field]:
    import tifffile

    with tifffile.TiffFile(path) as tiff:
        if not tiff.series:
            raise ArgumentError("it has no pictures")
        if _are_pages(tiff):
            yield Field("", lambda: _whole([series.asarray for series in tiff.series]))
            return
        for number, series in enumerate(tiff.series):
            name = f"series={number}" if len(tiff.series) > 1 else ""
            axes = _with_z(series.axes.lower())
            plane = _planes(tiff, series)
            numbers = np.arange(math.prod(series.shape[:-2])).reshape(series.shape[:-2])
            for place, index in stacks_of(axes, series.shape):
                mine = np.atleast_1d(numbers[index[:-2]]).tolist()
                yield Field(_joined(name, place), functools.partial(_whole, [functools.partial(plane, k) for k in mine]),
                            _tiff_spacing(tiff, number))


def _whole(planes: List[Callable[[], Array]]) -> Reading:
    """The planes that can be read, as the program plays them: a copy that was cut off still has some."""
    found: List[Tuple[int, Array]] = []
    problems: List[str] = []
    for k, read in enumerate(planes):
        try:
            found.append((k, read()))
        except Exception as problem:  # whatever a decoder raises
            problems.append(f"plane {k} cannot be read: {problem}")
    if not found:
        raise FileError(problems[0] if problems else "it has no pictures", "bad_data")
    pixels = np.stack([picture for _, picture in found])
    if not problems:
        return Reading(pixels)
    more = f", and {len(problems) - 1} more" if len(problems) > 1 else ""
    return Reading(pixels, [k for k, _ in found],
                   (f"{problems[0]}{more}; {len(found)} of {len(planes)} planes are measured",))


def _are_pages(tiff: Any) -> bool:
    """Whether pictures that were written one by one are those of a stack: alike, and nobody says otherwise."""
    if tiff.is_ome or tiff.is_imagej or len(tiff.series) < 2:
        return False
    first = tiff.series[0]
    return all(one.axes == "YX" and one.shape == first.shape and one.dtype == first.dtype for one in tiff.series)


def _with_z(axes: str) -> str:
    """Pages that nobody has named, i, q or r, are the pictures of a stack."""
    unnamed = [axis for axis in axes if axis in "iqr"]
    return axes.replace(unnamed[0], "z") if "z" not in axes and len(unnamed) == 1 else axes


def _planes(tiff: Any, series: Any) -> Callable[[int], Array]:
    """Reads one plane by its number; of plain pixels, without reading the others."""
    if series.dataoffset is not None:
        dtype = np.dtype(tiff.byteorder + series.dtype.char)
        mapped = np.memmap(tiff.filehandle.path, dtype, "r", series.dataoffset, tuple(series.shape))
        planes = mapped.reshape((-1,) + mapped.shape[-2:])
        return lambda k: np.asarray(planes[k].astype(dtype.newbyteorder("=")))
    if len(series.pages) != math.prod(series.shape[:-2]):
        raise ArgumentError(f"it has {len(series.pages)} pages, and not one for each plane of {series.shape}")

    def read(k: int) -> Array:
        if series.pages[k] is None:
            raise FileError("it is not there", "bad_data")
        return np.asarray(series.pages[k].asarray())

    return read


def _tiff_spacing(tiff: Any, number: int) -> Optional[float]:
    if tiff.is_ome:
        import xml.etree.ElementTree as xml

        pixels = xml.fromstring(tiff.ome_metadata).findall("{*}Image/{*}Pixels")
        about = pixels[number].attrib if number < len(pixels) else {}
        return micrometres(about.get("PhysicalSizeZ"), about.get("PhysicalSizeZUnit", "\u00b5m"))
    about = tiff.imagej_metadata or {}
    return micrometres(about.get("spacing"), about.get("unit"))


# OME-Zarr ------------------------------------------------------------------------------------------

def _open_zarr(uri: str) -> Any:
    import zarr

    return zarr.open(uri, mode="r")


def _zarr(uri: str) -> Iterator[Field]:
    node, axes, spacing = _open_zarr(uri), None, None
    if "multiscales" in node.attrs:
        scales = node.attrs["multiscales"][0]
        first = scales["datasets"][0]
        node = node[first["path"]]
        axes = [axis if isinstance(axis, dict) else {"name": axis} for axis in scales.get("axes", [])]
        spacing = _zarr_spacing(axes, first)
    if not hasattr(node, "chunks"):
        raise ArgumentError("it is a Zarr group without multiscales; name the array in it")
    letters = "".join(axis["name"] for axis in axes) if axes else "tczyx"[-node.ndim:]
    for place, index in stacks_of(letters, node.shape):
        yield Field(place, functools.partial(_read_zarr, node, index), spacing)


def _read_zarr(node: Any, index: Tuple[Any, ...]) -> Reading:
    return Reading(np.asarray(node[index]))


def _zarr_spacing(axes: List[Any], dataset: Any) -> Optional[float]:
    for change in dataset.get("coordinateTransformations", []):
        for axis, scale in zip(axes, change.get("scale", [])):
            if axis["name"] == "z":
                return micrometres(scale, axis.get("unit", ""))
    return None


def images_of(uri: str) -> List[str]:
    """The images of a plate of OME-Zarr; else the uri itself."""
    if not is_zarr(uri):
        return [uri]
    attributes = _open_zarr(uri).attrs
    if "plate" not in attributes:
        return [uri]
    found = []
    for well in attributes["plate"]["wells"]:
        place = f"{uri.rstrip('/')}/{well['path']}"
        found += [f"{place}/{image['path']}" for image in _open_zarr(place).attrs["well"]["images"]]
    return found


def is_zarr(uri: str) -> bool:
    """Whether a folder, or an address on the net, holds Zarr of version 2."""
    return "://" in uri or any(os.path.exists(os.path.join(uri, mark)) for mark in (".zattrs", ".zgroup", ".zarray"))


# Arrays --------------------------------------------------------------------------------------------

class Block:
    """A stack of an xarray.DataArray: goes to a worker, and is computed there."""

    def __init__(self, name: str, data: Any, positions: Optional[Array], unit: Optional[str]):
        self.name, self.data, self.positions, self.unit = name, data, positions, unit

    def fields(self) -> Iterator[Field]:
        """Its one field."""
        yield Field(self.name, self.read, None, self.positions, self.unit)

    def read(self) -> Reading:
        """Computes it in this thread: the scheduler's other workers have tasks of their own."""
        if not hasattr(self.data, "compute"):
            return Reading(np.asarray(self.data))
        return Reading(np.asarray(self.data.compute(scheduler="synchronous")))


def blocks_of(array: Any) -> List[Tuple[str, Block]]:
    """Every stack of a DataArray (..., pictures, rows, columns), with a key for what it holds."""
    array = arranged(array, 3, "uris")
    if array.ndim < 3:
        raise ArgumentError(f"uris has the dimensions {array.dims}; a field has pictures, rows and columns")
    token = _token(array.data)
    lead = array.dims[:-3]
    found = []
    for place in np.ndindex(*array.shape[:-3]):
        part = array[place]
        values = [array.coords[d].values[i] if d in array.coords else i for d, i in zip(lead, place)]
        name = ",".join(f"{d}={value}" for d, value in zip(lead, values))
        positions, unit = axis_of(part)
        about = repr((name, None if positions is None else np.asarray(positions).tolist(), unit))
        key = f"{token}{list(place)} {hashlib.sha256(about.encode()).hexdigest()}"
        found.append((key, Block(name, part.data, positions, unit)))
    return found


def _token(data: Any) -> str:
    name = getattr(data, "name", None)  # of Dask: the same for the same graph
    if name is not None:
        return str(name)
    pixels = np.ascontiguousarray(data)
    return hashlib.sha256(f"{pixels.dtype.str}{pixels.shape}".encode() + pixels.tobytes()).hexdigest()


# All of them ---------------------------------------------------------------------------------------

def is_tiff(uri: str) -> bool:
    """By its name."""
    return uri.lower().endswith((".tif", ".tiff", ".btf", ".lsm"))


@contextlib.contextmanager
def heard(said: List[str]) -> Iterator[None]:
    """Collects what tifffile logs in this thread meanwhile, once each, instead of printing it."""
    log, thread = logging.getLogger("tifffile"), threading.get_ident()
    ear = _Ear(said)
    ear.addFilter(lambda record: record.thread == thread)
    log.addHandler(ear)
    try:
        yield
    finally:
        log.removeHandler(ear)


class _Ear(logging.Handler):
    def __init__(self, said: List[str]):
        super().__init__(logging.WARNING)
        self._said = said

    def emit(self, record: logging.LogRecord) -> None:
        self._said.append(_words(record))


def _words(record: logging.LogRecord) -> str:
    """Without the name of the object that speaks: "<tifffile.TiffPages @8> invalid page offset 138592"."""
    return " ".join(re.sub(r"<tifffile\.[^>]*> *", "", record.getMessage()).split())


def fields_of(source: Any) -> Iterator[Field]:
    """The stacks of a Block, a TIFF or an OME-Zarr image. Raises Error, OSError, or what the reader raises."""
    if isinstance(source, Block):
        yield from source.fields()
    elif is_zarr(source):
        yield from _zarr(source)
    else:
        yield from _tiff(source)


def sources_of(uris: Any) -> List[Tuple[str, Any]]:
    """Key and source of all that is to be screened, each once; plates as their images.

    The key of a file holds its size and the time of its last change, and that of a folder those of all its
    files, so another picture is another key.
    """
    if is_named(uris):
        return blocks_of(uris)
    listed = [uris] if isinstance(uris, (str, os.PathLike)) else uris
    try:
        paths = [path_of(one, f"uris[{i}]") for i, one in enumerate(listed)]
    except TypeError:
        raise ArgumentError(f"uris is {type(uris).__name__}; it is names of files and folders, or a DataArray "
                            "(an array of numpy: fathom.focus)") from None
    found: Dict[str, str] = {}
    names_of: Dict[Any, str] = {}
    for name in paths:
        names = sorted(glob.glob(name)) if glob.has_magic(name) and not os.path.exists(name) else [name]
        if not names:
            raise FileError(f"uris: nothing matches {name}", "io")
        for uri in names:
            for image in images_of(uri):
                if not _is_twice(image, names_of):
                    found.setdefault(_key(image), image)
    return list(found.items())


def _is_twice(uri: str, names_of: Dict[Any, str]) -> bool:
    """Whether it is there under another name already, which is said."""
    try:
        state = os.stat(uri)
    except OSError:
        return False  # a text with options, an address, or nothing: its own name is all there is
    first = names_of.setdefault((state.st_dev, state.st_ino), uri)
    if first == uri:
        return False
    warnings.warn(f"{uri} is {first} under another name; it is measured once, as {first}", PictureWarning,
                  stacklevel=4)
    return True


def is_played(uri: str) -> bool:
    """Whether it is a folder of pictures, which the program's replay reads: neither TIFF nor Zarr."""
    return not is_zarr(uri) and not is_tiff(uri)


def _key(uri: str) -> str:
    path = uri.partition("replay:")[2].partition(",")[0] if uri.startswith("replay:") else uri
    try:
        states = _states(path)
    except OSError:
        return uri
    return f"{uri} {hashlib.sha256(repr(states).encode()).hexdigest()}"


def _states(path: str) -> List[Tuple[str, int, int]]:
    """Name, size and last change of a file, or of all that a folder holds: its own tell nothing of them."""
    if not os.path.isdir(path):
        state = os.stat(path)
        return [("", state.st_size, state.st_mtime_ns)]
    found = []
    for folder, folders, names in os.walk(path):
        folders.sort()
        for name in sorted(names):
            state = os.stat(os.path.join(folder, name))
            found.append((os.path.relpath(os.path.join(folder, name), path), state.st_size, state.st_mtime_ns))
    return found
