# SPDX-License-Identifier: Apache-2.0
"""fathom.screen and fathom.dask on a scheduler and three worker processes, some of which are killed."""

import contextlib
import os
import signal

import fathom
import numpy as np
import pytest
from pictures import noise, stack

distributed = pytest.importorskip("distributed")
tifffile = pytest.importorskip("tifffile")
from cluster import Cluster  # noqa: E402

METRIC, FIELDS = "walsh-sequency:32", 24


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    one = Cluster(tmp_path_factory.mktemp("cluster"))
    yield one
    one.stop()


@pytest.fixture(scope="module")
def client(cluster):
    with distributed.Client(cluster.address, timeout="120s", set_as_default=False) as one:
        one.wait_for_workers(3)
        yield one


@pytest.fixture(scope="module")
def uris(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plate")
    pixels = [stack(planes=9, focus=2 + i, side=64, seed=i) for i in range(5)]
    for i in range(FIELDS):
        tifffile.imwrite(folder / f"{i:02}.tif", np.roll(pixels[i % 5], i, axis=2))
    (folder / "07.tif").write_bytes(b"no picture")
    return [folder / f"{i:02}.tif" for i in range(FIELDS)]


@pytest.fixture(scope="module")
def alone(uris, tmp_path_factory):
    return fathom.screen(uris, METRIC, out=tmp_path_factory.mktemp("alone") / "table.csv")


class Blow:
    """Strikes once for each threshold, as soon as so many sources are done."""

    def __init__(self, **strikes):
        self._strikes, self.seen = [(int(at[1:]), strike) for at, strike in strikes.items()], []

    def __call__(self, done, total):
        self.seen.append(done)
        while self._strikes and self._strikes[0][0] <= done < total:
            self._strikes.pop(0)[1]()


def assert_all_once(seen):
    assert seen == sorted(seen) and seen[0] == 0 and seen[-1] == FIELDS


def test_a_killed_worker_loses_nothing_and_counts_nothing_twice(client, uris, alone, tmp_path):
    victim, pid = next(iter(client.run(os.getpid).items()))
    busy = []

    def kill():
        busy.extend(client.processing()[victim])
        os.kill(pid, signal.SIGKILL)

    # A worker that is stopped ends no task, so it dies with some under way.
    blow = Blow(_3=lambda: os.kill(pid, signal.SIGSTOP), _9=kill)
    rows = fathom.screen(uris, METRIC, out=tmp_path / "table.csv", client=client, at_once=1, progress=blow)
    assert busy and rows == alone
    assert_all_once(blow.seen)
    assert (tmp_path / "table.csv").read_bytes().count(b"\n") == FIELDS + 1


def test_sizes_of_tasks_change_no_value(client, uris, alone, tmp_path):
    assert fathom.screen(uris, METRIC, out=tmp_path / "a.csv", client=client) == alone
    assert fathom.screen(uris, METRIC, out=tmp_path / "b.csv", client=client, at_once=10) == alone


def test_dask_arrays_are_computed_by_the_workers(client, tmp_path):
    da, xarray = pytest.importorskip("dask.array"), pytest.importorskip("xarray")
    import fathom.dask

    pixels = noise((3, 150, 170), np.uint16)
    lazy = fathom.dask.score(da.from_array(pixels, (1, 64, 64)), "fft:32:hann", stride=11)
    whole = fathom.score(pixels, "fft:32:hann", stride=11, backend="cpu")
    np.testing.assert_array_equal(client.compute(lazy).result(), whole)
    stacks = np.stack([stack(planes=9, focus=3, side=64)] * 3)
    named = xarray.DataArray(da.from_array(stacks, (1, 3, 64, 64)), dims=("well", "z", "y", "x"))
    rows = fathom.screen(named, METRIC, out=tmp_path / "table.csv", client=client)
    alone = fathom.focus(stacks[0], metric=METRIC, backend="cpu")
    assert [row.position for row in rows] == [alone.position] * 3


def test_a_scheduler_that_is_restarted_costs_only_what_was_under_way(cluster, client, uris, alone, tmp_path):
    blow = Blow(_3=cluster.restart)
    rows = fathom.screen(uris, METRIC, out=tmp_path / "table.csv", client=client, at_once=1, progress=blow)
    assert rows == alone
    assert_all_once(blow.seen)


def test_a_scheduler_that_is_gone_is_said_and_the_next_call_goes_on(cluster, client, uris, alone, tmp_path):
    def stop():
        cluster.stop()
        with contextlib.suppress(TimeoutError):  # a client need not end in time, only know
            client.close(timeout=10)

    blow = Blow(_3=stop)
    with pytest.raises(fathom.Error, match="lost its scheduler") as gone:
        fathom.screen(uris, METRIC, out=tmp_path / "table.csv", client=client, at_once=1, progress=blow)
    assert gone.value.code == "unavailable" and not (tmp_path / "table.csv").exists()
    seen = []
    rows = fathom.screen(uris, METRIC, out=tmp_path / "table.csv", progress=lambda done, _: seen.append(done))
    assert rows == alone and seen[0] >= 2
