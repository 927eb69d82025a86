# SPDX-License-Identifier: Apache-2.0
"""The foci of many stacks, on many machines."""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import Any, Callable, Dict, List, Optional, Union

import numpy as np

from . import _fathom
from ._errors import ArgumentError, PictureWarning
from ._fields import is_played, sources_of
from ._given import count as count_of, function, number, numbers, path as path_of, wished_text
from ._parts import Done, Parts, Row, require_format, write_table
from ._stack import focus
from ._tasks import outcomes_of
from ._types import Corners, Numbers
from ._work import Settings

_WISHES = {"from_", "to", "search", "peak", "tolerance", "frames", "blur"}


def screen(
    uris: Any,
    metric: Optional[str] = None,
    windows: Corners = None,
    out: Union[str, "os.PathLike[str]"] = "table.csv",
    client: Any = None,
    *,
    positions: Optional[Numbers] = None,
    unit: Optional[str] = None,
    backend: Optional[str] = "cpu",
    threads: Optional[int] = None,
    at_once: Optional[int] = None,
    progress: Optional[Callable[[int, int], None]] = None,
    **wishes: Any,
) -> List[Row]:
    """The focus of every field of a plate or an archive, as a table.

    What is done is kept beside the table, in the folder OUT.parts, while the screening runs. The same call
    goes on from there, after a crash, a stop, or with more uris. It may be removed once all is done.

    Parameters
    ----------
    uris : str, path, sequence of them, or xarray.DataArray
        TIFF, OME-TIFF and ImageJ files; OME-Zarr (version 2) images, plates and arrays; folders that
        `fathom focus --rig replay:` plays, or such a text with its options. Patterns such as
        'plate/*.ome.tif' are expanded. A DataArray is (..., pictures, rows, columns), of numpy or of Dask.
        Each series, time and channel of a file is a field. Workers open the files by the same names.
    metric : str, optional
        Of one number a window; walsh-sequency:64 without it.
    windows : (x, y) or sequence of them, optional
        Left column and top row, px. Each is focused by itself. The middle without it.
    out : str or path
        The table: .csv or .parquet.
    client : dask.distributed.Client, optional
        Of a LocalCluster, a Slurm cluster, or any other. This process alone without it. Only this
        process writes the table and its parts.
    positions, unit : optional
        Of the pictures of every stack; not for folders, whose manifest.csv says them. Without them, the um that the file or the coordinate says, else
        0, 1, 2, ... 'frames'.
    backend, threads : optional
        As in `fathom.focus`. A task of a client takes one thread unless you say more.
    at_once : int, optional
        Sources in one task. Without it, what takes about a second.
    progress : callable(done, total), optional
        Called as sources are done.
    **wishes
        from_, to, search, peak, tolerance, frames, blur: as in `fathom.focus`.

    Returns
    -------
    list of Row
        A named tuple for each window of each field, in the order of uris: uri, field, x, y, n, plane,
        position, sigma, unit, confidence, verdict, reason, warnings. The values are those of `fathom.focus` to the
        last bit, however many workers there are. A field that cannot be read has the verdict 'error';
        it is tried again by the next call. Of a file that is damaged the planes that can be read are measured;
        warnings says so, and a PictureWarning. A file that is there under two names is measured once, which
        another PictureWarning says.

    Raises
    ------
    ValueError
        For arguments that have no meaning, or an `out` whose parts are of other settings.
    fathom.Error
        'unavailable' where the scheduler is gone for good. What was done is kept.
    """
    table = pathlib.Path(path_of(out, "out"))
    require_format(table)
    settings = _settings(metric, windows, positions, unit, backend, threads, client, wishes)
    if at_once is not None:
        count_of(at_once, "at_once")
    if client is not None and not (hasattr(client, "submit") and hasattr(client, "scheduler_info")):
        raise ArgumentError(f"client is a {type(client).__name__}; it is a dask.distributed.Client")
    function(progress, "progress")
    sources = sources_of(uris)
    played = [source for _, source in sources if isinstance(source, str) and is_played(source)]
    if played and (positions is not None or unit is not None):
        raise ArgumentError(f"positions and unit are not for {played[0]}: a folder says them in its manifest.csv")
    kept = settings._replace(threads=None)._asdict()  # threads change no value
    parts = Parts(table, {**kept, "version": _fathom.version})
    done = parts.read()
    failed: Done = {}
    pending = [source for source in sources if source[0] not in done]
    count = len(sources) - len(pending)
    tell = progress or (lambda done, total: None)
    tell(count, len(sources))
    for outcome in outcomes_of(pending, settings, client, at_once):
        good = {key: rows for key, rows in outcome.rows.items() if key not in outcome.failed}
        if good:
            parts.write(good)
        done.update(good)
        failed.update({key: outcome.rows[key] for key in outcome.failed})
        for key, said in outcome.said.items():
            uri = outcome.rows[key][0].uri if outcome.rows[key] else "uris"
            warnings.warn(f"{uri}: {'; '.join(said)}", PictureWarning, stacklevel=2)
        count += len(outcome.rows)
        tell(count, len(sources))
    rows = [row for key, _ in sources for row in (done if key in done else failed)[key]]
    write_table(table, rows)
    return rows


def _settings(metric: Optional[str], windows: Any, positions: Any, unit: Optional[str], backend: Optional[str],
              threads: Optional[int], client: Any, wishes: Dict[str, Any]) -> Settings:
    if unknown := wishes.keys() - _WISHES:
        raise TypeError(f"screen() got an unexpected argument {sorted(unknown)[0]!r}")
    wishes = {name: value for name, value in wishes.items() if value is not None}
    share = 1 if threads is None else count_of(threads, "threads")
    has_client = client is not None
    plan = _fathom.Plan(_fathom.search_metric if metric is None else metric, 1, "cpu" if has_client else backend, share)
    if plan.outputs != 1:
        raise ArgumentError(f"metric is {plan.metric}; a focus needs one number a window")
    try_wishes(plan.metric, wishes)
    corners = None
    if windows is not None:
        array = np.asarray(windows)
        if array.size == 0 or array.dtype.kind not in "iu" or array.ndim not in (1, 2) or array.shape[-1] != 2:
            raise ArgumentError("windows is (x, y), or a sequence of them, in whole pixels")
        corners = [(int(x), int(y)) for x, y in array.reshape(-1, 2)]
    return Settings(metric=plan.metric, n=int(plan.metric.split(":")[1]), windows=corners,
                    positions=None if positions is None else numbers(positions, "positions"),
                    unit=wished_text(unit, "unit"),
                    backend=backend, threads=share if has_client else threads, wishes=wishes)


def try_wishes(metric: str, wishes: Dict[str, Any]) -> None:
    """Says of a search that there is not, on a small blank stack, before a million files are opened for it."""
    side = int(metric.split(":")[1])
    told = {name: wishes[name] for name in ("search", "peak", "tolerance", "frames", "blur") if name in wishes}
    for name in ("from_", "to"):
        if wishes.get(name) is not None:
            number(wishes[name], name)
    focus(np.zeros((9, side, side), np.uint8), metric=metric, backend="cpu", **told)
