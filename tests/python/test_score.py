# SPDX-License-Identifier: Apache-2.0
"""fathom.score against the oracle, in place, on several threads."""

import json
import os
import subprocess
import threading
import tracemalloc
import warnings

import fathom
import numpy as np
import pytest
from locks import looks_while
from pictures import noise, write_pgm

EXACT = ["walsh-sequency:16", "walsh-paley:64", "walsh-hadamard:8"]
CLOSE = ["fft:32:hann", "fft:16:power:band=0.05-0.3", "dct:32", "fft:32:hann:power:rings=4"]


def forms(picture):
    """The same pixels, lying otherwise: name, array, whether it must be copied."""
    rows, columns = picture.shape
    wide = np.zeros((rows, columns + 7), picture.dtype)
    wide[:, 3:-4] = picture
    read_only = picture.copy()
    read_only.flags.writeable = False
    odd = np.zeros(picture.nbytes + 1, np.uint8)[1:].view(picture.dtype).reshape(picture.shape)
    odd[:] = picture
    every_second = np.zeros((rows, 2 * columns), picture.dtype)
    every_second[:, ::2] = picture
    yield "contiguous", picture, False
    yield "rows apart", wide[:, 3:-4], False
    yield "read-only", read_only, False
    yield "unaligned", odd, False
    yield "Fortran", np.asfortranarray(picture), True
    yield "rows upward", picture[::-1].copy()[::-1], True
    yield "columns backward", picture[:, ::-1].copy()[:, ::-1], True
    yield "every second column", every_second[:, ::2], True
    if picture.dtype == np.uint16:
        yield "big-endian", picture.astype(">u2"), True


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("metric", EXACT + CLOSE)
def test_equals_the_oracle_however_pixels_lie(metric, dtype):
    picture = noise((70, 83), dtype, seed=len(metric))
    oracle = fathom.score(picture, metric, stride=9, backend="reference")
    for name, array, must_copy in forms(picture):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            scores = fathom.score(array, metric, stride=9, backend="cpu")
        assert [w.category for w in said] == [fathom.CopyWarning] * must_copy, name
        if metric in EXACT:
            np.testing.assert_array_equal(scores, oracle, err_msg=f"{metric} {name}")
        else:
            np.testing.assert_allclose(scores, oracle, rtol=2e-5, err_msg=f"{metric} {name}")


def random_view(random):
    """Pixels that lie somehow in a larger array: parts, steps, both directions, axes turned, either byte order."""
    base = random.integers(0, 65536, random.integers(90, 130, 3), dtype=np.uint16)
    base = base.astype(random.choice(["u1", "<u2", ">u2"]))
    base = base[tuple(slice(random.integers(0, 5), side - random.integers(0, 5)) for side in base.shape)]
    steps = random.choice([1, 1, 1, 2, 3, -1, -2], 3)
    steps[2] = random.choice([1, steps[2]])
    view = base[tuple(slice(None, None, step) for step in steps)]
    view = view.transpose(random.permutation(3)) if random.integers(2) else view
    view = view[:random.integers(1, 4)]
    view.flags.writeable = bool(random.integers(2))
    return view if random.integers(2) else view[0]


def lies_in_place(view):
    """As docs/python.md says: native pixels side by side in a row, rows one after the other."""
    return view.dtype.isnative and view.strides[-1] == view.itemsize and view.strides[-2] >= view.shape[-1] * view.itemsize


@pytest.mark.parametrize("seed", range(40))
def test_random_views_equal_the_oracle_on_their_plain_pixels(seed):
    random = np.random.default_rng(seed)
    view, metric = random_view(random), random.choice(["walsh-sequency:8", "walsh-paley:16", "fft:16:hann", "dct:8"])
    n, before = int(metric.split(":")[1]), view.copy()
    corners = [(int(random.integers(0, view.shape[-1] - n + 1)), int(random.integers(0, view.shape[-2] - n + 1)))
               for _ in range(5)]
    plain = np.array(view.astype(view.dtype.newbyteorder("=")), order="C")
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        scores = fathom.score(view, metric, corners, backend="cpu")
    about = f"seed {seed}: {metric}, shape {view.shape}, strides {view.strides}, {view.dtype}"
    assert [w.category for w in said] == [fathom.CopyWarning] * (not lies_in_place(view)), about
    np.testing.assert_allclose(scores, fathom.score(plain, metric, corners, backend="reference"),
                               rtol=0 if metric.startswith("walsh") else 2e-5, err_msg=about)
    np.testing.assert_array_equal(view, before)


