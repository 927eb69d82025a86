#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A webcam with a motorised focus, on uvcvideo: the first focus learns how the lens blurs, and from
then on a search by spectra gives the same answer from fewer frames, on less of the way.

  usb_devices --camera --best 350 ... -- webcam_test.py FATHOM 350
"""
import fcntl
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

VIDIOC_S_CTRL = 0xC008561C
V4L2_CID_FOCUS_ABSOLUTE = 0x009A090A


def expect(holds, what):
    if not holds:
        print(f"FAILED: {what}", flush=True)
        sys.exit(1)


def put_lens(video, position):
    with open(video, "rb") as device:
        fcntl.ioctl(device, VIDIOC_S_CTRL, struct.pack("Ii", V4L2_CID_FOCUS_ABSOLUTE, position))


def focus(fathom, rig, *options):
    done = subprocess.run([fathom, "focus", "--rig", rig, "--json", *options], capture_output=True, text=True)
    print(f"$ fathom focus {' '.join(options)}  # {done.returncode}\n{done.stderr[-600:]}", flush=True)
    expect(done.returncode == 0, f"focus: {done.stdout[-600:]}")
    return json.loads(done.stdout.splitlines()[-1])


def main():
    fathom, best = sys.argv[1], float(sys.argv[2])
    video = os.environ.get("FATHOM_VIDEO")
    if not video:
        print("== NOT RUN: no simulated USB camera (FATHOM_VIDEO)")
        sys.exit(1 if os.environ.get("FATHOM_REQUIRE_HARDWARE") == "1" else 77)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_STATE_HOME"] = folder
        rig = pathlib.Path(folder) / "webcam.toml"
        rig.write_text(f'driver = "v4l2"\ndevice = "{video}"\nsettle_ms = 300\n')
        focus(fathom, rig)  # learns
        sums = {"coarse": [0, 0, 0], "auto": [0, 0, 0]}
        for start in (150, 640):
            for search, sum_of in sums.items():
                put_lens(video, start)
                found = focus(fathom, rig, "--search", search)
                off = abs(found["position"] - best)
                expect(off < max(4 * found["sigma"], 2), f"{search}: focused at {found['position']}")
                for i, key in enumerate(("frames", "travel", "rig_seconds")):
                    sum_of[i] += found[key]
        for search, (frames, travel, seconds) in sums.items():
            print(f"{search:7s} {frames} frames, {travel:g} units of travel, {seconds:.1f} s, two searches")
        expect(sums["auto"][0] < sums["coarse"][0], "fewer frames by spectra")
        expect(sums["auto"][1] < sums["coarse"][1], "less travel by spectra")
    print("PASSED")


main()
