"""Pictures by OpenImageIO, read and written."""

import struct
import tracemalloc
import zlib

import numpy as np
import pytest

from child_process import kill_program, run_program
from core.errors import DataError, FileError, ParameterError
from nodes.files.formats import as_stored, read_pixels, write_picture
from nodes.files.pictures import read_band, read_info
from picture_samples import SPECIAL, by_openimageio, fits, png, samples_of, tiff, tiff_tag

KINDS = ("u1", "u2", "u4", "i1", "i2", "i4", "f2", "f4", "f8")


def fits_bytes(stored, bits, **cards):
    header = {"SIMPLE": "T", "BITPIX": bits, "NAXIS": stored.ndim}
    header |= {f"NAXIS{axis + 1}": size for axis, size in enumerate(stored.shape[::-1])}
    data = stored.astype(stored.dtype.newbyteorder(">")).tobytes()
    return fits([*(header | cards).items()], data)


def png_bytes(lines, columns, depth, colour):
    packed = zlib.compress(b"".join(b"\0" + line for line in lines))
    return png(len(lines), columns, depth, packed, colour)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("layout", [{}, {"order": ">"}, {"big": True}, {"tile": 16}])
def test_tiff_of_every_type_delivers_the_stored_numbers(tmp_path, kind, layout):
    truth = samples_of(kind, 20, 35)
    (tmp_path / "a.tif").write_bytes(tiff(truth, **layout)[0])
    wanted = np.float64 if kind in ("f8", "u4", "i4") else np.float32
    read = read_band(tmp_path / "a.tif")
    assert read.dtype == wanted
    assert read.flags.c_contiguous
    assert np.array_equal(read, truth.astype(wanted))
    info = read_info(tmp_path / "a.tif")
    assert (info.rows, info.columns, info.bands) == (20, 35, 1)
    assert (info.dtype, info.kind) == (truth.dtype.name, "tiff")


@pytest.mark.parametrize("compression", ["none", "zip"])
@pytest.mark.parametrize("predictor", [1, 2, 3])
@pytest.mark.parametrize("planes", ["contig", "separate"])
def test_tiles_of_doubles_as_another_program_writes_them(tmp_path, compression, predictor, planes):
    truth = np.random.default_rng(0).normal(size=(40, 51, 3))
    truth[0, : len(SPECIAL), 0] = SPECIAL
    how = {"compression": compression, "tiff:predictor": predictor, "planarconfig": planes}
    by_openimageio(tmp_path / "a.tif", truth, tile=(32, 16), **how)
    for band in range(3):
        read = read_band(tmp_path / "a.tif", band)
        assert np.array_equal(read.view("u8"), truth[:, :, band].copy().view("u8"))


def test_a_single_row_of_doubles_packed_otherwise_is_refused(tmp_path):
    by_openimageio(tmp_path / "a.tif", np.ones((1, 9)), compression="lzw")
    with pytest.raises(FileError, match=r"single row cannot be read .* allowed: none or deflate"):
        read_band(tmp_path / "a.tif")


@pytest.mark.parametrize("damage", [(262, 4, 129, 1), (266, 3, 1, 2)])
def test_doubles_that_neither_reader_can_read_are_refused(tmp_path, damage):
    """A directory of which the library makes a grey picture, and gives memory nobody wrote to."""
    content = tiff(samples_of("f8", 20, 35), tile=16)[0]
    grey = tiff_tag(262, 1)
    path = tmp_path / "a.tif"
    path.write_bytes(content.replace(grey, struct.pack("<HHII", *damage)))
    with pytest.raises(FileError, match=r"a\.tif: 64-bit samples in tiles or a single row cannot"):
        read_pixels(path)


def test_tiles_whose_zero_is_white_are_read_but_not_those_of_doubles(tmp_path):
    for kind in ("f4", "f8"):
        content = tiff(samples_of(kind, 20, 35), tile=16)[0]
        white = content.replace(tiff_tag(262, 1), tiff_tag(262, 0))
        assert white != content
        (tmp_path / f"{kind}.tif").write_bytes(white)
    assert read_pixels(tmp_path / "f4.tif").shape[:2] == (20, 35)
    with pytest.raises(FileError, match="photometric interpretation 0 cannot be read"):
        read_pixels(tmp_path / "f8.tif")


