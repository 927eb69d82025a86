#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how far away something is, with a webcam whose focus is motorised.

    range_from_a_webcam.py [RIG [CALIBRATION [TIMES]]]

RIG: v4l2:/dev/video0, or a file such as examples/rigs/webcam.toml; a simulated lens without it.
CALIBRATION: a file; if it is not there, a target is put at known distances, and the file is made.
"""

import pathlib
import sys

import fathom

SIMULATED = "sim:target=seedling,distance=1800"
DISTANCES_MM = [1500, 1700, 1900, 2100, 2300]


def place(rig, distance_mm):
    """Puts the target there: by itself, or by you."""
    if rig.target_mm is not None:
        rig.place_target(distance_mm)
    else:
        input(f"put the target at {distance_mm} mm, then press Enter ")


def calibrate(rig):
    """A focus at each known distance, and a curve through them."""
    foci = []
    for distance_mm in DISTANCES_MM:
        place(rig, distance_mm)
        foci.append(rig.focus(stay=False))
        print(f"{distance_mm} mm: {foci[-1]}")
    found = [(focus, mm) for focus, mm in zip(foci, DISTANCES_MM) if focus]
    return fathom.Calibration.fit(*zip(*found), **rig.conditions)


def main(text=SIMULATED, file="webcam_calibration.json", times=3):
    file = pathlib.Path(file)
    with fathom.open_rig(text) as rig:
        print(rig)
        if not file.exists():
            calibrate(rig).save(file)
        calibration = fathom.Calibration.load(file)
        print(calibration.equation)
        for _ in range(int(times)):  # Ctrl-C ends it, and the lens goes back
            answer = rig.range(calibration)
            print(answer)
            for warning in answer.warnings:
                print(f"  {warning}")


if __name__ == "__main__":
    main(*sys.argv[1:])
