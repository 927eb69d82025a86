#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scores every window of a picture and prints the sharpest: fathom.h from Python, without any package.

    ctypes_score.py LIBFATHOM.so PICTURE.pgm         8-bit binary PGM without comments
"""

import ctypes
import sys
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p

N = 64


class Window(ctypes.Structure):
    _fields_ = [("x", c_int), ("y", c_int), ("n", c_int)]


def load(path):
    """The library, with the signatures that fathom.h declares."""
    fathom = ctypes.CDLL(path)
    fathom.fathom_open.restype = c_void_p
    fathom.fathom_open.argtypes = [c_char_p, c_char_p, c_size_t]
    fathom.fathom_score.restype = c_int
    fathom.fathom_score.argtypes = [c_void_p, c_char_p, c_int, c_int, c_int, c_size_t,
                                    POINTER(Window), c_size_t, POINTER(c_double)]
    fathom.fathom_error_text.restype = c_char_p
    fathom.fathom_close.argtypes = [c_void_p]
    return fathom


def read_pgm(path):
    with open(path, "rb") as file:
        kind, width, height, deepest, pixels = file.read().split(maxsplit=4)
    if kind != b"P5" or deepest != b"255" or len(pixels) < int(width) * int(height):
        sys.exit(f"ctypes_score: {path} is no 8-bit binary PGM")
    return int(width), int(height), pixels


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    fathom = load(sys.argv[1])
    width, height, pixels = read_pgm(sys.argv[2])

    corners = [(x, y) for y in range(0, height - N + 1, N // 2) for x in range(0, width - N + 1, N // 2)]
    windows = (Window * len(corners))(*((x, y, N) for x, y in corners))
    scores = (c_double * len(corners))()

    plan = fathom.fathom_open(f"walsh-sequency:{N}".encode(), None, len(corners))
    if not plan or fathom.fathom_score(plan, pixels, width, height, 8, 0, windows, len(corners), scores):
        sys.exit("ctypes_score: " + fathom.fathom_error_text().decode())
    fathom.fathom_close(plan)

    best, (x, y) = max(zip(scores, corners))
    print(f"{len(corners)} windows: sharpest at {x},{y},{N}, focus quality {best:.6g}")


if __name__ == "__main__":
    main()
