"""Zarr stores against the library's own reading and writing, chunk by chunk."""

import os
import resource

import numcodecs
import numpy as np
import pytest
import zarr

from core.errors import FileError
from nodes.files import zarr_array
from nodes.files.formats import read_info, read_pixels
from nodes.files.zarr_array import write_store

RNG = np.random.default_rng(7)


def stored(path, samples, **how):
    """A store as the library writes it."""
    array = zarr.create_array(path, shape=samples.shape, dtype=samples.dtype, **how)
    array[...] = samples
    return path


@pytest.mark.parametrize(
    ("kind", "how"),
    [
        ("<f4", {"chunks": (32, 17)}),
        (">f8", {"chunks": (97, 5), "compressors": None}),
        ("<u2", {"chunks": (7, 89), "zarr_format": 2}),
        ("|i1", {"chunks": (8, 8), "shards": (32, 32)}),
    ],
)
def test_read_as_it_was_stored(tmp_path, monkeypatch, kind, how):
    monkeypatch.setattr(zarr_array, "_READ_SAMPLES", 500)  # blocks of a few chunks
    samples = RNG.integers(0, 100, (97, 89)).astype(kind)
    path = stored(tmp_path / "a.zarr", samples, **how)
    info, read = read_info(path), read_pixels(path)
    assert (info.rows, info.columns, info.bands, info.kind) == (97, 89, 1, "zarr")
    assert info.dtype == np.dtype(kind).newbyteorder("=").name
    assert read.dtype == (np.float64 if kind == ">f8" else np.float32)
    np.testing.assert_array_equal(read, samples)


@pytest.mark.parametrize(
    ("names", "order"),
    [(None, (0, 1, 2)), (("band", "y", "x"), (2, 0, 1)), (("lon", "lat", "t"), (1, 0, 2))],
)
def test_bands_by_the_names_of_dimensions(tmp_path, names, order):
    cube = RNG.normal(size=(11, 13, 3)).astype(np.float32)  # rows, columns, bands
    placed = np.transpose(cube, order)
    path = stored(tmp_path / "a.zarr", placed, chunks=(4, 2, 5), dimension_names=names)
    assert (read_info(path).rows, read_info(path).columns, read_info(path).bands) == (11, 13, 3)
    np.testing.assert_array_equal(read_pixels(path, 2), cube[:, :, 2])
    with pytest.raises(FileError, match="there is no band 3; allowed: 0 to 2"):
        read_pixels(path, 3)


def test_what_the_attributes_give(tmp_path):
    samples = np.array([[1, 2, -9], [4, 5, 6]], np.int16)
    attributes = {"units": "K", "fov_x_deg": 3.0, "_FillValue": -9, "scale_factor": 0.1}
    path = stored(tmp_path / "a.zarr", samples, chunks=(2, 2), attributes=attributes)
    info = read_info(path)
    assert (info.unit, info.fov_x_deg, info.not_applied) == ("K", 3.0, ("scale_factor",))
    np.testing.assert_array_equal(read_pixels(path), [[1, 2, np.nan], [4, 5, 6]])


@pytest.mark.parametrize(("shape", "kind"), [((53, 101), "<f4"), ((1, 7), "<f8")])
def test_written_chunk_by_chunk(tmp_path, monkeypatch, shape, kind):
    monkeypatch.setattr(zarr_array, "_CHUNK", 16)
    samples = RNG.normal(size=shape).astype(kind)
    samples[:16, :7] = 0  # a chunk that the library would leave out
    write_store(tmp_path / "a.zarr", samples, {"unit": "W/m²/sr", "fov_x_deg": 2.5})
    there = zarr.open_array(tmp_path / "a.zarr", mode="r")
    assert there.chunks == tuple(min(16, size) for size in shape)
    assert there.nchunks_initialized == there.nchunks
    np.testing.assert_array_equal(there[...], samples)
    info = read_info(tmp_path / "a.zarr")
    assert (info.unit, info.fov_x_deg, info.dtype) == ("W/m²/sr", 2.5, np.dtype(kind).name)
    np.testing.assert_array_equal(read_pixels(tmp_path / "a.zarr"), samples)


def test_groups(tmp_path):
    group = zarr.open_group(tmp_path / "a.zarr", mode="w", attributes={"fov_x_deg": 4.0})
    group.create_array("x", shape=(5,), dtype="f8")
    scene = RNG.normal(size=(5, 6)).astype(np.float32)
    group.create_array("scene", data=scene, chunks=(2, 2))
    assert read_info(tmp_path / "a.zarr").fov_x_deg == 4.0
    np.testing.assert_array_equal(read_pixels(tmp_path / "a.zarr"), scene)
    group.create_array("other", data=scene + 1, chunks=(2, 2))
    with pytest.raises(FileError, match=r"with 2 or 3 dimensions \(a.zarr/other, a.zarr/scene"):
        read_info(tmp_path / "a.zarr")
    np.testing.assert_array_equal(read_pixels(tmp_path / "a.zarr" / "other"), scene + 1)


