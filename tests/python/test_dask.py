# SPDX-License-Identifier: Apache-2.0
"""fathom.dask: equal to fathom.score and fathom.focus to the last bit, however the array is cut."""

import fathom
import numpy as np
import pytest
from pictures import noise, slope, stack

da = pytest.importorskip("dask.array")
import fathom.dask  # noqa: E402

CHUNKS = [(2, 300, 333), (1, 64, 64), (4, 7, 50), (3, (100, 1, 199), (300, 33)), (2, 13, 333)]
METRICS = ["walsh-sequency:32", "fft:64:hann", "fft:16:power:rings=4", "dct:8"]


@pytest.mark.parametrize("chunks", CHUNKS, ids=str)
@pytest.mark.parametrize("metric", METRICS)
def test_a_grid_is_that_of_the_whole_array(metric, chunks):
    pixels = noise((4, 300, 333), np.uint16)
    for stride in (16, 41, 250):
        ours = fathom.dask.score(da.from_array(pixels, chunks), metric, stride=stride)
        whole = fathom.score(pixels, metric, stride=stride, backend="cpu")
        assert (ours.shape, ours.dtype) == (whole.shape, whole.dtype)
        values = ours.compute(scheduler="synchronous")
        np.testing.assert_array_equal(values, whole)


@pytest.mark.parametrize("chunks", CHUNKS, ids=str)
@pytest.mark.parametrize("windows", [None, (3, 7), [(1, 2)], [(260, 230), (0, 0), (63, 64), (0, 0), (99, 5)]],
                         ids=str)
def test_listed_windows_are_those_of_the_whole_array(windows, chunks):
    pixels = noise((4, 300, 333))
    for metric in ("fft:64:hann", "fft:64:power:rings=3"):
        ours = fathom.dask.score(da.from_array(pixels, chunks), metric, windows)
        whole = fathom.score(pixels, metric, windows, backend="cpu")
        assert ours.shape == whole.shape
        np.testing.assert_array_equal(ours.compute(scheduler="synchronous"), whole)


def test_any_leading_axes_and_forms_of_pixels():
    pixels = noise((2, 3, 2, 80, 90), np.uint16).astype(">u2")
    array = da.from_array(pixels, (1, 2, 1, 40, 90))
    whole = fathom.score(pixels.astype(np.uint16).reshape(12, 80, 90), "fft:16", stride=9, backend="cpu")
    ours = fathom.dask.score(array, "fft:16", stride=9)
    np.testing.assert_array_equal(ours.compute(), whole.reshape((2, 3, 2) + whole.shape[1:]))
    assert fathom.dask.score(array[0, 0, 0], "fft:16").compute() == whole_middle(pixels[0, 0, 0])
    mask = da.from_array(noise((70, 70)) > 100, 30)
    assert fathom.dask.score(mask).compute() == fathom.score(mask.compute(), backend="cpu")
    assert fathom.dask.score(array[:0], "fft:16", stride=9).compute().shape == (0, 3, 2) + whole.shape[1:]


def whole_middle(picture):
    return fathom.score(picture.astype(np.uint16), "fft:16", backend="cpu")


def test_nothing_is_computed_before_it_is_asked_for():
    def fail(block):
        raise AssertionError("computed")

    lazy = da.zeros((4, 100, 100), chunks=50, dtype=np.uint8).map_blocks(fail, dtype=np.uint8, meta=noise((0, 0, 0)))
    assert fathom.dask.score(lazy, stride=10).shape == (4, 4, 4)
    assert fathom.dask.focus(lazy).shape == ()


REFUSED = [
    (dict(array=noise((64, 64))), "array is a ndarray"),
    (dict(array=da.zeros((64, 64))), "array has dtype float64"),
    (dict(array=da.zeros(64, dtype=np.uint8)), "array has 1 axes"),
    (dict(array=da.zeros((64, 60), dtype=np.uint8)), "a window has 64 x 64"),
    (dict(windows=[(0, 0), (7, 0)]), "windows[1] is outside"),
    (dict(windows=(0, -1)), "windows is outside"),
    (dict(windows=[]), "windows is empty"),
    (dict(windows=[(0.5, 0)]), "whole pixels"),
    (dict(windows=(0, 0), stride=3), "windows or stride"),
    (dict(stride=0), "stride is 0"),
    (dict(metric="fft:65"), "65"),
]


@pytest.mark.parametrize("arguments,words", REFUSED, ids=[words for _, words in REFUSED])
def test_is_refused_at_once(arguments, words):
    with pytest.raises(ValueError) as refused:
        fathom.dask.score(**{"array": da.zeros((70, 70), dtype=np.uint8), **arguments})
    assert words in str(refused.value)


