#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What fathom.screen costs beyond reading and measuring, and the constants of docs/scaling.md.

    PYTHONPATH=build/release/python bench/python/screen.py [FIELDS] [SIDE] [PLANES]

Fields are TIFFs in a temporary folder, read once before, so that no disk is measured. Milliseconds are
those of the processor, which other work on the machine lengthens little; of a few rounds the shortest
counts. What is beyond reading and focusing is counted where it is spent, not a difference of long times.
Fields an hour are by the clock.

A worker spends some of its processor's time in each second, whether it has tasks or not. A field that takes
long, or waits for a busy processor, has more of that. So what a field itself costs is told apart from it.
"""

import pathlib
import sys
import tempfile
import time
import warnings

import dask
import fathom
import numpy as np
import tifffile
from fathom import _work
from fathom._fields import fields_of
from fathom._parts import Parts, Row, write_table

FIELDS, SIDE, PLANES = (int(given) for given in (sys.argv[1:] + ["200", "128", "9"][len(sys.argv) - 1:]))
ROUNDS = 3
IDLE_SECONDS = 3
AT_ONCE = 20  # files a task: what it comes to by itself where fields are many
METRIC = "walsh-sequency:64"


def write_fields(folder):
    """Textures that are sharp in the middle of their stack."""
    random = np.random.default_rng(1)
    fourier = np.fft.fft2(120 + 60 * random.normal(size=(SIDE, SIDE)))
    f = np.fft.fftfreq(SIDE)
    for i in range(FIELDS):
        radii = np.hypot((np.arange(PLANES) - PLANES / 2 - i % 3) * 0.4, 1.2)
        laws = (np.exp(-2 * (np.pi * r) ** 2 * (f[:, None] ** 2 + f**2)) for r in radii)
        planes = [np.fft.ifft2(fourier * law).real + random.normal(0, 1, (SIDE, SIDE)) for law in laws]
        tifffile.imwrite(folder / f"{i:04}.tif", np.clip(planes, 0, 255).astype(np.uint8), photometric="minisblack")
    return sorted(folder.glob("*.tif"))


class Meter:
    """Counts the processor's time that goes into reading and focusing, and into tasks as a whole."""

    @classmethod
    def install(cls):
        """In this process, once. fathom._work calls what it finds under these names, and a worker what it finds as work."""
        if not hasattr(_work, "spent"):
            _work.spent, _work.in_tasks = [0.0], [0.0]
            _work.focus = cls.timed(_work.focus, _work.spent)
            _work.fields_of = cls.fields(_work.fields_of)

    @classmethod
    def install_on_worker(cls):
        cls.install()
        _work.work = cls.timed(_work.work, _work.in_tasks)

    @classmethod
    def timed(cls, work, seconds):
        def call(*given, **named):
            start = time.thread_time()
            try:
                return work(*given, **named)
            finally:
                seconds[0] += time.thread_time() - start
        return call

    @classmethod
    def fields(cls, fields_of):
        def call(source):
            steps = fields_of(source)
            while (field := cls.timed(next, _work.spent)(steps, None)) is not None:
                yield field._replace(read=cls.timed(field.read, _work.spent))
        return call


def seconds_so_far():
    """Of this process: all, in tasks, and of these reading and focusing."""
    return np.array([time.process_time(), _work.in_tasks[0], _work.spent[0]])


def read(uris):
    return [field.read().pixels for uri in uris for field in fields_of(str(uri))]


def least(rounds):
    """The least of each column."""
    return [min(column) for column in zip(*rounds)]


def shortest(work, clock=time.process_time):
    """Seconds of the fastest round; work is given the round's number."""
    times = []
    for i in range(ROUNDS):
        start = clock()
        work(i)
        times.append(clock() - start)
    return min(times)


