#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From a focal stack to a map of depth and the picture that is sharp everywhere.

    stack_to_depth.py [STACK [FOLDER]]

STACK: a folder of pictures or a TIFF; a simulated slope is taken without it.
FOLDER: where the maps go; depth/ without it. Open its view.html.
"""

# %% A stack: here of a simulated lens. Yours may be an array of any origin, such as tifffile.imread(path).
import sys

import fathom
import numpy as np

if len(sys.argv) > 1:
    maps = fathom.depth(sys.argv[1])
else:
    with fathom.open_rig("sim:target=slant,distance=1800") as rig:
        positions = rig.focus().peak.position + 12 * np.arange(-15, 16)
        stack, unit = rig.capture(positions), rig.unit
    # %% The map. Positions are those where the pictures were taken.
    maps = fathom.depth(stack, positions, unit=unit)

# %% What it is, in a line and in numbers. In a notebook, `maps` alone shows it.
print(maps)
for warning in maps.warnings:
    print(warning)
known = maps.where("known")
if known.any():
    rows, columns = np.nonzero(known)
    nearest = np.nanargmin(maps.depth[known])
    print(f"the least depth is at row {rows[nearest]}, column {columns[nearest]}: "
          f"{maps.depth[known][nearest]:.5g} +- {maps.sigma[known][nearest]:.2g} {maps.unit}")

# %% Every pixel of the sharp picture comes from about here:
print(f"pictures {np.unique(maps.index)} of the stack are the sharpest somewhere")

# %% Files: TIFFs of numbers, PNGs to look at, a page that turns the surface.
folder = sys.argv[2] if len(sys.argv) > 2 else "depth"
print(", ".join(maps.save(folder, ply=True)), "in", folder)
