# SPDX-License-Identifier: Apache-2.0
"""Pictures for tests, the same every time."""

import numpy as np


def noise(shape, dtype=np.uint8, seed=1):
    """Random pixels over the whole range of the type."""
    return np.random.default_rng(seed).integers(0, np.iinfo(dtype).max + 1, shape, dtype=dtype)


def blurred(sharp, radius):
    """A Gaussian blur of so many pixels, through the Fourier transform; 0: as it is."""
    rows, columns = (np.fft.fftfreq(side) for side in sharp.shape)
    law = np.exp(-2 * (np.pi * radius) ** 2 * (rows[:, None] ** 2 + columns[None, :] ** 2))
    soft = np.fft.ifft2(np.fft.fft2(sharp) * law).real
    return np.clip(np.rint(soft), 0, 255).astype(np.uint8)


def stack(planes=41, focus=18.4, side=96, seed=3):
    """A texture that is sharp at a plane between two others, with a little noise."""
    random = np.random.default_rng(seed)
    sharp = 120 + 60 * random.normal(size=(side, side))
    radii = np.hypot((np.arange(planes) - focus) * 0.25, 1.2)
    pictures = [blurred(sharp, radius) for radius in radii]
    return np.stack([np.clip(p + random.normal(0, 1, p.shape), 0, 255).astype(np.uint8) for p in pictures])


def slope(planes=15, rows=96, columns=128, seed=5):
    """A texture on a slope: column 0 is sharp at plane 3, the last column at the last but three. A corner
    has no texture."""
    random = np.random.default_rng(seed)
    sharp = 120 + 60 * random.normal(size=(rows, columns))
    sharp[: rows // 2, : columns // 2] = 120
    radii = np.linspace(1.2, 6, 25)
    softer = np.stack([blurred(sharp, radius) for radius in radii])
    focus = np.linspace(3, planes - 4, columns)
    pictures = []
    for plane in range(planes):
        radius = np.hypot(0.5 * (plane - focus), 1.2)
        which = np.abs(radii[:, None] - radius).argmin(axis=0)
        picture = softer[which, :, np.arange(columns)].T + random.normal(0, 0.7, sharp.shape)
        pictures.append(np.clip(np.rint(picture), 0, 255).astype(np.uint8))
    return np.stack(pictures), focus


def write_pgm(path, picture):
    rows, columns = picture.shape
    path.write_bytes(b"P5\n%d %d\n255\n" % (columns, rows) + picture.tobytes())


def write_ppm(path, picture):
    rows, columns, _ = picture.shape
    path.write_bytes(b"P6\n%d %d\n255\n" % (columns, rows) + picture.tobytes())
