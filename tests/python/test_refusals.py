# SPDX-License-Identifier: Apache-2.0
"""Every public function, given what it cannot use: the refusal names the argument, in Python's words."""

import inspect
import shutil

import fathom
import numpy as np
import pytest
from pictures import noise, stack

PICTURE, STACK = noise((96, 96)), stack(planes=9, focus=4.2)
POINTS = dict(positions=[100, 200, 300, 400], distances_mm=[400, 200, 133.3, 100])
ODD = [None, "x", b"5", 2.5, -1, 10**30, float("nan"), [], {}, [1, None], object(), True, "\ud800", np.zeros((2, 2)), 1j]

#: What no user of Python should read.
FOREIGN = ["incompatible", "Unable to cast", "C++", "fathom::", "--", "_core", "NoneType' object", "ambiguous", "blur_px",
           "std::", "arg0", "expected str, bytes"]


class Device:
    position = 0.0

    def snap(self):
        return PICTURE

    def move_to(self, position):
        self.position = position


def closed(function):
    """The same function, whose result is closed at once."""
    def call(**arguments):
        with function(**arguments):
            pass
    return call


def of_plan(**arguments):
    with fathom.Plan("fft:64", 2, backend="cpu") as plan:
        return plan.score(**arguments)


def of_ticket(ticket):
    with fathom.Plan("fft:64", backend="cpu") as plan:
        return plan.wait(ticket)


def calibration():
    return fathom.Calibration.fit(**POINTS, model="inverse")


def of_screen(out="table.csv", **arguments):
    shutil.rmtree("table.csv.parts", ignore_errors=True)
    return fathom.screen(out=out, **arguments)


def on_rig(name):
    def call(**arguments):
        with fathom.open_rig("sim:target=seedling,distance=1800") as rig:
            return getattr(rig, name)(**arguments)
    return call


# name: function, arguments that do, and the arguments to try.
FUNCTIONS = {
    "score": (fathom.score, dict(image=PICTURE), "image metric windows stride backend threads"),
    "spectrum": (fathom.spectrum, dict(image=PICTURE), "image metric window backend threads"),
    "Plan": (closed(fathom.Plan), dict(metric="fft:64"), "metric capacity backend threads"),
    "Plan.score": (of_plan, dict(image=PICTURE), "image windows out"),
    "Plan.wait": (of_ticket, {}, "ticket"),
    "focus": (fathom.focus, dict(stack=STACK),
              "positions metric window unit backend threads from_ to search peak tolerance frames blur"),
    "fit": (fathom.fit, dict(positions=[1, 2, 3], scores=[1, 3, 2]), "positions scores scatter"),
    "depth": (fathom.depth, dict(stack=STACK), "positions calibration window stride align fill unit backend threads"),
    "Calibration.fit": (fathom.Calibration.fit, POINTS, "positions distances_mm model sigmas rig metric unit window"),
    "Calibration.load": (fathom.Calibration.load, {}, "path"),
    "distance": (lambda **a: calibration().distance(**{"position": 200, **a}), {}, "position sigma extrapolate"),
    "distance_mm": (lambda **a: calibration().distance_mm(**a), {}, "position"),
    "interval": (lambda **a: calibration().interval(**{"position": 200, **a}), {}, "position coverage"),
    "position_for": (lambda **a: calibration().position_for(**a), {}, "distance_mm"),
    "covers": (lambda **a: calibration().covers(**a), {}, "position"),
    "open_rig": (closed(fathom.open_rig), dict(text="sim:"), "metric window average backend threads"),
    "rig": (closed(fathom.rig), dict(camera=Device(), lowest=0, highest=3),
            "camera stage lowest highest resolution unit position coarse_spacing blur exposure_ms stale_frames description"),
    "Rig.focus": (on_rig("focus"), dict(from_=700, to=710),
                  "stay observer frames_too from_ to search peak tolerance frames start blur moving"),
    "Rig.sweep": (on_rig("sweep"), dict(from_=700, to=702), "from_ to step observer frames_too"),
    "Rig.range": (on_rig("range"), dict(calibration=calibration(), from_=700, to=702), "calibration repeat extrapolate"),
    "Rig.capture": (on_rig("capture"), {}, "position"),
    "Rig.move_to": (on_rig("move_to"), {}, "position"),
    "Rig.place_target": (on_rig("place_target"), {}, "distance_mm"),
    "screen": (of_screen, dict(uris=[]), "uris metric windows out client positions unit backend threads at_once "
               "progress search peak frames tolerance blur from_ to"),
}
OPTICS = [name for name in fathom.optics.__all__]