def test_damaged_tiles_of_doubles(tmp_path):
    path = tmp_path / "a.tif"
    whole = tiff(samples_of("f8", 20, 35), tile=16)[0]
    path.write_bytes(whole.replace(struct.pack("<HHII", 325, 4, 6, 0)[:8], bytes(8)))
    with pytest.raises(FileError, match=r"damaged|cannot be opened"):
        read_band(path)
    lzw = tiff_tag(259, 5)
    path.write_bytes(whole.replace(tiff_tag(259, 1), lzw))
    with pytest.raises(FileError, match="cannot be read with TIFF compression 5; allowed: none or"):
        read_band(path)
    places = np.frombuffer(whole, np.uint8).copy()
    for index in range(len(whole) - 160, len(whole)):
        damaged = places.copy()
        damaged[index] ^= 0xFF
        path.write_bytes(damaged.tobytes())
        try:
            assert read_band(path).ndim == 2
        except FileError:
            continue


def test_colour_is_not_multiplied_by_alpha(tmp_path):
    lines = [bytes([200, 100, 50, 10] * 3)] * 2
    (tmp_path / "a.png").write_bytes(png_bytes(lines, 3, 8, 6))
    for band, value in enumerate((200, 100, 50, 10)):
        assert np.all(read_band(tmp_path / "a.png", band) == value)


@pytest.mark.parametrize(
    ("depth", "line", "truth"),
    [(1, b"\xa0", [1, 0, 1]), (2, b"\xe4", [3, 2, 1]), (4, b"\xf5\x30", [15, 5, 3])],
)
def test_packed_png_keeps_its_own_numbers(tmp_path, depth, line, truth):
    (tmp_path / "a.png").write_bytes(png_bytes([line], 3, depth, 0))
    assert read_band(tmp_path / "a.png").tolist() == [truth]


def test_packed_12_bit_tiff_keeps_its_own_numbers(tmp_path):
    content = tiff(np.array([[0x12, 0x3A, 0xBC]], dtype="u1"))[0]
    # Two 12-bit samples, 0x123 and 0xABC, in the three bytes of the strip.
    content = content.replace(tiff_tag(258, 8), tiff_tag(258, 12))
    content = content.replace(tiff_tag(256, 3), tiff_tag(256, 2))
    (tmp_path / "a.tif").write_bytes(content)
    assert read_band(tmp_path / "a.tif").tolist() == [[0x123, 0xABC]]


def radiance_hdr(rows, columns, pixel):
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n".encode()
    return head + bytes(pixel) * (rows * columns)


def test_radiance_hdr_is_told_from_an_envi_header(tmp_path):
    path = tmp_path / "a.hdr"
    path.write_bytes(radiance_hdr(2, 3, (128, 64, 32, 129)))  # value = byte/256·2^(e−128)
    assert read_info(path).kind == "hdr"
    assert np.all(read_pixels(path, 0) == 1.0)
    assert np.all(read_pixels(path, 2) == 0.25)


