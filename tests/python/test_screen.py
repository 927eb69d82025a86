# SPDX-License-Identifier: Apache-2.0
"""fathom.screen in one process: what it reads, what the table says, and that nothing is done twice."""

import csv
import json

import fathom
import numpy as np
import pytest
from pictures import noise, stack, write_pgm

tifffile = pytest.importorskip("tifffile")

METRIC = "walsh-sequency:32"


def small(focus, seed=1, planes=9):
    return stack(planes=planes, focus=focus, side=64, seed=seed)


def expected(pixels, positions=None, window=None):
    return fathom.focus(pixels, positions, METRIC, window, backend="cpu")


def assert_is(row, result):
    assert (row.position, row.sigma, row.confidence, row.verdict, row.reason) == (
        result.position, result.sigma, result.confidence, result.verdict, result.reason)


def run(uris, tmp_path, **options):
    return fathom.screen(uris, METRIC, out=tmp_path / "table.csv", **options)


def test_tiffs_of_every_kind(tmp_path):
    focused, blank = small(3.3), noise((9, 64, 64))
    tifffile.imwrite(tmp_path / "plain.tif", focused)
    tifffile.imwrite(tmp_path / "packed.tif", focused, compression="zlib", photometric="minisblack")
    tifffile.imwrite(tmp_path / "big.tif", blank.astype(np.uint16), byteorder=">")
    both = np.stack([focused, blank], axis=1)
    tifffile.imwrite(tmp_path / "channels.tif", both, imagej=True,
                     metadata={"axes": "ZCYX", "spacing": 0.25, "unit": "um"})
    tifffile.imwrite(tmp_path / "five.ome.tif", np.stack([both, both[::-1]]),
                     metadata={"axes": "TZCYX", "PhysicalSizeZ": 500, "PhysicalSizeZUnit": "nm"})
    with tifffile.TiffWriter(tmp_path / "series.ome.tif") as writer:
        writer.write(focused, metadata={"axes": "ZYX"})
        writer.write(blank, metadata={"axes": "ZYX"})
    names = ["plain.tif", "packed.tif", "big.tif", "channels.tif", "five.ome.tif", "series.ome.tif"]
    rows = run([tmp_path / name for name in names], tmp_path)
    assert [row.field for row in rows] == ["", "", "", "c=0", "c=1", "t=0,c=0", "t=0,c=1", "t=1,c=0", "t=1,c=1",
                                           "series=0", "series=1"]
    plain = expected(focused)
    assert plain and rows[0].plane == round(plain.position)
    for row in (rows[0], rows[1], rows[9]):
        assert_is(row, plain)
    assert_is(rows[2], expected(blank.astype(np.uint16)))
    assert_is(rows[3], expected(focused, 0.25 * np.arange(9)))
    assert_is(rows[5], expected(focused, 0.5 * np.arange(9)))
    assert_is(rows[7], expected(focused[::-1], 0.5 * np.arange(9)))
    assert [row.unit for row in rows[2:6]] == ["frames", "um", "um", "um"]
    assert rows[4].position is None and rows[4].plane is None