def refusal(function, arguments):
    """The exception, or None where there is none."""
    try:
        function(**arguments)
    except (ValueError, TypeError, fathom.Error) as problem:
        return problem
    return None


def names_it(problem, argument):
    words = str(problem)
    return argument in words and not [word for word in FOREIGN if word in words]


def of_file(problem):
    """A name of a file that is not there, or of a travel or calibration that does not reach there."""
    return isinstance(problem, fathom.FileError) or "outside of the calibration" in str(problem)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_argument_is_named(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function, arguments, tried = FUNCTIONS[name]
    bad = []
    for argument in tried.split():
        for odd in ODD:
            problem = refusal(function, {**arguments, argument: odd})
            if problem is not None and not names_it(problem, argument) and not of_file(problem):
                bad.append(f"{name}({argument}={ascii(odd)[:40]}): {type(problem).__name__}: {problem}")
    assert not bad, "\n".join(bad)


@pytest.mark.parametrize("name", OPTICS)
def test_every_number_of_optics_is_named(name):
    function = getattr(fathom.optics, name)
    names = list(inspect.signature(function).parameters)
    assert function.__doc__ and names
    for argument in names:
        for odd in (None, "x", [1, 2], True):
            problem = refusal(function, {**dict.fromkeys(names, 0.5), argument: odd})
            assert isinstance(problem, ValueError) and names_it(problem, argument), problem
        problem = refusal(function, {one: 0.5 for one in names if one != argument})
        assert isinstance(problem, TypeError) and argument in str(problem)


ACCEPTED_ONCE = [
    (lambda: fathom.depth(STACK, fill="x"), "fill is 'x'; it is True or False"),
    (lambda: fathom.focus(STACK, window=(40, 0)), "window is (40, 0), and 64 x 64 px there cross the edge"),
    (lambda: fathom.focus(STACK, metric="fft:128"), "metric has windows of 128 x 128 px, and a picture has 96 x 96"),
    (lambda: fathom.score(PICTURE, "fft:9"), 'metric "fft:9"'),
    (lambda: fathom.score(PICTURE, "fft:64:band=0.4-0.1"), 'metric "fft:64:band=0.4-0.1"'),
    (lambda: fathom.focus(STACK, search="spectra"), "search is 'spectra'; it is 'auto', "),
    (lambda: fathom.focus(STACK, from_=9), "from_ is 9; positions are from 0 to 8 frames"),
    (lambda: fathom.focus(STACK, from_=3, to=1), "from_ is 3 and to is 1"),
    (lambda: fathom.focus(STACK, blur=-1), "blur is -1; it is above 0"),
    (lambda: fathom.focus(STACK, threads=True), "threads is True; it is an integer"),
    (lambda: on_rig("range")(calibration="lens.json"), "calibration is a str; it is a fathom.Calibration"),
    (lambda: on_rig("range")(calibration=5), "calibration is a int; it is a fathom.Calibration"),
    (lambda: on_rig("sweep")(step=0), "step is 0; it is above 0"),
    (lambda: on_rig("move_to")(position=1e9), "position is 1000000000; positions are from 0 to 1200 steps"),
    (lambda: fathom.open_rig("sim:", window=(9999, 0)), "window is (9999, 0), and 64 x 64 px there cross the edge"),
    (lambda: fathom.optics.airy_radius_um(-1, 2, 3), "focal_mm = -1, "),
    (lambda: fathom.micro_manager(5, lowest=1, highest=2), "core (int) has no snapImage()"),
]


@pytest.mark.parametrize("call,words", ACCEPTED_ONCE, ids=[words for _, words in ACCEPTED_ONCE])
def test_says_what_is_allowed(call, words):
    with pytest.raises(ValueError) as refused:
        call()
    assert words in str(refused.value)


def test_a_closed_rig_can_be_shown():
    rig = fathom.open_rig("sim:")
    rig.close()
    assert repr(rig) == "<fathom.Rig, closed>"
