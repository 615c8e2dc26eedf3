"""FITS files: cards as the standard has them, sums, cubes, and what is refused."""

import re

import numpy as np
import pytest

from core.errors import FileError
from nodes.files.fits_header import read_fits_header
from nodes.files.formats import read_info, read_pixels
from picture_samples import fits

STORED = np.array([[-32768, -1, 0], [1, 5, 32767]], dtype=">i2")
CARDS = [("SIMPLE", "T"), ("BITPIX", 16), ("NAXIS", 2), ("NAXIS1", 3), ("NAXIS2", 2)]


@pytest.mark.parametrize(
    ("zero", "scale"), [("3.2768D4", "1"), ("3.2768d+04", "1.0D0"), ("0.1", "1D-1"), ("1.", ".5")]
)
def test_fits_numbers_with_the_exponents_of_fortran(tmp_path, zero, scale):
    path = tmp_path / "a.fits"
    path.write_bytes(fits([*CARDS, ("BZERO", zero), ("BSCALE", scale)], STORED.tobytes()))
    number = {"3.2768D4": 32768.0, "3.2768d+04": 32768.0, "0.1": 0.1, "1.": 1.0}[zero]
    step = {"1": 1.0, "1.0D0": 1.0, "1D-1": 0.1, ".5": 0.5}[scale]
    wanted = (STORED[::-1].astype(np.float64) * step + number).astype(np.float32)
    assert np.array_equal(read_pixels(path), wanted)


def test_fits_blank_is_a_missing_sample(tmp_path):
    path = tmp_path / "a.fits"
    for scaled in ([], [("BSCALE", "0.25")]):
        path.write_bytes(fits([*CARDS, ("BLANK", "5 / none"), *scaled], STORED.tobytes()))
        read = read_pixels(path)
        assert np.isnan(read).tolist() == [[False, True, False], [False] * 3]
        assert read[0, 2] == 32767 * (0.25 if scaled else 1.0)
    cards = [("SIMPLE", "T"), ("BITPIX", -32), *CARDS[2:], ("BLANK", 5)]  # no meaning for floats
    path.write_bytes(fits(cards, STORED.astype(">f4").tobytes()))
    assert read_pixels(path)[0, 1] == 5


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ([("BZERO", "many")], "BZERO = many; allowed: a finite number"),
        ([("BZERO", "1e999")], "BZERO = 1e999"),
        ([("BSCALE", "0.0")], "BSCALE = 0.0; allowed: a finite number other than 0"),
        ([("BLANK", "1.5")], "BLANK = 1.5; allowed: a whole number"),
        ([("BZERO", "1"), ("BZERO", "2")], "BZERO is given twice, as 1 and as 2"),
        (["BZERO   =32768"], "BZERO has no value: =32768 does not begin with an equals sign and"),
        (["BSCALE  2.0"], "BSCALE has no value: 2.0 does not begin with"),
        (["BZERO   = '32768'"], "BZERO = '32768' is text; allowed: a number without quotes"),
        (["BLANK   = '5' / none"], "BLANK = '5' / none is text"),
    ],
)
def test_fits_cards_that_cannot_be_used(tmp_path, cards, words):
    path = tmp_path / "a.fits"
    path.write_bytes(fits([*CARDS, *cards], STORED.tobytes()))
    for read in (read_info, read_pixels):
        with pytest.raises(FileError, match=re.escape(words)):
            read(path)