def test_damage_is_one_line(tmp_path):
    samples = RNG.normal(size=(20, 20)).astype(np.float32)
    path = stored(tmp_path / "a.zarr", samples, chunks=(10, 10), compressors=None)
    chunk = path / "c" / "1" / "0"
    chunk.write_bytes(chunk.read_bytes()[:100])
    with pytest.raises(FileError, match=r"a.zarr: rows 0 to 20, columns 0 to 20 cannot be read: "):
        read_pixels(path)
    (path / "zarr.json").write_text('{"shape": [1')
    with pytest.raises(FileError, match=r"a.zarr: cannot be read as a Zarr store: "):
        read_info(path)
    (path / "zarr.json").unlink()
    with pytest.raises(FileError, match=r"a.zarr: a folder, not a file"):
        read_info(path)
    with pytest.raises(FileError, match=r"contains an array of shape \(4,\); allowed: "):
        read_info(stored(tmp_path / "b.zarr", np.zeros(4), chunks=(2,)))


@pytest.mark.parametrize(
    "how", [{"chunks": (1, 4, 8)}, {"chunks": (3, 2, 2), "shards": (3, 4, 8)}, {"zarr_format": 2}]
)
@pytest.mark.parametrize("samples", [30, 1 << 20])
def test_a_chunk_that_is_not_there_is_missing_samples(tmp_path, monkeypatch, how, samples):
    """Bands first, then rows: of a plane of zeros the library writes no chunk."""
    monkeypatch.setattr(zarr_array, "_READ_SAMPLES", samples)
    how = {"chunks": (1, 4, 8), **how}
    cube = 1 + RNG.random((3, 11, 13)).astype(np.float32)
    cube[:, 4:8, 8:] = 0.0
    names = ("t", "y", "x")
    if "zarr_format" in how:
        how["attributes"] = {"_ARRAY_DIMENSIONS": list(names)}
    else:
        how["dimension_names"] = names
    path = stored(tmp_path / "a.zarr", cube, **how)
    truth = np.where(cube[1] == 0.0, np.nan, cube[1])
    assert read_info(path).absent_chunks == 3 // how.get("shards", how["chunks"])[0]
    np.testing.assert_array_equal(read_pixels(path, 1), truth)
    whole = stored(tmp_path / "b.zarr", 1 + cube, **how)
    assert read_info(whole).absent_chunks == 0
    (whole / "a file of another's").write_text("")
    assert read_info(whole).absent_chunks == 0


@pytest.mark.parametrize("packing", ["gzip", "zlib", "blosc"])
@pytest.mark.parametrize("content", [b"", b"\x1f\x8b\x08", bytes(range(256)) * 9])
def test_damaged_chunks_of_every_packing_are_refused(tmp_path, packing, content):
    packings = {"gzip": numcodecs.GZip(), "zlib": numcodecs.Zlib(), "blosc": numcodecs.Blosc()}
    path = tmp_path / "a.zarr"
    how = {"chunks": (10, 10), "zarr_format": 2, "compressors": packings[packing]}
    stored(path, RNG.random((20, 20)), **how)
    (path / "1.0").write_bytes(content)
    with pytest.raises(FileError, match=r"a\.zarr: .*(cannot be read|is truncated)"):
        read_pixels(path)


@pytest.mark.parametrize("version", [2, 3])
def test_a_chunk_of_blosc_cut_short_is_refused(tmp_path, version):
    """It would be unpacked from memory that lies behind it."""
    packing = {2: numcodecs.Blosc(), 3: zarr.codecs.BloscCodec()}[version]
    how = {"chunks": (10, 10), "zarr_format": version, "compressors": packing}
    path = stored(tmp_path / "a.zarr", RNG.random((20, 20)), **how)
    chunk = path / {2: "1.0", 3: "c/1/0"}[version]
    chunk.write_bytes(chunk.read_bytes()[:-9])
    with pytest.raises(FileError, match=r"a\.zarr: damaged: its chunk .* is truncated"):
        read_pixels(path)


@pytest.mark.parametrize("name", ["c/1/0", "scene.zarr/zarr.json", "new"])
def test_pipes_devices_and_linked_folders_in_a_store_are_refused(tmp_path, name):
    path = stored(tmp_path / "a.zarr", np.ones((20, 20)), chunks=(10, 10))
    place = path / name
    for put in (
        lambda: os.mkfifo(place),
        lambda: place.symlink_to("/dev/zero"),
        lambda: place.symlink_to(tmp_path),
    ):
        place.parent.mkdir(exist_ok=True)
        place.unlink(missing_ok=True)
        put()
        with pytest.raises(FileError, match=rf"{name}: not a regular file"):
            read_pixels(path)


def test_a_store_is_replaced_whole_or_not_at_all(tmp_path):
    path, first = tmp_path / "a.zarr", np.ones((30, 40), np.float32)
    write_store(path, first, {})
    write_store(path, 2 * first, {"unit": "K"})
    np.testing.assert_array_equal(read_pixels(path), 2 * first)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, before[1]))  # as a disk that is full
    try:
        with pytest.raises(FileError, match=r"cannot write .*a\.zarr: File too large"):
            write_store(path, 3 * first, {})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    np.testing.assert_array_equal(read_pixels(path), 2 * first)
    assert [one.name for one in tmp_path.iterdir()] == ["a.zarr"]
    (tmp_path / "b.zarr").mkdir()
    with pytest.raises(
        FileError, match=r"b\.zarr: it exists and is not a Zarr store; allowed: a new"
    ):
        write_store(tmp_path / "b.zarr", first, {})
