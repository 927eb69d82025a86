#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program as typed, on a real driver: it finds the focus that the simulated camera was built
with, and leaves the camera as it found it, also after Ctrl-C.

  usb_devices --camera --best 640 -- focus_test.py FATHOM USB_COMMAND 640
"""
import fcntl
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time

VIDIOC_S_CTRL = 0xC008561C
FOCUS_ABSOLUTE, FOCUS_AUTO = 0x009A090A, 0x009A090C
AUTOMATICS = ("focus_auto", "exposure_auto", "white_balance_auto")


def status(usb_command):
    """What the simulated camera tells of itself."""
    text = subprocess.run([usb_command, "status"], check=True, capture_output=True, text=True).stdout
    return dict(pair.split("=") for pair in text.split() if "=" in pair)


def automatics(usb_command):
    now = status(usb_command)
    return [now[name] for name in AUTOMATICS]


def set_control(device, control, value):
    """As another program would."""
    descriptor = os.open(device, os.O_RDWR)
    fcntl.ioctl(descriptor, VIDIOC_S_CTRL, struct.pack("Ii", control, value))
    os.close(descriptor)


def expect(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def wait_for(condition, what):
    for _ in range(200):
        if condition():
            return
        time.sleep(0.05)
    sys.exit(f"FAILED: no {what} within 10 s")


def find_focus(fathom, rig, best):
    done = subprocess.run([fathom, "focus", "--rig", rig, "--json"], capture_output=True, text=True)
    expect(done.returncode == 0,
           f"focus: exit status {done.returncode}: {done.stdout} {done.stderr}")
    answer = json.loads(done.stdout.splitlines()[-1])
    print(answer)
    off = abs(answer["position"] - best)
    expect(off <= 3 * max(answer["sigma"], 1), f"focused at {answer['position']}, built at {best}")


def interrupt(fathom, rig, usb_command, wish):
    program = subprocess.Popen([fathom, "focus", "--rig", rig], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    wait_for(lambda: automatics(usb_command) == ["0", "0", "0"], "measurement")
    time.sleep(1)
    expect(program.poll() is None, "it ended before it was interrupted")
    program.send_signal(wish)
    said = program.communicate(timeout=20)[1].decode()
    expect(program.returncode not in (0, -wish), f"{wish.name}: status {program.returncode}: {said}")
    print(f"{wish.name}: exit status {program.returncode}")


def interrupt_away_from_its_place(fathom, rig, usb_command, device, wish):
    """The lens goes back; only one without its autofocus, which moves it, can show that."""
    set_control(device, FOCUS_AUTO, 0)
    set_control(device, FOCUS_ABSOLUTE, 123)
    wait_for(lambda: float(status(usb_command)["lens"]) == 123, "lens at 123")
    program = subprocess.Popen([fathom, "focus", "--rig", rig], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    wait_for(lambda: abs(float(status(usb_command)["lens"]) - 123) > 100, "lens on its way")
    expect(program.poll() is None, "it ended before it was interrupted")
    program.send_signal(wish)
    said = program.communicate(timeout=20)[1].decode()
    now = status(usb_command)
    expect(now["focus"] == "123", f"{wish.name}: the lens was left at {now['focus']}: {said}")
    expect(now["focus_auto"] == "0", f"{wish.name}: the autofocus was off, and is on now")
    set_control(device, FOCUS_AUTO, 1)


def main():
    fathom, usb_command, best = sys.argv[1], sys.argv[2], float(sys.argv[3])
    device = os.environ.get("FATHOM_VIDEO")
    if not device:
        print("== NOT RUN: no simulated USB camera (FATHOM_VIDEO is not set)")
        sys.exit(1 if os.environ.get("FATHOM_REQUIRE_HARDWARE") == "1" else 77)
    rig = f"v4l2:device={device},settle_ms=60,speed=3000,coarse=50"
    with tempfile.TemporaryDirectory() as home:
        os.environ["XDG_STATE_HOME"] = home
        listed = subprocess.run([fathom, "rigs", "list"], check=True, capture_output=True, text=True)
        expect("Simulated focus camera" in listed.stdout, f"rigs list: {listed.stdout}")
        before = automatics(usb_command)
        expect(before == ["1", "1", "1"], f"automatics at first: {before}")
        find_focus(fathom, rig, best)
        expect(automatics(usb_command) == before, "automatics stayed off after focus")
        for wish in (signal.SIGINT, signal.SIGTERM):
            interrupt(fathom, rig, usb_command, wish)
            expect(automatics(usb_command) == before, f"automatics stayed off after {wish.name}")
            interrupt_away_from_its_place(fathom, rig, usb_command, device, wish)
    print("PASSED")


main()
