#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two hundred windows of every frame of a fast camera, the next frame on its way while one is computed.

    many_windows.py [FRAMES]
"""

import sys
import time

import fathom
import numpy as np

FRAMES = int(sys.argv[1]) if len(sys.argv) > 1 else 50


def frames(count):
    """Stands for a camera: the same few buffers again and again."""
    buffers = np.random.default_rng(1).integers(0, 256, (4, 480, 640), dtype=np.uint8)
    for i in range(count):
        yield buffers[i % len(buffers)]


def main():
    corners = np.array([(x, y) for y in range(0, 400, 40) for x in range(0, 560, 28)])
    rooms = [np.empty(len(corners)) for _ in range(2)]  # no array is made on the way
    camera, start = frames(FRAMES), time.perf_counter()
    with fathom.Plan("walsh-sequency:64", len(corners)) as plan:
        before = plan.submit(next(camera), corners, rooms[0])
        for i, frame in enumerate(camera, 1):
            ticket = plan.submit(frame, corners, rooms[i % 2])
            sharpest = corners[plan.wait(before).argmax()]
            before = ticket
        sharpest = corners[plan.wait(before).argmax()]
    rate = FRAMES / (time.perf_counter() - start)
    print(f"{len(corners)} windows, {rate:.0f} frames a second; the last is sharpest at {sharpest}")


if __name__ == "__main__":
    main()
