#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a call of fathom.score costs beside the engine's own work, and what it leaves behind.

    PYTHONPATH=build/release/python bench/python/call.py

Of many rounds the shortest counts, so other work on the machine matters little. What the engine takes for a
window is the slope from one window to many; all that one window takes beyond that is the call.
"""

import os
import threading
import time
import tracemalloc

import fathom
import numpy as np

METRIC = "walsh-sequency:64"
MANY = 65


def shortest(work, times, rounds=200):
    """Seconds of a call in the fastest of some rounds of so many calls."""
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(times):
            work()
        best = min(best, time.perf_counter() - start)
    return best / times


def resident_kib():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def report_overhead(picture):
    one, many = [(0, 0)], [(x, 0) for x in range(MANY)]
    arrays = np.array(one), np.array(many)
    with fathom.Plan(METRIC, MANY, backend="cpu", threads=1) as plan:
        engine = (shortest(lambda: plan.score(picture, arrays[1]), 20) - shortest(lambda: plan.score(picture, arrays[0]), 200)
                  ) / (MANY - 1)
        whole = shortest(lambda: fathom.score(picture, METRIC, one, backend="cpu", threads=1), 200)
        streamed = shortest(lambda: plan.score(picture, arrays[0]), 200)
    print(f"one window of {METRIC}: {1e6 * engine:.2f} us in the engine; score takes {1e6 * (whole - engine):.2f} us "
          f"beyond, Plan.score {1e6 * (streamed - engine):.2f} us")


def report_memory(picture):
    def call(times):
        for _ in range(times):
            fathom.score(picture, METRIC, [(0, 0)], backend="cpu", threads=1)

    call(1000)
    before = resident_kib()
    call(100_000)
    print(f"100 000 calls: {resident_kib() - before} KiB more")


def report_views():
    large = np.zeros((6000, 6000), np.uint8)
    view = large[100:-100, 100:-100]
    fathom.score(view, METRIC, (0, 0), backend="cpu")
    tracemalloc.start()
    fathom.score(view, METRIC, (0, 0), backend="cpu")
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(f"a view of {view.nbytes >> 20} MiB: {most / 1024:.1f} KiB of Python's memory at most")


def report_lock(picture):
    """How far Python counts in another thread while a long call runs, over how far it counts alone."""
    def work():
        fathom.score(picture, METRIC, stride=4, backend="cpu", threads=1)

    def counted(is_done):
        count = 0
        while not is_done():
            count += 1
        return count

    start = time.perf_counter()
    work()
    seconds = time.perf_counter() - start
    end = time.perf_counter() + seconds
    alone = counted(lambda: time.perf_counter() >= end)
    thread = threading.Thread(target=work)
    thread.start()
    beside = counted(lambda: time.perf_counter() < 0 or not thread.is_alive())
    print(f"a call of {1e3 * seconds:.0f} ms: beside it Python counts to {beside}, alone to {alone}")


def main():
    picture = np.random.default_rng(1).integers(0, 256, (480, 640), dtype=np.uint8)
    report_overhead(picture)
    report_memory(picture)
    report_views()
    report_lock(np.tile(picture, (4, 4)))


if __name__ == "__main__":
    main()