def test_a_mask_of_bool_is_scored_as_zeros_and_ones():
    mask = noise((64, 64)) > 100
    assert fathom.score(mask, backend="cpu") == fathom.score(mask.astype(np.uint8), backend="cpu")


def test_shapes():
    stack = noise((3, 80, 96))
    rings = "fft:16:hann:power:rings=4"
    assert isinstance(fathom.score(stack[0], "fft:16"), float)
    assert isinstance(fathom.score(stack[0], "fft:16", windows=(3, 4)), float)
    assert fathom.score(stack[0], "fft:16", windows=[(3, 4)]).shape == (1,)
    assert fathom.score(stack[0], rings, windows=(3, 4)).shape == (4,)
    assert fathom.score(stack, "fft:16").shape == (3,)
    assert fathom.score(stack, rings, windows=[(0, 0), (8, 8)]).shape == (3, 2, 4)
    assert fathom.score(stack, rings, stride=16).shape == (3, 5, 6, 4)


def test_windows_as_list_and_array_and_grid_are_one():
    picture = noise((64, 64))
    corners = [(x, y) for y in range(0, 49, 16) for x in range(0, 49, 16)]
    listed = fathom.score(picture, "walsh-paley:16", windows=corners)
    array = fathom.score(picture, "walsh-paley:16", windows=np.array(corners, np.uint16))
    grid = fathom.score(picture, "walsh-paley:16", stride=16)
    np.testing.assert_array_equal(listed, array)
    np.testing.assert_array_equal(listed, grid.ravel())


def test_planes_of_a_stack_that_lie_backward_are_no_copy():
    stack = noise((4, 64, 64))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scores = fathom.score(stack[::-1], "walsh-paley:32")
    np.testing.assert_array_equal(scores[::-1], fathom.score(stack, "walsh-paley:32"))


REFUSED = [
    (dict(image=noise((64, 64)).astype(np.float32)), "image has dtype float32"),
    (dict(image=noise((64, 64)).astype(np.int8)), "image has dtype int8"),
    (dict(image=np.ma.masked_equal(noise((64, 64)), 0)), "image is a masked array"),
    (dict(image=noise((64, 64, 3))), "image has shape (64, 64, 3)"),
    (dict(image=noise((64,))), "image has shape (64,)"),
    (dict(image=noise((0, 64, 64))), "image has shape (0, 64, 64)"),
    (dict(image=None), "image is None"),
    (dict(image="photo.png"), "image has dtype <U9"),
    (dict(metric="fft:65"), "65"),
    (dict(windows=[(0, 0), (1, 0)]), "windows[1]"),
    (dict(windows=[(0.5, 0)]), "windows[0]: x is 0.5"),
    (dict(windows=[(0, 0, 64)]), "windows[0] is (0, 0, 64)"),
    (dict(windows=[(10**30, 0)]), "windows[0]: x ="),
    (dict(windows=np.array([[2**40, 0]])), "windows[0] is outside"),
    (dict(windows=np.zeros((1, 2))), "windows is an array of float64"),
    (dict(windows=[]), "windows is empty"),
    (dict(windows=(0, 0), stride=4), "windows or stride"),
    (dict(stride=0), "stride is 0"),
    (dict(threads=0), "threads is 0"),
    (dict(threads="all"), "threads is 'all'; it is an integer"),
    (dict(threads=2**40), "threads is 1099511627776; it is an integer that is not so large"),
    (dict(stride=1.5), "stride is 1.5; it is an integer"),
    (dict(metric=5), "metric is 5; it is a text"),
    (dict(backend=5), "backend is 5; it is a text"),
]


@pytest.mark.parametrize("arguments,words", REFUSED, ids=[words for _, words in REFUSED])
def test_is_refused_by_the_name_of_the_argument(arguments, words):
    with pytest.raises(ValueError) as refused:
        fathom.score(**{"image": noise((64, 64)), **arguments})
    assert words in str(refused.value)
    assert "--" not in str(refused.value)
    assert refused.value.code in ("bad_argument", "out_of_bounds")


def test_a_backend_that_is_not_there_has_a_code():
    with pytest.raises(fathom.Error) as missing:
        fathom.score(noise((64, 64)), backend="abacus")
    assert missing.value.code == "unavailable" and not isinstance(missing.value, ValueError)


def test_views_are_used_without_a_copy():
    large = noise((6000, 6000))
    view = large[100:-100, 100:-100]
    fathom.score(view, windows=(0, 0))
    tracemalloc.start()  # numpy tells it of every array
    try:
        fathom.score(view, windows=[(0, 0), (5000, 5000)])
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 100_000


