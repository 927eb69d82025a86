#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A USB camera whose lens a stepper motor turns, on uvcvideo and cp210x: home, check, focus, lost
steps, a crash in mid-move, a captured travel.

  usb_devices --camera --best 83 --stepper --motor-lens ... -- thesis_rig_test.py FATHOM USB_COMMAND 83 6
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

# Where the motor stands when the lens is at 0: this far above the switch.
HOME_STEPS = 12

RIG = """
[camera]
driver = "v4l2"
device = "{video}"
format = "GREY"

[lens]
driver = "stepper"
port = "gpio"
chip = "{chip}"
step = 0
dir = 1
rate = 200
limit = 200
pulse_us = 1000
setup_us = 1000
hold_us = 1000
lowest = 0
highest = 130
home = 2
home_by = "switch"
home_position = -{home_steps}
home_rate = 200
home_margin = 60
state = "lens.json"
"""


def expect(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


class Bench:
    """The program, the rig file and the devices."""

    def __init__(self, fathom, usb_command, folder):
        self.fathom, self.usb_command = fathom, usb_command
        self.rig = folder / "rig.toml"
        self.folder = folder
        self.write("settle_ms = 100\nbacklash = 10\ncoarse = 16\n")

    def write(self, keys):
        chip = os.environ["FATHOM_GPIOCHIP"]
        self.rig.write_text(RIG.format(video=os.environ["FATHOM_VIDEO"], chip=chip,
                                       home_steps=HOME_STEPS) + keys)

    def run(self, *arguments):
        start = time.monotonic()
        done = subprocess.run([self.fathom, *arguments], capture_output=True, text=True)
        took_s = time.monotonic() - start
        print(f"$ fathom {' '.join(map(str, arguments))}  # {done.returncode}, {took_s:.1f} s\n"
              f"{done.stdout[-600:]}{done.stderr[-600:]}", flush=True)
        return done

    def command(self, *words):
        return subprocess.run([self.usb_command, *words], check=True, capture_output=True,
                              text=True).stdout

    def truth(self, name):
        pairs = dict(p.split("=") for p in self.command("status").split() if "=" in p)
        return int(pairs[name])

    def focus(self, search="coarse"):
        # A search by spectra, once the blur is learned, may end before steps are lost or a signal comes.
        done = self.run("focus", "--rig", self.rig, "--json", "--tolerance", "4", "--search", search)
        expect(done.returncode == 0, "focus")
        self.answer = json.loads(done.stdout.splitlines()[-1])
        return self.answer["position"], self.answer["sigma"]


def near(found, sigma, wanted):
    return abs(found - wanted) <= max(4 * sigma, 1)


def homed(bench):
    refused = bench.run("focus", "--rig", bench.rig)
    expect(refused.returncode == 1 and "rigs home" in refused.stderr, "an unknown place is no place")
    expect(bench.run("rigs", "home", bench.rig).returncode == 0, "home")
    expect(bench.truth("motor") == HOME_STEPS, f"home is motor step {bench.truth('motor')}")


def checked(bench, best, play):
    done = bench.run("rigs", "check", bench.rig, "--json")
    expect(done.returncode == 0, "rigs check")
    found = json.loads(done.stdout.splitlines()[-1])
    expect(near(found["position"], found["sigma"], best), f"check: focus at {found['position']}")
    expect(abs(found["play_left"]) < 1.5, f"{found['play_left']} steps of play left as set")
    expect(abs(found["play"] - play) < 1.5, f"{found['play']} steps of play, made with {play}")
    expect(play - 1 <= found["backlash"] <= play + 4, f"suggests backlash {found['backlash']}")
    expect(0 <= found["settle_ms"] <= 100, f"suggests settle_ms {found['settle_ms']}")
    expect(5 <= found["coarse"] <= 90, f"suggests coarse {found['coarse']}")
    bench.write("".join(f"{key} = {found[key]}\n" for key in ("settle_ms", "backlash", "coarse")))


def focused(bench, best):
    found, sigma = bench.focus()
    expect(near(found, sigma, best), f"focused at {found} +- {sigma}, made at {best}")
    stands = bench.truth("carriage") - HOME_STEPS
    expect(abs(stands - found) <= 1, f"the lens was left at {stands}")
    return found, sigma


def shorter_by_spectra(bench, best):
    """From home, by scores and by the blur that was learned."""
    answers = {}
    for search in ("coarse", "spectral"):
        expect(bench.run("rigs", "home", bench.rig).returncode == 0, "home")
        found, sigma = bench.focus(search)
        expect(near(found, sigma, best), f"{search}: focused at {found} +- {sigma}, made at {best}")
        answers[search] = bench.answer
        print("{:8s} {frames} frames, {travel:g} steps, {rig_seconds:.1f} s".format(search, **bench.answer))
    expect(answers["spectral"]["travel"] < answers["coarse"]["travel"], "less travel by spectra")


def lost_steps_are_found_by_homing(bench, best):
    bench.command("bridge", "lose", "9")
    wrong, _ = bench.focus()
    expect(abs(wrong - best) > 5, f"nine lost steps are not seen from here: {wrong}")
    home = bench.run("rigs", "home", bench.rig)
    expect(home.returncode == 0 and "9 steps" in home.stderr, "lost steps are told")
    after, sigma = bench.focus()
    expect(near(after, sigma, best), f"focused at {after} after homing")


def killed_in_mid_move(bench):
    program = subprocess.Popen([bench.fathom, "focus", "--rig", bench.rig, "--search", "coarse"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    stands = bench.truth("steps")
    while bench.truth("steps") < stands + 20:
        expect(program.poll() is None, "it ended before it was killed")
        time.sleep(0.01)
    program.send_signal(signal.SIGKILL)
    program.wait()
    refused = bench.run("focus", "--rig", bench.rig)
    expect(refused.returncode == 1 and "rigs home" in refused.stderr, "a crash leaves no position")
    expect(bench.run("rigs", "home", bench.rig).returncode == 0, "home after a crash")
    expect(bench.truth("motor") == HOME_STEPS, f"home is motor step {bench.truth('motor')}")


def interrupted_in_mid_move(bench):
    """Ctrl-C: the lens goes back to where it was, and its position is still known."""
    stood = bench.truth("motor")
    program = subprocess.Popen([bench.fathom, "focus", "--rig", bench.rig, "--search", "coarse"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    steps = bench.truth("steps")
    while bench.truth("steps") < steps + 20:
        expect(program.poll() is None, "it ended before it was interrupted")
        time.sleep(0.01)
    program.send_signal(signal.SIGINT)
    said = program.communicate(timeout=30)[1].decode()
    expect(program.returncode == 1 and "stopped" in said, f"Ctrl-C: {program.returncode}: {said}")
    expect(bench.truth("motor") == stood, f"stood at {stood}, now at {bench.truth('motor')}")


def captured(bench, best):
    stack = bench.folder / "stack"
    low, high = str(round(best) - 12), str(round(best) + 12)
    done = bench.run("capture", "--rig", bench.rig, "--from", low, "--to", high, "--step", "3", "-o", stack)
    expect(done.returncode == 0, "capture")
    played = bench.run("focus", "--rig", f"replay:{stack}", "--json")
    expect(played.returncode == 0, "focus of what was captured")
    found = json.loads(played.stdout.splitlines()[-1])
    expect(near(found["position"], found["sigma"], best), f"the captured travel's focus: {found}")


def main():
    fathom, usb_command, best, play = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
    if not os.environ.get("FATHOM_VIDEO") or not os.environ.get("FATHOM_GPIOCHIP"):
        print("== NOT RUN: no simulated USB camera and motor (FATHOM_VIDEO, FATHOM_GPIOCHIP)")
        sys.exit(1 if os.environ.get("FATHOM_REQUIRE_HARDWARE") == "1" else 77)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_STATE_HOME"] = folder
        bench = Bench(fathom, usb_command, pathlib.Path(folder))
        best -= HOME_STEPS
        homed(bench)
        checked(bench, best, play)
        focused(bench, best)
        shorter_by_spectra(bench, best)
        lost_steps_are_found_by_homing(bench, best)
        interrupted_in_mid_move(bench)
        killed_in_mid_move(bench)
        captured(bench, best)
    print("PASSED")


main()
