"""TIFF in tiles as others read it: OpenImageIO, and the directory by TIFF 6.0."""

import struct

import numpy as np
import OpenImageIO
import pytest

from nodes.files.frames import FrameSeries, tiled_head, write_tiled_tiff
from nodes.files.read import read_info, read_pixels


@pytest.mark.parametrize("shape", [(53, 101), (600, 1031), (1, 7), (512, 512)])
@pytest.mark.parametrize("kind", ["<f4", "<f8", "<u2", "<u4"])
def test_read_by_others_and_by_us(tmp_path, shape, kind):
    samples = np.random.default_rng(2).integers(0, 60000, shape).astype(kind)
    series = FrameSeries(1, *shape, np.dtype(kind), {"unit": "DN", "fov_x_deg": 2.5})
    path = tmp_path / "a.tif"
    write_tiled_tiff(path, series, samples)
    picture = OpenImageIO.ImageInput.open(str(path))
    spec = picture.spec()
    assert (spec.height, spec.width, spec.nchannels) == (*shape, 1)
    assert spec.tile_width == spec.tile_height == min(512, -(-max(shape) // 16) * 16)
    if kind != "<f8":  # which that library misreads in tiles
        read = picture.read_image(spec.format)
        np.testing.assert_array_equal(read[:, :, 0], samples)
    picture.close()
    info = read_info(path)
    assert (info.unit, info.fov_x_deg, info.dtype) == ("DN", 2.5, np.dtype(kind).name)
    np.testing.assert_array_equal(read_pixels(path), samples)


@pytest.mark.parametrize(("side", "tiles"), [(32768, 4096), (65536, 16384)])
def test_beyond_what_classic_tiff_addresses(side, tiles):
    series = FrameSeries(1, side, side, np.dtype("<f4"))
    head = tiled_head(series, 512)
    order, version, word, _, first = struct.unpack_from("<2sHHHQ", head)
    assert (order, version, word) == (b"II", 43, 8)
    (number,) = struct.unpack_from("<Q", head, first)
    tags = {
        tag: (kind, count, value)
        for tag, kind, count, value in (
            struct.unpack_from("<HHQQ", head, first + 8 + 20 * place) for place in range(number)
        )
    }
    assert list(tags) == sorted(tags)
    assert tags[322] == tags[323] == (4, 1, 512)
    kind, count, place = tags[324]
    assert (kind, count) == (16, tiles)
    places = struct.unpack_from(f"<{count}Q", head, place)
    assert places[0] == len(head)
    assert set(np.diff(places)) == {512 * 512 * 4}