def test_the_lock_is_released():
    picture = noise((700, 700))
    assert looks_while(lambda: fathom.score(picture, "fft:64", stride=8, backend="reference", threads=1)) > 0


def test_several_threads_score_alike():
    picture = noise((256, 256))
    alone = fathom.score(picture, "fft:32:hann", stride=16, threads=1)
    answers = [None] * 8

    def work(i):
        for _ in range(20):
            answers[i] = fathom.score(picture, "fft:32:hann", stride=16, threads=1)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(len(answers))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for answer in answers:
        np.testing.assert_array_equal(answer, alone)


def resident_kib():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def test_memory_does_not_grow():
    picture, stack = noise((64, 64)), noise((2, 64, 64))
    plan = fathom.Plan("walsh-sequency:64", 1)

    def call(times):
        for _ in range(times):
            fathom.score(picture, windows=[(0, 0)])
            plan.wait(plan.submit(picture, [(0, 0)]))
            if _ % 10 == 0:
                fathom.score(stack, "fft:16:hann:power:rings=4", stride=16, threads=1)
                with pytest.raises(ValueError):
                    fathom.score(picture, windows=[(1, 0)])

    call(1000)
    before = resident_kib()
    call(100_000)
    assert resident_kib() - before < 4096


def test_equals_the_program_to_the_last_bit(tmp_path):
    picture = noise((120, 160), seed=5)
    write_pgm(tmp_path / "picture.pgm", picture)
    for metric in ("walsh-sequency:32", "fft:32:hann", "dct:16:power"):
        said = subprocess.run(
            [os.environ["FATHOM_PROGRAM"], "score", tmp_path / "picture.pgm", "--metric", metric, "--grid", "24",
             "--backend", "cpu", "--json"], check=True, capture_output=True, text=True).stdout
        theirs = [json.loads(line)["score"] for line in said.splitlines()]
        ours = fathom.score(picture, metric, stride=24, backend="cpu").ravel()
        assert theirs == ours.tolist(), metric


def test_spectrum():
    picture = noise((64, 64))
    window = picture[8:40, 16:48].astype(float)
    ours = fathom.spectrum(picture, "fft:32:none", (16, 8), backend="reference")
    np.testing.assert_allclose(ours, np.fft.fftshift(np.fft.fft2(window)) / 32**2, atol=1e-9)
    real = fathom.spectrum(picture, "walsh-paley:32", (16, 8), backend="reference")
    assert real.dtype == np.float64
    assert real[0, 0] == pytest.approx(window.mean())
    with pytest.raises(ValueError, match="metric is None"):
        fathom.spectrum(picture, None)
    with pytest.raises(ValueError, match="one window"):
        fathom.spectrum(picture, "fft:32", [(0, 0), (1, 1)])


def test_a_plan_makes_no_array_where_it_is_given_room():
    count = 20_000
    picture, corners = noise((480, 640)), np.zeros((count, 2), int)
    with fathom.Plan("fft:16:hann", count, "cpu") as plan:
        out = np.empty(count)
        plan.score(picture, corners, out)
        tracemalloc.start()
        try:
            for _ in range(100):
                plan.wait(plan.submit(picture, corners, out))
            _, most = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
    # What the interpreter itself holds (a kilobyte or two) is left; an array of results or corners is not.
    assert most < out.nbytes / 10


def test_plan_streams():
    pictures = noise((6, 96, 96), np.uint16)
    windows = [(0, 0), (30, 20)]
    metric = "fft:32:hann:power:rings=4"
    expected = fathom.score(pictures, metric, windows, backend="cpu")
    with fathom.Plan(metric, 2, "cpu") as plan:
        room = [np.empty((2, 4)) for _ in pictures]
        tickets = [plan.submit(picture, windows, out) for picture, out in zip(pictures, room)]
        for ticket, out, values in zip(tickets, room, expected):
            assert plan.wait(ticket) is out
            np.testing.assert_array_equal(out, values)
        with pytest.raises(ValueError, match="ticket"):
            plan.wait(tickets[0])
        with pytest.raises(ValueError, match="capacity is 2"):
            plan.submit(pictures[0], [(0, 0)] * 3)
        with pytest.raises(ValueError, match=r"out must be .* shape \(2, 4\)"):
            plan.submit(pictures[0], windows, np.empty(2))
        plan.submit(pictures[0], windows)  # left in flight
    with pytest.raises(ValueError, match="closed"):
        plan.submit(pictures[0], windows)
    for capacity, words in [(0, "capacity is 0"), (-1, "capacity is -1"), (None, "capacity is None; it is an integer")]:
        with pytest.raises(ValueError, match=words):
            fathom.Plan(metric, capacity)
