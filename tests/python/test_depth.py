# SPDX-License-Identifier: Apache-2.0
"""fathom.depth: the program's maps, whatever form a stack has."""

import _thread
import json
import os
import pickle
import signal
import subprocess
import sys
import threading

import fathom
import numpy as np
import pytest
from locks import looks_while
from pictures import noise, slope, write_pgm, write_ppm

STACK, FOCUS = slope()
COLOURS = np.stack([STACK, STACK // 5 * 4, STACK // 5 * 2], axis=-1)
SAME = ["depth.tif", "sigma.tif", "confidence.tif", "index.tif", "sharp.png", "depth.png", "hill.png", "class.png",
        "depth.ply", "view.html"]
ARRAYS = ["depth", "sigma", "confidence", "index", "classes", "sharp"]


def assert_same(ours, theirs, names=ARRAYS):
    for name in names:
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)


@pytest.fixture(scope="module")
def maps():
    return fathom.depth(STACK)


def test_knows_the_slope(maps):
    known = maps.where("known")
    assert known.mean() > 0.5 and maps.unit == maps.lens_unit == "frames"
    np.testing.assert_array_equal(np.isnan(maps.depth), ~known)
    off = (maps.depth - FOCUS)[known]
    assert np.abs(np.median(off)) < 0.3 and np.abs(off).mean() < 0.6
    assert maps.depth.shape == maps.sharp.shape == STACK.shape[1:]
    assert sum(maps.values["summary"]["parts"].values()) == pytest.approx(1)
    with pytest.raises(ValueError, match="no-texture"):
        maps.where("sharp")


def test_a_calibration_tells_how_the_picture_grows_as_it_tells_the_program(tmp_path):
    places = np.arange(0, 12.0)
    calibration = fathom.Calibration.fit(places, 1000 / (1 + 0.02 * places), unit="frames", model="thin-lens")
    calibration.save(tmp_path / "calibration.json")
    (tmp_path / "stack").mkdir()
    for i, picture in enumerate(STACK):
        write_pgm(tmp_path / "stack" / f"plane_{i:03}.pnm", picture)
    subprocess.run([os.environ["FATHOM_PROGRAM"], "depth", "--rig", f"replay:{tmp_path}/stack", "-o",
                    tmp_path / "theirs", "--align", "scale", "--calibration", tmp_path / "calibration.json"],
                   check=True, capture_output=True)
    theirs = json.loads((tmp_path / "theirs" / "report.json").read_text())["alignment"]
    assert theirs["by"] == "law" and theirs["told_growth_per_unit"] != 0
    for stack in (STACK, tmp_path / "stack"):
        growth = fathom.depth(stack, align="scale", calibration=calibration).values["facts"]["growth"]
        assert growth == {"told": theirs["told_growth_per_unit"], "fitted": theirs["growth_per_unit"]}
    assert fathom.depth(STACK, calibration=calibration).values["facts"]["growth"] is None


@pytest.mark.parametrize("form", ["grey", "colours"])
def test_is_that_of_the_program_to_the_last_bit(form, tmp_path):
    pictures, write = (STACK, write_pgm) if form == "grey" else (COLOURS, write_ppm)
    for i, picture in enumerate(pictures):
        (tmp_path / "stack").mkdir(exist_ok=True)
        write(tmp_path / "stack" / f"plane_{i:03}.pnm", picture)
    options = ["--stride", "4", "--align", "scale", "--fill", "--ply"]
    subprocess.run([os.environ["FATHOM_PROGRAM"], "depth", "--rig", f"replay:{tmp_path}/stack", "-o",
                    tmp_path / "theirs", *options], check=True, capture_output=True)
    wishes = {"stride": 4, "align": "scale", "fill": True}
    of_array, of_folder = fathom.depth(pictures, **wishes), fathom.depth(tmp_path / "stack", **wishes)
    assert_same(of_array, of_folder)
    assert of_array.where("filled").any()
    files = of_folder.save(tmp_path / "ours", ply=True)
    assert sorted(files) == sorted(os.listdir(tmp_path / "ours")) == sorted(os.listdir(tmp_path / "theirs"))
    for name in SAME:
        assert (tmp_path / "ours" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes(), name
    reports = [json.loads((tmp_path / who / "report.json").read_text()) for who in ("ours", "theirs")]
    for report in reports:
        for name in ("made", "seconds", "memory_mb"):
            report.pop(name)
    assert reports[0] == reports[1]
    of_array.save(tmp_path / "again", ply=True)
    for name in SAME[:-1]:
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes(), name


def test_every_form_of_a_stack_gives_the_same(maps):
    xarray = pytest.importorskip("xarray")
    z = np.arange(len(STACK), dtype=float)
    named = xarray.DataArray(STACK, dims=("z", "y", "x"), coords={"z": ("z", z, {"units": "frames"})})
    buffer = np.empty_like(STACK[0])

    def one_by_one():
        for picture in STACK:
            buffer[:] = picture
            yield buffer

    backward = fathom.depth(STACK[::-1], z[::-1])
    for form in (fathom.depth(list(STACK)), fathom.depth(named), fathom.depth(one_by_one(), z)):
        assert_same(form, maps)
    assert_same(backward, maps, ["depth", "sigma", "confidence", "classes", "sharp"])
    np.testing.assert_array_equal(backward.index, len(STACK) - 1 - maps.index)
    np.testing.assert_array_equal(backward.positions[backward.index], maps.positions[maps.index])
    far = fathom.depth(named.assign_coords(z=("z", 3 * z, {"units": "um"})))
    assert far.unit == "um" and np.nanmedian(far.depth) == pytest.approx(3 * np.nanmedian(maps.depth), rel=0.05)


@pytest.mark.parametrize("name,dtype,copied", [("big-endian", ">u2", True), ("uint16", np.uint16, False)])
def test_wide_pixels(name, dtype, copied, recwarn):
    pictures = (STACK.astype(np.uint16) * 200).astype(dtype)
    ours = fathom.depth(pictures)
    assert any(w.category is fathom.CopyWarning for w in recwarn) == copied
    assert ours.sharp.dtype == np.uint16 and ours.sharp.dtype.isnative
    assert_same(ours, fathom.depth(pictures.astype(np.uint16)))


def test_pictures_of_one_position_are_averaged(tmp_path):
    twice, positions = np.repeat(STACK, 2, axis=0), np.repeat(np.arange(len(STACK)), 2)
    twice[1::2] ^= 1
    lines = ["file,position"]
    for i, picture in enumerate(twice):
        write_pgm(tmp_path / f"{i:03}.pgm", picture)
        lines.append(f"{i:03}.pgm,{positions[i]}")
    (tmp_path / "manifest.csv").write_text("\n".join(lines) + "\n")
    theirs, ours = fathom.depth(f"replay:{tmp_path}"), fathom.depth(twice, positions)
    assert_same(ours, theirs, ["depth", "sigma", "confidence", "classes", "sharp"])
    np.testing.assert_array_equal(ours.index, 2 * theirs.index)
    assert "averaged" in " ".join(theirs.warnings)
    ours.save(tmp_path / "a")
    theirs.save(tmp_path / "b")
    assert (tmp_path / "a" / "index.tif").read_bytes() == (tmp_path / "b" / "index.tif").read_bytes()


def test_a_calibration_makes_it_metric(maps, tmp_path):
    places = np.arange(0, 15, 2.0)
    calibration = fathom.Calibration.fit(places, 1000 / (1 + 0.02 * places), unit="frames")
    calibration.save(tmp_path / "calibration.json")
    ours = fathom.depth(STACK, calibration=calibration)
    known = ours.where("known")
    assert ours.unit == "mm" and ours.lens_unit == "frames"
    middle = np.unravel_index(np.nanargmin(np.abs(maps.depth - 7)), maps.depth.shape)
    assert ours.depth[middle] == pytest.approx(calibration.distance_mm(float(maps.depth[middle])), rel=1e-4)
    assert known.any() and np.isfinite(ours.sigma[known]).all()
    assert_same(ours, fathom.depth(STACK, calibration=tmp_path / "calibration.json"))
    with pytest.raises(ValueError, match="calibration has positions in frames, this stack in um"):
        fathom.depth(STACK, calibration=calibration, unit="um")


def test_is_shown_kept_and_changed(maps, tmp_path):
    assert "data:image/png;base64," in maps._repr_html_() and "known" in str(maps)
    pytest.importorskip("matplotlib")
    assert maps.plot() is not None
    copy = pickle.loads(pickle.dumps(maps))
    assert_same(copy, maps)
    maps.save(tmp_path / "a")
    copy.save(tmp_path / "b")
    assert (tmp_path / "a" / "view.html").read_bytes() == (tmp_path / "b" / "view.html").read_bytes()
    copy.depth[:] += 1
    copy.save(tmp_path / "b")
    assert (tmp_path / "a" / "depth.tif").read_bytes() != (tmp_path / "b" / "depth.tif").read_bytes()
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="is no folder"):
        maps.save(tmp_path / "file")
    copy.classes[0, 0] = 77
    with pytest.raises(ValueError, match="classes holds 77"):
        copy.save(tmp_path / "b")


def test_nothing_known_is_an_answer(tmp_path):
    black = fathom.depth(np.zeros((5, 64, 64), np.uint8))
    assert np.isnan(black.depth).all() and black.where("no-texture").mean() > 0.5
    assert "known 0.0 %" in str(black) and "<img" in black._repr_html_()
    black.save(tmp_path / "black")


REFUSED = [
    (dict(stack=STACK[:2]), "3 different positions"),
    (dict(positions=[1, 2]), "positions holds 2 of them, and stack 15"),
    (dict(positions=[np.nan] * 15), "positions[0] is no finite"),
    (dict(window=12), "windows of 12 px"),
    (dict(window="large"), "window is 'large'"),
    (dict(window=256), "no room"),
    (dict(stride=0), "stride is 0"),
    (dict(threads=0), "threads is 0"),
    (dict(align="turn"), "align is 'turn'"),
    (dict(stack=STACK[0]), "stack has shape (96, 128)"),
    (dict(stack=np.zeros(())), "stack has shape ()"),
    (dict(stack=STACK[:0]), "stack holds no picture"),
    (dict(stack=STACK[:, :0]), "stack has shape (0, 128): no pixel"),
    (dict(stack=STACK.astype(np.float32)), "stack has dtype float32"),
    (dict(stack=COLOURS.astype(np.float32)), "stack has dtype float32"),
    (dict(stack=list(STACK.astype(np.float32))), "stack[0] has dtype float32"),
    (dict(stack={0: STACK[0]}), "stack is a dict"),
    (dict(positions="abc"), "positions is 'abc'"),
    (dict(positions=[None] * 15), "positions[0] is None"),
    (dict(stride=1.5), "stride is 1.5; it is an integer"),
    (dict(align=None), "align is None; it is a text"),
    (dict(backend=3), "backend is 3; it is a text"),
    (dict(stack=np.ma.masked_equal(STACK, 0)), "stack is a masked array"),
    (dict(stack=[*STACK[:4], STACK[4, :64]]), "stack[4] is 128 x 64 px, 8 bit, and stack[0] 128 x 96 px"),
    (dict(stack=[*STACK[:4], COLOURS[4]]), "stack[4] is 128 x 96 px, 8 bit colours"),
    (dict(stack=iter(STACK)), "give positions"),
    (dict(stack=iter(STACK[:9]), positions=range(15)), "stack ended after 9 pictures"),
    (dict(stack=iter(STACK), positions=range(9)), "one more picture than"),
    (dict(stack=7), "stack is a int"),
    (dict(stack=None), "stack is a NoneType"),
    (dict(stack="sim:"), "capture some"),
    (dict(stack="nowhere", positions=[1, 2, 3]), "manifest.csv"),
    (dict(stack="magic:"), "magic"),
]


@pytest.mark.parametrize("arguments,words", REFUSED, ids=[words for _, words in REFUSED])
def test_is_refused_by_the_name_of_the_argument(arguments, words):
    with pytest.raises(ValueError) as refused:
        fathom.depth(**{"stack": STACK, **arguments})
    assert words in str(refused.value)
    assert "--" not in str(refused.value)


def test_what_is_not_there_is_an_os_error(tmp_path):
    for arguments in (dict(stack="nowhere"), dict(stack=tmp_path / "nowhere"), dict(stack="replay:nowhere"),
                      dict(stack=STACK, calibration="nowhere.json")):
        with pytest.raises(OSError, match="nowhere"):
            fathom.depth(**arguments)


def test_ctrl_c_ends_it(tmp_path):
    def interrupted():
        yield from STACK[:5]
        signal.raise_signal(signal.SIGINT)
        yield from STACK[5:]

    with pytest.raises(KeyboardInterrupt):
        fathom.depth(interrupted(), range(15))


def test_ctrl_c_ends_the_reading_of_a_folder(tmp_path):
    for i, picture in enumerate(STACK):
        write_pgm(tmp_path / f"{i:03}.pgm", picture)
    go = threading.Event()

    def interrupt():
        go.wait()
        _thread.interrupt_main()

    before = sys.getswitchinterval()
    sys.setswitchinterval(100)  # the thread has its turn when C++ reads, and not before
    thread = threading.Thread(target=interrupt)
    try:
        thread.start()
        go.set()
        with pytest.raises(KeyboardInterrupt):
            fathom.depth(tmp_path)
    finally:
        sys.setswitchinterval(before)
        thread.join()


def test_the_lock_is_released():
    pictures = noise((4, 700, 700))
    assert looks_while(lambda: fathom.depth(pictures, threads=1)) > 3
