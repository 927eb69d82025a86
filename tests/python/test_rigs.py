# SPDX-License-Identifier: Apache-2.0
"""Stacks, rigs and calibrations: the program's answers, by Python's own cameras too."""

import json
import os
import pickle
import signal
import subprocess

import fathom
import numpy as np
import pytest
from pictures import stack, write_pgm

PICTURES, FOCUS = stack(), 18.4


def program(*arguments):
    said = subprocess.run([os.environ["FATHOM_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
    return json.loads(said.stdout.splitlines()[-1])


class Device:
    """A camera and a stage in one, of a stack; positions are its planes."""

    def __init__(self):
        self.position, self.moves = 3, []

    def snap(self):
        return PICTURES[int(self.position)]

    def move_to(self, position):
        self.position = position
        self.moves.append(position)


def device_rig(device, **options):
    return fathom.rig(device, lowest=0, highest=40, resolution=1, coarse_spacing=2, unit="planes", **options)


def test_focus_of_a_stack_is_that_of_the_program(tmp_path):
    for i, picture in enumerate(PICTURES):
        write_pgm(tmp_path / f"plane_{i:03}.pgm", picture)
    theirs = program("focus", "--rig", f"replay:{tmp_path}", "--json", "-o", tmp_path / "run.json")
    ours = fathom.focus(PICTURES)
    assert ours and abs(ours.position - FOCUS) < 1
    assert (ours.position, ours.sigma, ours.confidence) == (
        theirs["position"], theirs["sigma"], theirs["confidence"])
    assert "<svg" in ours._repr_html_() and ours.plot() is not None


def test_positions_may_come_in_any_order_and_from_xarray():
    xarray = pytest.importorskip("xarray")
    z = 100.0 - 2 * np.arange(len(PICTURES))
    named = xarray.DataArray(PICTURES, dims=("z", "y", "x"), coords={"z": ("z", z, {"units": "um"})})
    ours = fathom.focus(named)
    assert ours.unit == "um" and abs(ours.position - (100 - 2 * FOCUS)) < 2
    assert ours.position == fathom.focus(PICTURES, z).position


def test_no_focus_is_an_answer():
    ours = fathom.focus(PICTURES[:3].repeat(4, 0) // 255)
    assert not ours and ours.position is None and ours.reason
    for arguments, words in [(dict(positions=[1, 2]), "positions holds 2"), (dict(search="magic"), "magic"),
                             (dict(window=(90, 0)), "edge"), (dict(window=(0.5, 0)), r"window is \(0.5, 0\)"),
                             (dict(window=5), "window is 5; it is a corner"), (dict(from_="a"), "from_ is 'a'"),
                             (dict(search=5), "search is 5"), (dict(positions="abc"), "positions is 'abc'"),
                             (dict(positions=["a"] * 41), r"positions\[0\] is 'a'")]:
        with pytest.raises(ValueError, match=words):
            fathom.focus(PICTURES, **arguments)
    for stack, words in [(iter(PICTURES), "give an array"), (None, "stack is a NoneType"), ("pictures", "open_rig"),
                         (np.uint8(3), "stack is a uint8"), ({1: 2}, "stack is a dict")]:
        with pytest.raises(ValueError, match=words):
            fathom.focus(stack)
    assert "--" not in ours.reason


def test_fit():
    x = np.arange(0.0, 20)
    peak = fathom.fit(x, 1 + 5 * np.exp(-np.log(2) * ((x - 9.3) / 3) ** 2))
    assert peak.shape == "gaussian" and peak.position == pytest.approx(9.3, abs=1e-3)
    with pytest.raises(ValueError, match="positions holds 1 twice"):
        fathom.fit([1, 1, 2], [1, 2, 3])


def test_any_camera_and_stage_are_a_rig():
    device, events = Device(), []
    with device_rig(device) as rig:
        assert repr(rig) == "<fathom.Rig camera of 96 x 96 px; Device>"
        found = rig.focus(observer=events.append, frames_too=True)
        assert found and abs(found.position - FOCUS) < 1 and device.position == round(found.position)
        assert {"began", "frame", "evaluated", "found"} <= {event.name for event in events}
        assert next(e for e in events if e.name == "frame").values["image"].shape == PICTURES.shape[1:]
        curve = rig.sweep(step=4)
        assert len(curve) == 11 and device.position == round(found.position)
        assert rig.capture([2, 5]).shape == (2, *PICTURES.shape[1:])
    with pytest.raises(ValueError, match="closed"):
        rig.focus()


@pytest.mark.parametrize("problem", [RuntimeError("no light"), KeyboardInterrupt()])
def test_what_an_observer_raises_ends_the_run_and_the_lens_goes_back(problem):
    device = Device()

    def observer(event):
        if event.name == "evaluated":
            raise problem

    with device_rig(device) as rig, pytest.raises(type(problem)):
        rig.focus(observer=observer)
    assert len(device.moves) > 1 and device.position == 3


def test_ctrl_c_puts_the_lens_back():
    with fathom.open_rig("sim:target=seedling,distance=1800") as rig:
        rig.move_to(500)

        def observer(event):
            if event.name == "evaluated":
                signal.raise_signal(signal.SIGINT)

        with pytest.raises(KeyboardInterrupt):
            rig.focus(observer=observer)
        assert rig.position == 500
        assert rig.focus(), "the next run knows nothing of it"


def test_events_come_one_by_one_and_leaving_stops():
    device = Device()
    with device_rig(device) as rig:
        events = list(rig.events("focus"))
        assert events[-1].name == "done" and events[-1].values["result"]
        rig.move_to(3)
        for event in rig.events("sweep"):
            if event.name == "evaluated":
                break
        rig.move_to(rig.position)  # the rig is free again
        assert device.position == 3
        with pytest.raises(TypeError, match="focsu"):
            list(rig.events("focus", focsu=1))


class FakeCore:
    """Micro-Manager's face."""

    def __init__(self):
        self.z, self.goal, self.picture = 0.0, 0.0, None

    def getFocusDevice(self):
        return "Z"

    def snapImage(self):
        self.picture = PICTURES[int(round(self.z))]

    def getImage(self):
        return self.picture

    def setPosition(self, label, z):
        assert label == "Z"
        self.goal = z

    def waitForDevice(self, label):
        self.z = self.goal

    def getPosition(self, label):
        return self.z

    def getExposure(self):
        return 10.0


def test_micro_manager():
    core = FakeCore()
    with fathom.micro_manager(core, lowest=0, highest=40, resolution=1, coarse_spacing=2) as rig:
        found = rig.focus()
    assert found.unit == "um" and abs(found.position - FOCUS) < 1 and core.z == round(found.position)


def test_objects_that_are_no_rig_are_refused():
    for arguments, words in [(dict(camera=object()), "no snap"), (dict(camera=Device(), stage=object()), "no move_to"),
                             (dict(camera=Device(), lowest=5), "lowest < highest")]:
        with pytest.raises(ValueError, match=words):
            fathom.rig(**{"lowest": 0, "highest": 1, **arguments})
    bad = Device()
    bad.snap = lambda: np.zeros((64, 64, 3), np.uint8)
    with pytest.raises(ValueError, match="colours"):
        fathom.rig(bad, lowest=0, highest=1)


def test_calibration_and_range(tmp_path):
    with fathom.open_rig("sim:target=seedling,distance=1800") as rig:
        distances, foci = [1500, 1650, 1800, 2000, 2200, 2400], []
        for distance in distances:
            rig.place_target(distance)
            foci.append(rig.focus(stay=False))
        made = fathom.Calibration.fit(foci, distances, **rig.conditions)
        made.save(tmp_path / "calibration.json")
        rig.place_target(1740)
        read = fathom.Calibration.load(tmp_path / "calibration.json")
        assert read.equation == made.equation == pickle.loads(pickle.dumps(made)).equation
        answer = rig.range(read)
        assert abs(answer.distance_mm - 1740) < 5 * answer.sigma_mm < 60 and not answer.warnings
        with pytest.raises(ValueError, match="extrapolate=True"):
            made.distance(rig.travel[1] + 500)
    with pytest.raises(OSError):
        fathom.Calibration.load(tmp_path / "nowhere.json")
    with pytest.raises(fathom.Error) as damaged:
        (tmp_path / "bad.json").write_text("{")
        fathom.Calibration.load(tmp_path / "bad.json")
    assert damaged.value.code == "bad_data"


def test_foci_and_calibrations_of_different_units_are_not_compared():
    made = fathom.Calibration.fit([5, 10, 20, 28], [400, 200, 100, 71], unit="steps")
    in_um, in_steps = (fathom.focus(PICTURES, unit=unit) for unit in ("um", "steps"))
    assert made.distance(in_steps) == made.distance(in_steps.position, in_steps.sigma)
    for call in (lambda: made.distance(in_um), lambda: fathom.Calibration.fit([in_steps, in_um], [400, 200]),
                 lambda: fathom.Calibration.fit([in_um] * 3, [400, 300, 200], unit="steps")):
        with pytest.raises(ValueError, match="in um, and the calibration is in steps"):
            call()


def test_rigs_refuse_by_the_name_of_the_argument():
    for arguments, words in [(dict(text=5), "text is 5"), (dict(metric=None, window=5), "window is 5"),
                             (dict(window=(1, 2, 3)), "window is"), (dict(average="a"), "average is 'a'")]:
        with pytest.raises(ValueError, match=words):
            fathom.open_rig(**{"text": "sim:", **arguments})
    with fathom.open_rig("sim:target=seedling,distance=1800") as rig:
        for measure, words in [(lambda: rig.focus(frames="a"), "frames is 'a'"), (lambda: rig.sweep(step="a"), "step is"),
                               (lambda: rig.move_to("a"), "position is 'a'"), (lambda: rig.capture("a"), "position is"),
                               (lambda: rig.place_target(None), "distance_mm is None")]:
            with pytest.raises(ValueError, match=words):
                measure()


def test_optics():
    assert fathom.optics.image_distance_mm(50, 1000) == pytest.approx(50 * 1000 / 950)
    with pytest.raises(ValueError):
        fathom.optics.hyperfocal_mm(50, 0, 0.03)


def test_a_misspelt_condition_is_no_condition():
    with pytest.raises(TypeError, match="metrc"):
        fathom.Calibration.fit([1, 2, 3, 4], [400, 300, 250, 220], metrc="fft:64")