def test_foci_are_those_of_every_stack():
    pictures = np.stack([stack(planes=15, focus=f, seed=s) for s, f in enumerate((4.4, 9.2))] + [noise((15, 96, 96))])
    z = 10.0 - 0.5 * np.arange(15)
    ours = fathom.dask.focus(da.from_array(pictures, (2, 4, 50, 96)), z, window=(5, 9)).compute()
    assert ours.dtype == fathom.dask.RESULT
    for one, pixels in zip(ours, pictures):
        theirs = fathom.focus(pixels, z, window=(5, 9), backend="cpu", threads=2)
        assert one["verdict"] == theirs.verdict and one["confidence"] == theirs.confidence
        assert np.isnan(one["position"]) if not theirs else one["position"] == theirs.position
        assert np.isnan(one["sigma"]) if not theirs else one["sigma"] == theirs.sigma
    assert list(ours["plane"]) == [4, 9, -1]
    with pytest.raises(ValueError, match="positions holds 3"):
        fathom.dask.focus(da.from_array(pictures), [1, 2, 3])


def test_depths_are_those_of_every_stack():
    pictures = np.stack([slope()[0], slope(seed=6)[0]])
    z = 0.5 * np.arange(pictures.shape[1])
    ours = fathom.dask.depth(da.from_array(pictures, (1, 4, 50, 128)), z, window=32)
    assert ours.shape == (2,) + pictures.shape[2:]
    values = ours.compute(scheduler="synchronous")
    for one, pixels in zip(values, pictures):
        theirs = fathom.depth(pixels, z, window=32, backend="cpu", threads=2)
        for name in ("depth", "sigma", "confidence", "index", "classes", "sharp"):
            np.testing.assert_array_equal(one[name], getattr(theirs, name), err_msg=name)
    assert np.isfinite(values["depth"]).any()


def test_xarray_brings_its_positions():
    xarray = pytest.importorskip("xarray")
    pictures = da.from_array(stack(planes=15, focus=4.4)[None], (1, 5, 96, 96))
    z = 2.0 * np.arange(15)
    named = xarray.DataArray(pictures, dims=("well", "z", "y", "x"), coords={"z": z})
    assert fathom.dask.focus(named).compute()["position"] == fathom.dask.focus(pictures, z).compute()["position"]


def test_dimensions_are_understood_by_their_names():
    xarray = pytest.importorskip("xarray")
    pixels = stack(planes=9, focus=4.4)
    z = {"z": ("z", 0.5 * np.arange(9), {"units": "um"})}
    named = xarray.DataArray(pixels, dims=("z", "y", "x"), coords=z)
    expected = fathom.focus(pixels, 0.5 * np.arange(9), window=(5, 9))
    lead = xarray.concat([named, named], "well")
    for order in [("z", "y", "x"), ("y", "x", "z"), ("x", "z", "y")]:
        turned = named.transpose(*order)
        found = fathom.focus(turned, window=(5, 9))
        assert (found.position, found.unit) == (expected.position, "um"), order
        np.testing.assert_array_equal(fathom.depth(turned).depth, fathom.depth(named).depth)
        lazy = lead.transpose(*order[:2], "well", order[2]).chunk(5)
        foci = fathom.dask.focus(lazy, window=(5, 9)).compute()
        assert foci["position"].tolist() == [expected.position] * 2 and foci["unit"].tolist() == ["um"] * 2, order
        assert fathom.dask.depth(lazy, window=32).shape == (2, 96, 96)
    upright = fathom.score(pixels[0][:70], "fft:16", windows=(3, 40))
    assert fathom.score(named[0, :70].transpose("x", "y"), "fft:16", windows=(3, 40)) == upright
    lying = lead[:, :, :70].transpose("x", "z", "y", "well").chunk(7)
    np.testing.assert_array_equal(fathom.dask.score(lying, "fft:16", (3, 40)).compute()[0, 0], upright)
    with pytest.raises(ValueError, match="one is missing, that of the pictures"):
        fathom.focus(named[0])


LATE = [
    (lambda a: fathom.dask.score(a, stride=2.5), "stride is 2.5; it is an integer"),
    (lambda a: fathom.dask.score(a, stride="3"), "stride is '3'; it is an integer"),
    (lambda a: fathom.dask.score(a, threads=0), "threads is 0"),
    (lambda a: fathom.dask.focus(a, search="spectra"), "search is 'spectra'"),
    (lambda a: fathom.dask.focus(a, window=(90, 0)), "window is (90, 0)"),
    (lambda a: fathom.dask.focus(a, metric="fft:16:rings=4"), "of 4 numbers for each window"),
    (lambda a: fathom.dask.focus(a, unit=5), "unit is 5"),
    (lambda a: fathom.dask.focus(a, speed=5), "unexpected argument 'speed'"),
    (lambda a: fathom.dask.depth(a, window=12), "windows of 12 px"),
    (lambda a: fathom.dask.depth(a, fill="x"), "fill is 'x'"),
    (lambda a: fathom.dask.depth(a, speed=5), "unexpected argument 'speed'"),
    (lambda a: fathom.dask.depth(a[:2]), "a map needs 3 positions"),
]


@pytest.mark.parametrize("call,words", LATE, ids=[words for _, words in LATE])
def test_is_refused_before_it_is_computed(call, words):
    with pytest.raises((ValueError, TypeError)) as refused:
        call(da.zeros((5, 96, 96), dtype=np.uint8))
    assert words in str(refused.value)
