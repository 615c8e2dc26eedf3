"""Files of frames, and tiled TIFF."""

import struct

import numpy as np
import OpenImageIO
import pytest
from PIL import Image as Pillow

from child_process import PEAK, run_program
from core.errors import FileError
from nodes.files.formats import read_info, read_pixels
from nodes.files.frames import (
    FrameSeries,
    open_frames,
    refuse_without_room,
    write_envi,
    write_frames,
    write_tiled_tiff,
)
from picture_samples import envi

KNOWN = {"unit": "W/m²/sr", "fov_x_deg": 3.5, "fov_y_deg": 2.5, "focal_length_mm": 100.0}
TYPES = ("<u2", "<u4", "<f4", "<f8")


def drawn(dtype, shape=(5, 7, 11)):
    numbers = np.random.default_rng(5).uniform(0, 60000, shape)
    return (np.rint(numbers) if dtype[1] == "u" else numbers - 30000).astype(dtype)


def written(folder, name, samples, known=KNOWN):
    path = folder / name
    series = FrameSeries(len(samples), *samples.shape[1:], samples.dtype, known)
    if path.suffix == ".bsq":
        write_envi(path, series, iter(samples))
    else:
        write_frames(path, series, iter(samples))
    assert 0 <= path.stat().st_size - series.size_bytes <= 600 * len(samples)
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
def test_pages_by_pillow(tmp_path, known):
    samples = drawn("<u2", (3, 6, 9))
    path = written(tmp_path, "f.tif", samples, known)
    with Pillow.open(path) as picture:
        assert picture.n_frames == 3
        for number, frame in enumerate(samples):
            picture.seek(number)
            np.testing.assert_array_equal(np.asarray(picture), frame)
            assert ("unit = " in picture.tag_v2.get(270, "")) == bool(known)


@pytest.mark.parametrize(("frames", "version"), [(31, 42), (32, 43)])
def test_beyond_four_gigabytes_a_tiff_is_big(tmp_path, frames, version):
    """Of pages of 128 MiB, before the first is written."""
    series = FrameSeries(frames, 1 << 13, 1 << 13, np.dtype("<u2"))
    path = tmp_path / "f.tif"
    write_frames(path, series, iter(()))
    assert struct.unpack_from("<H", path.read_bytes(), 2) == (version,)


def test_without_room_it_is_refused_before(tmp_path):
    small = FrameSeries(10, 10, 10, np.dtype("<u2"))
    huge = FrameSeries(10**6, 10**6, 10**6, np.dtype("<f8"))
    refuse_without_room([(tmp_path / "f.bsq", small)])
    with pytest.raises(FileError) as raised:
        refuse_without_room([(tmp_path / "f.bsq", small), (tmp_path / "g.bsq", huge)])
    line = str(raised.value)
    assert line.startswith(
        f"cannot write {tmp_path / 'g.bsq'}: 1000000 frames of 1000000 × 1000000 samples take "
        "8e+09 GB, but only "
    )
    assert "\n" not in line
    store = FrameSeries(1, 10**6, 10**7, np.dtype("<f8"))
    with pytest.raises(FileError, match=r"a\.zarr: 1000000 × 10000000 samples take 8e\+04 GB, but"):
        refuse_without_room([(tmp_path / "a.zarr", store)])


FRAMES = np.random.default_rng(3).integers(0, 60000, (6, 9, 13)).astype(np.uint16)


def pages(path, frames, **how):
    first, *others = (Pillow.fromarray(frame) for frame in frames)
    first.save(path, save_all=True, append_images=others, **how)
    return path


def bands(path, frames, interleave="bsq"):
    return envi(path, frames.transpose(1, 2, 0), interleave, data_units="DN")


def npy(path, frames):
    np.save(path, frames)
    return path


def check(path, frames=FRAMES):
    found = open_frames(path)
    assert (found.frames, found.rows, found.columns) == frames.shape
    read = list(found.each())
    assert len(read) == len(frames)
    for one, frame in zip(read, frames, strict=True):
        np.testing.assert_array_equal(one, frame)
    return found


@pytest.mark.parametrize("how", [{}, {"compression": "tiff_adobe_deflate"}, {"big_tiff": True}])
def test_pages_of_a_tiff(tmp_path, how):
    assert check(pages(tmp_path / "f.tif", FRAMES, **how)).dtype == np.uint16


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_other_samples(tmp_path, kind):
    frames = (FRAMES / 300).astype(kind)
    check(pages(tmp_path / "f.tif", frames), frames)
    check(npy(tmp_path / "f.npy", frames), frames)


@pytest.mark.parametrize("interleave", ["bsq", "bil", "bip"])
def test_bands_of_an_envi_file(tmp_path, interleave):
    path = bands(tmp_path / "f.bsq", FRAMES, interleave)
    assert check(path).unit == "DN"
    check(path.with_name("f.bsq.hdr"))