def test_the_table_reads_back_to_the_last_bit(tmp_path):
    tifffile.imwrite(tmp_path / "a,b.tif", small(3.3))
    rows = run(tmp_path / "a,b.tif", tmp_path, windows=[(0, 0), (32, 32)], positions=np.arange(9) / 3, unit="mm")
    with open(tmp_path / "table.csv", newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert [(row["uri"], row["x"], row["unit"]) for row in table] == [
        (str(tmp_path / "a,b.tif"), "0", "mm"), (str(tmp_path / "a,b.tif"), "32", "mm")]
    assert [float(row["position"]) for row in table] == [row.position for row in rows]
    assert_is(rows[1], fathom.focus(small(3.3), np.arange(9) / 3, METRIC, (32, 32), backend="cpu"))


def test_folders_are_read_as_the_program_reads_them(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    for i, picture in enumerate(small(3.3)):
        write_pgm(folder / f"plane_{i:02}.pgm", picture)
    row, = run(folder, tmp_path)
    assert_is(row, expected(small(3.3)))
    assert row.plane == 3


def test_zarr_images_plates_and_arrays(tmp_path):
    zarr = pytest.importorskip("zarr")
    focused = small(3.3)
    plate = zarr.open_group(str(tmp_path / "plate.zarr"), mode="w")
    plate.attrs["plate"] = {"wells": [{"path": "A/1"}, {"path": "B/2"}]}
    axes = [{"name": "c"}, {"name": "z", "unit": "micrometer"}, {"name": "y"}, {"name": "x"}]
    for well in ("A/1", "B/2"):
        plate.require_group(well).attrs["well"] = {"images": [{"path": "0"}]}
        image = plate.require_group(f"{well}/0")
        image.create_dataset("0", data=np.stack([focused, focused[::-1]]), chunks=(1, 4, 40, 40))
        scales = [{"type": "scale", "scale": [1, 2, 1, 1]}]
        image.attrs["multiscales"] = [{"axes": axes, "datasets": [{"path": "0", "coordinateTransformations": scales}]}]
    zarr.save_array(str(tmp_path / "plain.zarr"), focused)
    rows = run([tmp_path / "plate.zarr", tmp_path / "plain.zarr", tmp_path / "plate.zarr" / "A" / "1"], tmp_path)
    assert [(row.uri.rpartition("zarr")[2], row.field) for row in rows[:5]] == [
        ("/A/1/0", "c=0"), ("/A/1/0", "c=1"), ("/B/2/0", "c=0"), ("/B/2/0", "c=1"), ("", "")]
    assert_is(rows[0], expected(focused, 2.0 * np.arange(9)))
    assert_is(rows[3], expected(focused[::-1], 2.0 * np.arange(9)))
    assert_is(rows[4], expected(focused))
    assert rows[5].verdict == "error" and "multiscales" in rows[5].reason


def test_arrays_with_coordinates(tmp_path):
    xarray, da = pytest.importorskip("xarray"), pytest.importorskip("dask.array")
    pixels = np.stack([small(3.3), small(5.1)])
    z = {"z": ("z", 0.5 * np.arange(9), {"units": "um"}), "well": ["A1", "B2"]}
    for data in (pixels, da.from_array(pixels, (1, 4, 64, 30))):
        named = xarray.DataArray(data, dims=("well", "z", "y", "x"), coords=z)
        rows = fathom.screen(named, METRIC, out=tmp_path / f"{type(data).__name__}.csv")
        assert [(row.field, row.unit) for row in rows] == [("well=A1", "um"), ("well=B2", "um")]
        assert_is(rows[1], expected(small(5.1), 0.5 * np.arange(9)))


def test_what_is_done_is_not_done_again(tmp_path, monkeypatch):
    calls, work = [], fathom._tasks.work

    def counted(sources, settings):
        if len(calls) == 2:
            raise KeyboardInterrupt
        calls.append([key.split()[0] for key, _ in sources])
        return work(sources, settings)

    monkeypatch.setattr(fathom._tasks, "work", counted)
    paths = [tmp_path / f"{i}.tif" for i in range(4)]
    for i, path in enumerate(paths):
        tifffile.imwrite(path, small(2 + i, seed=i))
    with pytest.raises(KeyboardInterrupt):
        run(paths, tmp_path, at_once=1)
    assert not (tmp_path / "table.csv").exists()
    (tmp_path / "table.csv.parts" / "part-0.json").write_text('{"cut o')  # of a computer that lost its power
    monkeypatch.setattr(fathom._tasks, "work", lambda *a: calls.append([k.split()[0] for k, _ in a[0]]) or work(*a))
    seen = []
    rows = run(paths, tmp_path, at_once=1, progress=lambda done, total: seen.append((done, total)))
    assert calls == [[str(path)] for path in paths]
    assert seen == [(2, 4), (3, 4), (4, 4)]
    for i, row in enumerate(rows):
        assert_is(row, expected(small(2 + i, seed=i)))
    tifffile.imwrite(paths[1], small(7, planes=12))  # another picture
    again = run(paths, tmp_path)
    assert calls[4:] == [[str(paths[1])]] and [again[0], again[2], again[3]] == [rows[0], rows[2], rows[3]]
    assert_is(again[1], expected(small(7, planes=12)))


def test_a_source_in_two_parts_counts_once(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", small(3.3))
    tifffile.imwrite(tmp_path / "b.tif", small(4.3))
    rows = run([tmp_path / "a.tif", tmp_path / "b.tif", tmp_path / "a.tif"], tmp_path, at_once=1)
    parts = sorted((tmp_path / "table.csv.parts").glob("part-*"))
    both = {}
    for part in parts:
        both.update(json.loads(part.read_text()))
    (tmp_path / "table.csv.parts" / "part-of-both.json").write_text(json.dumps(both))
    assert len(rows) == 2 and run([tmp_path / "*.tif"], tmp_path) == rows


def test_a_bad_file_costs_only_itself_and_is_tried_again(tmp_path):
    tifffile.imwrite(tmp_path / "good.tif", small(3.3))
    (tmp_path / "bad.tif").write_bytes(b"II*\0no")
    tifffile.imwrite(tmp_path / "float.tif", small(3.3).astype(np.float32))
    tifffile.imwrite(tmp_path / "colour.tif", noise((64, 64, 3)), photometric="rgb")
    tifffile.imwrite(tmp_path / "small.tif", noise((5, 20, 20)))
    names = ["bad", "good", "float", "colour", "small", "missing"]
    uris = [tmp_path / f"{name}.tif" for name in names]
    rows = run(uris, tmp_path)
    assert [row.verdict for row in rows] == ["error", "focused", "error", "error", "error", "error"]
    for row, words in zip(rows, ["", "", "float32", "axes are YXS", "window", "No such file"]):
        assert words in row.reason
    tifffile.imwrite(tmp_path / "missing.tif", small(3.3))
    assert run(uris, tmp_path)[5].verdict == "focused"


@pytest.mark.parametrize("options,words", [
    (dict(out="table.txt"), "table is .csv or .parquet"), (dict(out="nowhere/table.csv"), "no folder"),
    (dict(metric="fft:64:rings=4"), "one number a window"), (dict(windows=[]), "windows is"),
    (dict(windows=[(1, 2, 3)]), "windows is"), (dict(at_once=0), "at_once is 0"), (dict(uris="none*.tif"), "none*.tif"),
    (dict(metric="fft:16"), "of other settings")], ids=lambda value: str(value))
def test_is_refused(options, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    fathom.screen([], METRIC)
    with pytest.raises((ValueError, OSError)) as refused:
        fathom.screen(**{"uris": [], **options})
    assert words in str(refused.value)
    with pytest.raises(TypeError, match="'serch'"):
        fathom.screen([], METRIC, serch="full")


def test_what_changed_within_a_folder_is_taken_anew(tmp_path):
    zarr = pytest.importorskip("zarr")
    folder = tmp_path / "folder"
    folder.mkdir()
    for focus in (3.3, 5.1):
        for i, picture in enumerate(small(focus)):
            write_pgm(folder / f"plane_{i:02}.pgm", picture)
        zarr.save_array(str(tmp_path / "plain.zarr"), small(focus))
        rows = run([folder, tmp_path / "plain.zarr"], tmp_path)
        for row in rows:
            assert_is(row, expected(small(focus)))


def test_other_coordinates_are_another_field(tmp_path):
    xarray = pytest.importorskip("xarray")
    named = xarray.DataArray(small(3.3)[None], dims=("well", "z", "y", "x"),
                             coords={"well": ["A1"], "z": ("z", np.arange(9.0), {"units": "um"})})
    first, = run(named, tmp_path)
    moved = named.assign_coords(z=("z", 10 * np.arange(9.0), {"units": "um"}), well=["B7"])
    second, = run(moved, tmp_path)
    assert (first.field, second.field) == ("well=A1", "well=B7")
    assert second.position == pytest.approx(10 * first.position)


def test_pages_that_were_written_one_by_one_are_a_stack(tmp_path):
    with tifffile.TiffWriter(tmp_path / "pages.tif") as writer:
        for picture in small(3.3):
            writer.write(picture)
    row, = run(tmp_path / "pages.tif", tmp_path)
    assert_is(row, expected(small(3.3)))


def test_a_source_without_a_field_costs_nothing(tmp_path):
    zarr = pytest.importorskip("zarr")
    image = zarr.open_group(str(tmp_path / "empty.zarr"), mode="w")
    image.create_dataset("0", shape=(0, 5, 64, 64), dtype="u1")
    image.attrs["multiscales"] = [{"axes": [{"name": a} for a in "tzyx"], "datasets": [{"path": "0"}]}]
    tifffile.imwrite(tmp_path / "plain.tif", small(3.3))
    for _ in range(2):
        row, = run([tmp_path / "empty.zarr", tmp_path / "plain.tif"], tmp_path)
        assert_is(row, expected(small(3.3)))


@pytest.mark.parametrize("wrong", [{"backend": "none"}, {"search": "none"}, {"peak": "none"}, {"threads": -1}])
def test_wrong_arguments_are_said_before_a_file_is_opened(tmp_path, wrong):
    with pytest.raises((ValueError, fathom.Error), match=next(iter(wrong))):
        run(tmp_path / "nothing.tif", tmp_path, **wrong)


def test_folders_say_their_own_positions(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(ValueError, match="manifest"):
        run(tmp_path / "folder", tmp_path, positions=range(9))
    for wrong in (5, np.zeros((3, 8, 8), np.uint8)):
        with pytest.raises(ValueError, match="uris"):
            run(wrong, tmp_path)


def cut_off(path, planes=9, left=6):
    """An OME-TIFF that promises more planes than it has."""
    whole = path.with_name("whole.ome.tif")
    tifffile.imwrite(whole, small(3.3, planes=planes), metadata={"axes": "ZYX", "PhysicalSizeZ": 0.5})
    with tifffile.TiffFile(whole) as tiff:
        about = tiff.ome_metadata.encode()
    with tifffile.TiffWriter(path) as writer:
        for i, picture in enumerate(small(3.3, planes=planes)[:left]):
            writer.write(picture, description=about if i == 0 else None, metadata=None, contiguous=False)
    whole.unlink()
    return path


def test_what_a_reader_finds_amiss_is_in_the_table_and_a_warning(tmp_path):
    with pytest.warns(fathom.PictureWarning, match="6 of 9 planes"):
        row, = run(cut_off(tmp_path / "cut.ome.tif"), tmp_path)
    assert_is(row, expected(small(3.3)[:6], 0.5 * np.arange(6)))
    assert row.unit == "um" and "plane 6 cannot be read" in row.warnings and "6 of 9 planes" in row.warnings
    with open(tmp_path / "table.csv", newline="", encoding="utf-8") as file:
        assert next(csv.DictReader(file))["warnings"] == row.warnings
    with pytest.warns(fathom.PictureWarning, match="promised"):
        maps = fathom.depth(tmp_path / "cut.ome.tif")
    assert "promised" in maps.warnings[0]
    with fathom.open_rig(f"replay:{tmp_path / 'cut.ome.tif'}") as rig, pytest.warns(fathom.PictureWarning, match="promised"):
        rig.focus()


def test_whole_files_warn_of_nothing(tmp_path, recwarn):
    tifffile.imwrite(tmp_path / "whole.ome.tif", small(3.3), metadata={"axes": "ZYX", "PhysicalSizeZ": 0.5})
    row, = run(tmp_path / "whole.ome.tif", tmp_path)
    fathom.depth(tmp_path / "whole.ome.tif")
    assert row.warnings == "" and not [w for w in recwarn if w.category is fathom.PictureWarning]


def test_a_file_under_two_names_is_measured_once(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", small(3.3))
    (tmp_path / "b.tif").symlink_to(tmp_path / "a.tif")
    (tmp_path / "folder").mkdir()
    names = [tmp_path / "a.tif", tmp_path / "b.tif", f"{tmp_path}/folder/../a.tif", tmp_path / "a.tif"]
    with pytest.warns(fathom.PictureWarning, match="another name; it is measured once") as said:
        rows = run(names, tmp_path)
    assert [row.uri for row in rows] == [str(tmp_path / "a.tif")] and len(said) == 2
