# SPDX-License-Identifier: Apache-2.0
"""The C interface from Python: ctypes_test.py LIBFATHOM"""
import ctypes
import sys


class Window(ctypes.Structure):
    _fields_ = [("x", ctypes.c_int), ("y", ctypes.c_int), ("n", ctypes.c_int)]


def main():
    fathom = ctypes.CDLL(sys.argv[1])
    fathom.fathom_open.restype = ctypes.c_void_p
    fathom.fathom_open.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t]
    fathom.fathom_score.argtypes = [
        ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_int,
        ctypes.c_size_t, ctypes.POINTER(Window), ctypes.c_size_t, ctypes.POINTER(ctypes.c_double)]
    fathom.fathom_close.argtypes = [ctypes.c_void_p]
    fathom.fathom_error_text.restype = ctypes.c_char_p

    assert fathom.fathom_open(b"fft:63", None, 1) is None
    assert b"63" in fathom.fathom_error_text()

    plan = fathom.fathom_open(b"walsh-paley:8", b"reference", 2)
    assert plan, fathom.fathom_error_text()
    width, height = 11, 9
    pixels = (ctypes.c_uint8 * (width * height))()
    pixels[4 * width + 6] = 100
    windows = (Window * 2)((0, 0, 8), (3, 1, 8))
    scores = (ctypes.c_double * 2)()
    status = fathom.fathom_score(plan, pixels, width, height, 8, 0, windows, 2, scores)
    assert status == 0, fathom.fathom_error_text()
    # One bright pixel: grey / N^6 * 2 N * SUM i^2.
    assert list(scores) == [100 * 2 * 8 * 140 / 8**6] * 2, list(scores)
    fathom.fathom_close(plan)


main()