def refusal(path):
    with pytest.raises(FileError) as raised:
        open_frames(path)
    assert "\n" not in str(raised.value)
    return str(raised.value).removeprefix(f"{path}: ")


def test_what_is_refused(tmp_path):
    assert refusal(pages(tmp_path / "a.tif", [FRAMES[0], FRAMES[1], FRAMES[2, :4]])) == (
        "the frames differ: page 3 has 4 × 13 samples of uint16, but the first page has 9 × 13 "
        "samples of uint16; allowed: frames of the same size and type"
    )
    assert "page 2 has 9 × 13 samples of float32, but the first page" in refusal(
        pages(tmp_path / "b.tif", [FRAMES[0], FRAMES[1].astype(np.float32)])
    )
    colour = np.zeros((4, 5, 3), np.uint8)
    assert refusal(pages(tmp_path / "c.tif", [colour, colour])) == (
        "page 1 has channels = 3, compression = 1; allowed: one channel of plain numbers, "
        "uncompressed or deflate"
    )
    assert "page 1 has channels = 1, compression = 5" in refusal(
        pages(tmp_path / "d.tif", FRAMES, compression="tiff_lzw")
    )
    assert refusal(npy(tmp_path / "e.npy", np.zeros(5))) == (
        "contains an array of shape (5,); allowed: (frames, rows, columns), all above 0"
    )
    assert "contains samples of type complex128" in refusal(
        npy(tmp_path / "f.npy", np.zeros((2, 3, 4), complex))
    )
    Pillow.fromarray(colour).save(tmp_path / "g.png")
    assert refusal(tmp_path / "g.png") == (
        "frames cannot be read from this file; allowed: .npy (frames, rows, columns), TIFF with "
        "one page per frame, ENVI with one band per frame"
    )
    cut = pages(tmp_path / "h.tif", FRAMES)
    cut.write_bytes(cut.read_bytes()[:-300])
    assert "damaged" in refusal(cut)


def test_directories_in_a_circle(tmp_path):
    path = pages(tmp_path / "f.tif", FRAMES[:2])
    content = bytearray(path.read_bytes())
    first = int.from_bytes(content[4:8], "little")
    count = int.from_bytes(content[first : first + 2], "little")
    after = first + 2 + 12 * count
    content[after : after + 4] = first.to_bytes(4, "little")
    path.write_bytes(content)
    assert refusal(path).endswith("the directories form a loop")


@pytest.mark.parametrize("name", ["f.npy", "f.tif", "f.bsq"])
def test_many_frames_take_the_memory_of_a_few(tmp_path, name):
    """Of 20 frames or of 600, 48 MB in all, in a process of their own."""
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from nodes.files.frames import open_frames\n"
        "print(sum(float(f.sum()) for f in open_frames(Path(sys.argv[1])).each()))\n"
        f"{PEAK}"
    )
    peaks = []
    for count in (20, 600):
        frames = np.full((count, 200, 200), 7, np.uint16)
        made = {"f.npy": npy, "f.tif": pages, "f.bsq": bands}[name](tmp_path / name, frames)
        total, peak = run_program(code, str(made)).stdout.split()
        assert float(total) == frames.sum()
        peaks.append(int(peak) / 1024)
    assert peaks[1] < peaks[0] + 8.0


@pytest.mark.parametrize("shape", [(53, 101), (600, 1031), (1, 7), (512, 512), (2, 3000)])
@pytest.mark.parametrize("kind", ["<f4", "<f8", "<u2", "<u4"])
def test_read_by_others_and_by_us(tmp_path, shape, kind):
    samples = np.random.default_rng(2).integers(0, 60000, shape).astype(kind)
    series = FrameSeries(1, *shape, np.dtype(kind), {"unit": "DN", "fov_x_deg": 2.5})
    path = tmp_path / "a.tif"
    write_tiled_tiff(path, series, samples)
    picture = OpenImageIO.ImageInput.open(str(path))
    spec = picture.spec()
    assert (spec.height, spec.width, spec.nchannels) == (*shape, 1)
    sides = (spec.tile_height, spec.tile_width)  # a thin picture is not filled up to squares
    assert sides == tuple(min(512, -(-side // 16) * 16) for side in shape)
    if kind != "<f8":  # which that library misreads in tiles
        read = picture.read_image(spec.format)
        np.testing.assert_array_equal(read[:, :, 0], samples)
    picture.close()
    info = read_info(path)
    assert (info.unit, info.fov_x_deg, info.dtype) == ("DN", 2.5, np.dtype(kind).name)
    np.testing.assert_array_equal(read_pixels(path), samples)
