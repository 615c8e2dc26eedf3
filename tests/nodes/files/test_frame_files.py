"""Files of frames, read back by Pillow, OpenImageIO, numpy and byte by byte."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from PIL import Image as Pillow

from core.errors import FileError
from nodes.files.frames import (
    STORE,
    FrameSeries,
    frame_format,
    header_beside_frames,
    refuse_without_room,
    tiff_head,
    tiff_page,
    write_frames,
)
from nodes.files.read import read_info, read_pixels

KNOWN = {"unit": "W/m²/sr", "fov_x_deg": 3.5, "fov_y_deg": 2.5, "focal_length_mm": 100.0}
TYPES = ("<u2", "<u4", "<f4", "<f8")


def drawn(dtype, shape=(5, 7, 11)):
    numbers = np.random.default_rng(5).uniform(0, 60000, shape)
    return (np.rint(numbers) if dtype[1] == "u" else numbers - 30000).astype(dtype)


def written(folder, name, samples, known=KNOWN):
    path = folder / name
    kind = frame_format(path)
    series = FrameSeries(len(samples), *samples.shape[1:], samples.dtype, known)
    write_frames(path, kind, series, iter(samples))
    if kind.beside is not None:
        header_beside_frames(path).write_text(kind.beside(series), encoding="utf-8")
    assert path.stat().st_size == kind.size_bytes(series)
    return path


@pytest.mark.parametrize("dtype", TYPES)
class TestTypes:
    def test_bsq_and_its_header(self, tmp_path, dtype):
        samples = drawn(dtype)
        path = written(tmp_path, "f.bsq", samples)
        np.testing.assert_array_equal(np.fromfile(path, dtype).reshape(samples.shape), samples)
        info = read_info(path)
        assert (info.rows, info.columns, info.bands) == (7, 11, 5)
        assert (info.unit, info.fov_x_deg, info.focal_length_mm) == ("W/m²/sr", 3.5, 100.0)
        np.testing.assert_array_equal(read_pixels(path, band=3), samples[3])

    def test_tiff_by_openimageio(self, tmp_path, dtype):
        import OpenImageIO

        samples = drawn(dtype)
        path = written(tmp_path, "f.tif", samples)
        picture = OpenImageIO.ImageInput.open(str(path))
        for number, frame in enumerate(samples):
            assert picture.seek_subimage(number, 0)
            spec = picture.spec()
            assert (spec.height, spec.width, spec.nchannels) == (7, 11, 1)
            kind = {"u2": "uint16", "u4": "uint", "f4": "float", "f8": "double"}[dtype[1:]]
            assert spec.format == OpenImageIO.TypeDesc(kind)
            read = picture.read_image(kind)
            np.testing.assert_array_equal(np.asarray(read).reshape(7, 11), frame)
        assert not picture.seek_subimage(len(samples), 0)
        picture.close()
        assert read_info(path).unit == "W/m²/sr"


@pytest.mark.parametrize("known", [{}, {"unit": "K"}, KNOWN])
@pytest.mark.parametrize("big", [False, True])
def test_classic_and_big_tiff_by_pillow(tmp_path, known, big):
    samples = drawn("<u2", (3, 6, 9))
    series = FrameSeries(3, 6, 9, samples.dtype, known)
    content = tiff_head(series, big=big)
    for number, frame in enumerate(samples):
        content += tiff_page(series, number, big=big) + frame.tobytes()
    assert struct.unpack_from("<H", content, 2) == (43 if big else 42,)
    (tmp_path / "f.tif").write_bytes(content)
    with Pillow.open(tmp_path / "f.tif") as picture:
        assert picture.n_frames == 3
        for number, frame in enumerate(samples):
            picture.seek(number)
            np.testing.assert_array_equal(np.asarray(picture), frame)
            text = picture.tag_v2.get(270, "").strip()
            assert ("unit = " in text) == bool(known)


def test_beyond_four_gigabytes_a_tiff_is_big(tmp_path):
    """A file with holes, of forty pages of 128 MiB: the last one lies beyond 4 GiB."""
    series = FrameSeries(40, 1 << 13, 1 << 13, np.dtype("<u2"), {"unit": "DN"})
    assert tiff_head(series)[2] == 43
    assert tiff_head(FrameSeries(31, 1 << 13, 1 << 13, np.dtype("<u2")))[2] == 42
    page = len(tiff_page(series, 0)) + series.frame_bytes
    path = tmp_path / "f.tif"
    with path.open("wb") as file:
        file.write(tiff_head(series))
        for number in range(series.frames):
            file.seek(len(tiff_head(series)) + number * page)
            file.write(tiff_page(series, number))
        place = file.tell()
        file.write(struct.pack("<HH", 4095, 7))
        file.truncate(place + series.frame_bytes)
    assert place > 1 << 32
    with Pillow.open(path) as picture:
        picture.seek(39)
        assert picture.size == (1 << 13, 1 << 13)
        assert picture.tag_v2[273] == (place,)
        with pytest.raises(EOFError):
            picture.seek(40)


def test_without_room_it_is_refused_before(tmp_path):
    kind = frame_format(tmp_path / "f.bsq")
    small = FrameSeries(10, 10, 10, np.dtype("<u2"))
    huge = FrameSeries(10**6, 10**6, 10**6, np.dtype("<f8"))
    refuse_without_room([(tmp_path / "f.bsq", kind, small)])
    with pytest.raises(FileError) as raised:
        refuse_without_room([(tmp_path / "f.bsq", kind, small), (tmp_path / "g.bsq", kind, huge)])
    line = str(raised.value)
    assert line.startswith(
        f"cannot write {tmp_path / 'g.bsq'}: 1000000 frames of 1000000 × 1000000 samples take "
        "8e+09 GB, but only "
    )
    assert "\n" not in line
    store = FrameSeries(1, 10**6, 10**7, np.dtype("<f8"))
    with pytest.raises(FileError, match=r"a\.zarr: 1000000 × 10000000 samples take 8e\+04 GB, but"):
        refuse_without_room([(tmp_path / "a.zarr", STORE, store)])