@pytest.mark.parametrize("name", ["a.tif", "a.exr", "a.png", "a.fits", "a.hdr", "a.jpg"])
def test_truncated_files_are_refused_in_silence(tmp_path, name, capfd):
    rng = np.random.default_rng(0)
    path = tmp_path / name
    if name == "a.fits":
        path.write_bytes(fits_bytes(rng.random((60, 48)), -64))
    elif name == "a.hdr":
        path.write_bytes(radiance_hdr(60, 50, (128, 64, 32, 129)))
    elif name == "a.jpg":
        by_openimageio(path, rng.integers(0, 255, (60, 50), dtype=np.uint8))
    else:
        dtype = "uint16" if name == "a.png" else "float"
        scale = {"low": 0, "high": 1} if name == "a.png" else {}
        write_picture(path, rng.random((60, 50)), dtype=dtype, **scale)
    whole = path.read_bytes()
    assert read_band(path).shape[0] == 60
    for length in (1, 9, 100, len(whole) // 2, len(whole) * 9 // 10, len(whole) - 300):
        path.write_bytes(whole[:length])
        with pytest.raises(FileError) as caught:
            read_band(path)
        assert "\n" not in caught.value.message
        assert str(path) in caught.value.message
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("name", "dtype", "numpy_type"),
    [
        ("a.tif", "float", np.float32),
        ("a.tiff", "double", np.float64),
        ("a.exr", "float", np.float32),
        ("a.exr", "half", np.float16),
    ],
)
def test_floats_read_back_bit_for_bit(tmp_path, name, dtype, numpy_type):
    rng = np.random.default_rng(0)
    truth = rng.normal(size=(33, 21)).astype(numpy_type)
    with np.errstate(over="ignore"):
        truth[0, : len(SPECIAL)] = np.array(SPECIAL).astype(numpy_type)
    write_picture(tmp_path / name, truth, dtype=dtype)
    read = read_band(tmp_path / name)
    bits = f"u{truth.itemsize}"
    assert read.dtype == (np.float64 if dtype == "double" else np.float32)
    assert np.array_equal(read.astype(numpy_type).view(bits), truth.view(bits))
    assert list(tmp_path.iterdir()) == [tmp_path / name]


def test_whole_numbers_are_made_block_by_block():
    """Of 1003 rows of 100 doubles, 0.8 MB, the copies that scaling takes are those of 256."""
    samples = np.random.default_rng(0).normal(size=(1003, 100, 1))
    tracemalloc.start()
    try:
        stored = as_stored(samples, "uint16", -1.0, 1.0)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < stored.nbytes + 4 * 8 * 256 * 100
    np.testing.assert_array_equal(stored, np.rint((samples.clip(-1, 1) + 1) / 2 * 65535))
    samples[700, 3] = np.nan
    with pytest.raises(DataError, match="sample at row 700, column 3 is not finite"):
        as_stored(samples, "uint16", -1.0, 1.0)


@pytest.mark.parametrize("name", ["a.tif", "a.exr"])
def test_channels_are_bands(tmp_path, name):
    truth = np.random.default_rng(0).random((4, 6, 4), dtype=np.float32)
    write_picture(tmp_path / name, truth)
    assert read_info(tmp_path / name).bands == 4
    for band in range(4):
        assert np.array_equal(read_pixels(tmp_path / name, band), truth[:, :, band])
    for band in (-1, 4):
        with pytest.raises(FileError, match=f"no band {band}; allowed: 0 to 3"):
            read_pixels(tmp_path / name, band)


@pytest.mark.parametrize(("dtype", "top"), [("uint8", 255), ("uint16", 65535)])
def test_display_scaling(tmp_path, dtype, top):
    values = np.array([[-1e300, 9.9, 10, 15, 20, 20.1, 1e300]])
    write_picture(tmp_path / "a.png", values, dtype=dtype, low=10, high=20)
    middle = round(top / 2)
    assert read_band(tmp_path / "a.png").tolist() == [[0, 0, 0, middle, top, top, top]]


@pytest.mark.parametrize("name", ["a.tif", "a.exr", "a.png"])
def test_metadata_is_found_again(tmp_path, name):
    metadata = {"unit": "W/m^2/sr", "fov_x_deg": 23.8, "fov_y_deg": 17.9, "focal_length_mm": 38}
    dtype = "uint8" if name == "a.png" else "float"
    write_picture(tmp_path / name, np.ones((2, 3)), dtype=dtype, metadata=metadata)
    info = read_info(tmp_path / name)
    assert (info.unit, info.fov_x_deg, info.fov_y_deg) == ("W/m^2/sr", 23.8, 17.9)
    assert info.focal_length_mm == 38


