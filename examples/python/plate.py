#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The focus of every field of a plate, on some processes of this machine, as a table.

    plate.py [FILE...]      TIFF, OME-TIFF or OME-Zarr; a small plate of six wells without them

Stop it and call it again: it goes on from where it was. docs/scaling.md leads to more machines.
"""

import sys

import fathom
import numpy as np
import tifffile

WORKERS = 2


def small_plate():
    """Six wells, each sharp at another plane."""
    random = np.random.default_rng(1)
    fourier = np.fft.fft2(120 + 60 * random.normal(size=(128, 128)))
    f = np.fft.fftfreq(128)
    for well in range(6):
        radii = np.hypot((np.arange(15) - 4 - well) * 0.4, 1.2)
        planes = [np.fft.ifft2(fourier * np.exp(-2 * (np.pi * r) ** 2 * (f[:, None] ** 2 + f**2))).real for r in radii]
        pixels = np.clip(np.rint(planes + random.normal(0, 1, (15, 128, 128))), 0, 255).astype(np.uint8)
        name = f"well_{'ABC'[well // 2]}{well % 2 + 1}.ome.tif"
        tifffile.imwrite(name, pixels, metadata={"axes": "ZYX", "PhysicalSizeZ": 0.5, "PhysicalSizeZUnit": "um"})
        yield name


def main():
    from distributed import Client, LocalCluster

    files = sys.argv[1:] or list(small_plate())
    with LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        rows = fathom.screen(files, out="plate.csv", client=client)
    for row in rows:
        where = f"{row.position:.2f} +- {row.sigma:.2f} {row.unit}" if row.verdict == "focused" else row.reason
        print(f"{row.uri} {row.field}: {row.verdict} {where}")
    print("written: plate.csv")


if __name__ == "__main__":
    main()