def report_alone(uris, folder):
    """Milliseconds of a field: reading, measuring, and what screen adds."""
    stacks = read(uris)
    reading = shortest(lambda _: read(uris))
    measuring = shortest(lambda _: [fathom.focus(s, None, METRIC, backend="cpu", threads=1) for s in stacks])

    Meter.install()

    def screen(i):
        start, before = time.perf_counter(), seconds_so_far()
        fathom.screen(uris, METRIC, out=folder / f"alone{i}.csv", threads=1)
        whole, _, spent = seconds_so_far() - before
        return time.perf_counter() - start, whole - spent

    wall, other = least(screen(i) for i in range(ROUNDS))
    per = 1e3 / len(uris)
    print(f"a field of {PLANES} x {SIDE} x {SIDE} px: {per * reading:.2f} ms to read, {per * measuring:.2f} ms to focus")
    print(f"one process: {3600 * len(uris) / wall:.0f} fields an hour, {per * other:.2f} ms a field beyond both")


def report_cluster(uris, folder, workers):
    """The processor's time of workers beyond reading and focusing, and of this process with the scheduler in it."""
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        def now():
            """By the clock, here, and on workers: all, in tasks, and of these reading and focusing."""
            return np.array([time.perf_counter(), time.process_time(), *sum(client.run(seconds_so_far).values())])

        def screen(i):
            before = now()
            fathom.screen(uris, METRIC, out=folder / f"cluster{workers}-{i}.csv", client=client, at_once=AT_ONCE)
            return now() - before

        client.run(Meter.install_on_worker)
        screen("first")  # workers import what they need
        before = now()
        time.sleep(IDLE_SECONDS)
        seconds, *idle, _, _ = now() - before
        tell_cluster(least(screen(i) for i in range(ROUNDS)), np.array(idle) / seconds, workers, 1e3 / len(uris))
        if workers == 1:
            report_scheduler(client)


def tell_cluster(seconds, idle, workers, per):
    """idle: what this process and the workers take in each second without tasks. per: milliseconds a field."""
    wall, here, there, in_tasks, spent = seconds
    beside, own = there - in_tasks, in_tasks - spent
    by_fields = own + max(beside - wall * idle[1], 0) + max(here - wall * idle[0], 0)
    print(f"{workers} worker{'s' * (workers > 1)}: {3600e3 / (per * wall):.0f} fields an hour. A field beyond both: {per * own:.2f} ms in its "
          f"task, {per * beside:.2f} ms of Dask beside it, {per * here:.2f} ms here with the scheduler")
    print(f"  Dask without tasks: {1e3 * idle[1] / workers:.0f} ms in each second of a worker, {1e3 * idle[0]:.0f} ms here; "
          f"a field has {per * by_fields:.2f} ms more than that")


def report_scheduler(client):
    """The processor's time of this process, with the scheduler in it, for one empty task of 50 names."""
    count, names = 300, ["plates/7/field_0001.ome.tif"] * 50

    def submit(i):
        futures = [client.submit(lambda names, k: k, names, i * count + k) for k in range(count)]
        [future.result() for future in futures]

    print(f"scheduler and client: {1e3 * shortest(submit) / count:.2f} ms a task")


def report_table(folder):
    """Seconds of what grows with the number of fields, in the one process that writes the table."""
    count, at_once = 100_000, 50
    row = Row("plate/field.tif", "t=0,c=0", 96, 96, 64, 7, 7.123456789, 0.0123456, "um", 0.987654, "focused",
              "the peak stands 400 times the noise above the floor", "")
    parts = Parts(folder / "table.csv", {})
    chunks = [{f"field {i + k}": [row] for k in range(at_once)} for i in range(0, count, at_once)]
    writing = shortest(lambda _: [parts.write(chunk) for chunk in chunks])
    reading = shortest(lambda _: parts.read())
    merging = shortest(lambda _: write_table(folder / "table.csv", [row] * count))
    print(f"table of {count} rows: {1e3 * writing / len(chunks):.2f} ms a part of {at_once} to keep, "
          f"{reading:.2f} s to go on from, {merging:.2f} s to write")


def main():
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for part in ("plate", "on", "of"):
            (folder / part).mkdir()
        uris = write_fields(folder / "plate")
        report_alone(uris, folder)
        report_table(folder)
        for has_profiler, words in ((True, "on, as it is by itself"), (False, "off, as docs/scaling.md has it")):
            dask.config.set({"distributed.worker.profile.enabled": has_profiler})
            print(f"Dask's profiler {words}:")
            for workers in (1, 2):
                report_cluster(uris, folder / words[:2], workers)


if __name__ == "__main__":
    main()