@pytest.mark.parametrize(
    ("name", "array", "options", "error", "message"),
    [
        ("a.xyz", [[1.0]], {}, FileError, "unknown picture suffix '.xyz'; allowed: .exr, .tif"),
        ("a", [[1.0]], {}, FileError, "unknown picture suffix ''"),
        ("a.png", [[1.0]], {}, ParameterError, "dtype = 'float' is not allowed: must be one of"),
        (
            "a.exr",
            [[1.0]],
            {"dtype": "double"},
            ParameterError,
            "one of float, half for the suffix .exr",
        ),
        ("a.tif", [1.0], {}, DataError, "shape .1,. cannot"),
        ("a.tif", np.zeros((0, 3)), {}, DataError, "not empty"),
        ("a.tif", [[1j]], {}, DataError, "allowed: real numbers"),
        ("a.tif", [[0, 1e39]], {}, DataError, "too small .* the first at row 0, column 1"),
        ("a.exr", [[0, 7e4]], {"dtype": "half"}, DataError, "±65504, is too small"),
        (
            "a.png",
            [[0, 0.5]],
            {"dtype": "uint8"},
            DataError,
            "0.5 at row 0, column 1 does not fit uint8",
        ),
        ("a.png", [[0, 256]], {"dtype": "uint8"}, DataError, "give low and high to scale"),
        ("a.png", [[np.nan]], {"dtype": "uint8"}, DataError, "not finite"),
        ("a.png", [[1]], {"dtype": "uint8", "low": 1, "high": 1}, ParameterError, "above low = 1"),
        ("a.png", [[1]], {"dtype": "uint8", "low": 1}, ParameterError, "two finite numbers"),
        ("a.tif", [[1]], {"low": 0, "high": 1}, ParameterError, "empty with dtype float"),
        ("no/a.tif", [[1]], {}, FileError, "there is no folder"),
    ],
)
def test_what_cannot_be_written(tmp_path, name, array, options, error, message):
    with pytest.raises(error, match=message):
        write_picture(tmp_path / name, array, **options)
    assert not list(tmp_path.iterdir())


FULL_DISK = """
import resource, sys
from pathlib import Path
import numpy as np
from core.errors import FileError
from nodes.files.pictures import read_band
from nodes.files.formats import write_picture
folder = Path(sys.argv[1])
samples = np.random.default_rng(0).integers(0, 65536, (60, 60))
free = resource.RLIM_INFINITY
for name, dtype in (("a.tif", "float"), ("a.exr", "float"), ("a.png", "uint16")):
    write_picture(folder / name, samples // 2, dtype=dtype)
    size = (folder / name).stat().st_size
    write_picture(folder / name, samples, dtype=dtype)
    for limit in (0, 10, 500, size // 2, size * 9 // 10, size - 40, size - 1):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, free))
        try:
            write_picture(folder / name, samples // 2, dtype=dtype)
            print("not noticed", name, limit, size)
        except FileError as error:
            if not error.message.startswith(f"cannot write {folder / name}: "):
                print(error.message)
        resource.setrlimit(resource.RLIMIT_FSIZE, (free, free))
        if not np.array_equal(read_band(folder / name), samples):
            print("lost", name, limit, size)
print(sorted(entry.name for entry in folder.iterdir()))
"""


def test_full_disk_is_noticed_at_every_place_and_keeps_the_old_picture(tmp_path):
    done = run_program(FULL_DISK, str(tmp_path))
    assert done.stdout == "['a.exr', 'a.png', 'a.tif']\n"
    assert done.stderr == ""


WRITE_FOR_EVER = """
import itertools, sys
import numpy as np
from nodes.files.formats import write_picture
for count in itertools.count(1):
    write_picture(sys.argv[1], np.full((600, 700), count, dtype=np.float32))
    if count == 1:
        print("first", flush=True)
"""


@pytest.mark.parametrize("name", ["a.tif", "a.exr"])
def test_killed_at_any_time_the_picture_is_whole(tmp_path, name):
    path = tmp_path / name
    for delay_s in (0.0, 0.013, 0.031, 0.05):
        kill_program(WRITE_FOR_EVER, str(path), says="first", after_s=delay_s)
        read = read_band(path)
        assert read.shape == (600, 700)
        assert np.all(read == read[0, 0])
