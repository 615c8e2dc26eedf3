import struct
import zlib

import numpy as np
import pytest

from core.errors import FileError
from nodes.files.formats import write_picture
from nodes.files.pictures import read_band, read_info
from nodes.files.read import read_pixels
from picture_samples import SPECIAL, fits, png, samples_of, tiff, tiff_tag

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
    import OpenImageIO

    truth = np.random.default_rng(0).normal(size=(40, 51, 3))
    truth[0, : len(SPECIAL), 0] = SPECIAL
    spec = OpenImageIO.ImageSpec(51, 40, 3, "double")
    spec.tile_width, spec.tile_height = 32, 16
    spec.attribute("compression", compression)
    spec.attribute("tiff:predictor", predictor)
    spec.attribute("planarconfig", planes)
    output = OpenImageIO.ImageOutput.create("tif")
    assert output.open(str(tmp_path / "a.tif"), spec)
    assert output.write_image(truth)
    assert output.close()
    output.geterror()
    for band in range(3):
        read = read_band(tmp_path / "a.tif", band)
        assert np.array_equal(read.view("u8"), truth[:, :, band].copy().view("u8"))


def test_a_single_row_of_doubles_packed_otherwise_is_refused(tmp_path):
    import OpenImageIO

    spec = OpenImageIO.ImageSpec(9, 1, 1, "double")
    spec.attribute("compression", "lzw")
    output = OpenImageIO.ImageOutput.create("tif")
    assert output.open(str(tmp_path / "a.tif"), spec)
    assert output.write_image(np.ones((1, 9, 1)))
    assert output.close()
    output.geterror()
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


def test_damaged_tiles_of_doubles(tmp_path):
    path = tmp_path / "a.tif"
    whole = tiff(samples_of("f8", 20, 35), tile=16)[0]
    path.write_bytes(whole.replace(struct.pack("<HHII", 325, 4, 6, 0)[:8], bytes(8)))
    with pytest.raises(FileError, match=r"damaged|cannot be opened"):
        read_band(path)
    lzw = tiff_tag(259, 5)
    path.write_bytes(whole.replace(tiff_tag(259, 1), lzw))
    with pytest.raises(FileError, match="cannot be read from TIFF compression 5; allowed: none or"):
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


def test_fits_scaling(tmp_path):
    truth = np.array([[0, 1, 32768, 65535]])
    stored = (truth - 32768).astype("i2")
    (tmp_path / "a.fits").write_bytes(fits_bytes(stored, 16, BZERO=32768, BSCALE=1))
    assert np.array_equal(read_band(tmp_path / "a.fits"), truth)
    (tmp_path / "a.fits").write_bytes(fits_bytes(stored, 16, BZERO=10.5, BSCALE=0.25))
    assert np.array_equal(read_band(tmp_path / "a.fits"), stored * 0.25 + 10.5)


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
    import OpenImageIO

    rng = np.random.default_rng(0)
    path = tmp_path / name
    if name == "a.fits":
        path.write_bytes(fits_bytes(rng.random((60, 48)), -64))
    elif name == "a.hdr":
        path.write_bytes(radiance_hdr(60, 50, (128, 64, 32, 129)))
    elif name == "a.jpg":
        spec = OpenImageIO.ImageSpec(50, 60, 1, "uint8")
        output = OpenImageIO.ImageOutput.create(str(path))
        output.open(str(path), spec)
        output.write_image(rng.integers(0, 255, (60, 50, 1), dtype=np.uint8))
        output.close()
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