EMPTY = [("SIMPLE", "T"), ("BITPIX", 8), ("NAXIS", 0)]
EXTENSION = fits([("XTENSION", "'IMAGE   '"), *CARDS[1:]], STORED.tobytes())


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (
            fits(EMPTY, b"") + EXTENSION,
            "has no picture (NAXIS = 0); only the extensions contain data;",
        ),
        (fits(EMPTY, b""), "has no picture (NAXIS = 0); allowed: a picture in the primary"),
        (
            fits([("SIMPLE", "T"), ("BITPIX", 64), *CARDS[2:]], STORED.astype(">i8").tobytes()),
            "BITPIX = 64; allowed: 8, 16, 32, -32, -64",
        ),
        (
            fits([("SIMPLE", "F"), *CARDS[1:]], STORED.tobytes()),
            "SIMPLE = F, so the file does not follow the FITS standard",
        ),
        (
            fits([*CARDS[:2], ("NAXIS", 2), ("NAXIS1", "3.9"), CARDS[4]], STORED.tobytes()),
            "NAXIS1 = 3.9; allowed: a whole number of 1 or more",
        ),
        (
            fits([*CARDS[:3], ("NAXIS1", 0), CARDS[4]], STORED.tobytes()),
            "NAXIS1 = 0; allowed: a whole number of 1 or more",
        ),
        (fits(CARDS[:4], STORED.tobytes()), "this FITS header is damaged: NAXIS2 is missing"),
        (
            fits([*CARDS[:2], ("NAXIS", 5), *CARDS[3:]], STORED.tobytes()),
            "NAXIS = 5; allowed: a whole number from 1 to 4",
        ),
        (
            fits([*CARDS[:2], ("NAXIS", 4), *CARDS[3:], ("NAXIS3", 2), ("NAXIS4", 3)], bytes(72)),
            "NAXIS1 = 3, NAXIS2 = 2, NAXIS3 = 2, NAXIS4 = 3: this file has two axes beyond "
            "rows and columns; allowed: NAXIS3 or NAXIS4 = 1",
        ),
        (
            fits(
                [*CARDS[:2], ("NAXIS", 4), *CARDS[3:], ("NAXIS3", 1), ("NAXIS4", 2), ("NAXIS4", 1)],
                bytes(24),
            ),
            "NAXIS4 is given twice, as 2 and as 1; allowed: once",
        ),
    ],
)
def test_fits_without_a_picture_that_can_be_read(tmp_path, content, words):
    (tmp_path / "a.fits").write_bytes(content)
    for read in (read_info, read_pixels):
        with pytest.raises(FileError, match=re.escape(words)):
            read(tmp_path / "a.fits")


@pytest.mark.parametrize("depths", [(3,), (3, 1), (1, 3)])
def test_the_planes_of_a_fits_cube_are_its_bands(tmp_path, depths):
    """Along the third axis or along the fourth, as cubes with a Stokes axis have it."""
    cube = np.arange(18, dtype=">i2").reshape(3, 2, 3)
    axes = [("NAXIS", 2 + len(depths)), *CARDS[3:]]
    axes += [(f"NAXIS{number}", size) for number, size in enumerate(depths, 3)]
    (tmp_path / "a.fits").write_bytes(fits([*CARDS[:2], *axes], cube.tobytes()))
    assert read_info(tmp_path / "a.fits").bands == 3
    for band in range(3):
        assert np.array_equal(read_pixels(tmp_path / "a.fits", band), cube[band, ::-1])


def test_fits_sums(tmp_path):
    path = tmp_path / "a.fits"
    data = STORED.tobytes() + bytes(2880 - STORED.nbytes)
    words = np.frombuffer(data, ">u4").astype(object)
    total = int(words.sum())
    total = (total & 0xFFFFFFFF) + (total >> 32)
    path.write_bytes(fits([*CARDS, ("DATASUM", f"'{total}'")], data))
    assert np.array_equal(read_pixels(path), STORED[::-1])
    for place in (2880, 2881, 2891, 5000):
        damaged = bytearray(path.read_bytes())
        damaged[place] ^= 4
        (tmp_path / "b.fits").write_bytes(damaged)
        with pytest.raises(FileError, match=rf"damaged: its samples sum .* DATASUM = {total}"):
            read_pixels(tmp_path / "b.fits")
    assert read_fits_header(path).length == 2880
