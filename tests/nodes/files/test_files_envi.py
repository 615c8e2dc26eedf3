import tracemalloc
from itertools import product

import numpy as np
import pytest

from core.errors import FileError
from nodes.files import envi
from nodes.files.envi import weighted_sums
from nodes.files.formats import read_info, read_pixels

ROWS, COLUMNS, BANDS = 5, 7, 3
TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4", 14: "i8", 15: "u8"}
AXES = {"bsq": (2, 0, 1), "bil": (0, 2, 1), "bip": (0, 1, 2)}


def cube(code):
    """Different in every sample, reaching the ends of the type, exact in double precision."""
    kind = np.dtype(TYPES[code])
    values = np.arange(ROWS * COLUMNS * BANDS, dtype=np.int64).reshape(ROWS, COLUMNS, BANDS)
    if kind.kind == "f":
        return (values / 7 - 3).astype(kind)
    values = values.astype(kind)
    values[0, 0, 0] = np.iinfo(kind).min
    values[-1, -1, -1] = min(np.iinfo(kind).max, 2**53)
    return values


def write(
    folder,
    code=5,
    interleave="bip",
    order=0,
    offset=0,
    name="x.img.hdr",
    extra="",
    drop=(),
    **changed,
):
    """Write an ENVI pair from scratch; `changed` replaces header fields, `drop` leaves them out."""
    samples = cube(code).transpose(AXES[interleave])
    swapped = samples.astype(samples.dtype.newbyteorder("<>"[order]))
    data = folder / "x.img"
    data.write_bytes(b"\xa5" * offset + swapped.tobytes())
    fields = {
        "description": "{made up}",
        "samples": COLUMNS,
        "lines": ROWS,
        "bands": BANDS,
        "header offset": offset,
        "file type": "ENVI Standard",
        "data type": code,
        "interleave": interleave,
        "byte order": order,
    }
    fields |= {key.replace("_", " ").strip(): value for key, value in changed.items()}
    lines = [f"{key} = {value}" for key, value in fields.items() if key not in drop]
    (folder / name).write_text("\n".join(["ENVI", *lines, extra]), encoding="utf-8")
    return data


@pytest.mark.parametrize(("code", "interleave"), list(product(TYPES, AXES)))
def test_every_layout_reads_bit_for_bit(tmp_path, code, interleave):
    for order, offset, name in product((0, 1), (0, 13), ("x.img.hdr", "x.hdr")):
        folder = tmp_path / f"{order}{offset}{name}"
        folder.mkdir()
        data = write(folder, code, interleave, order, offset, name)
        truth = cube(code)
        wanted = np.float64 if code in (3, 5, 13, 14, 15) else np.float32
        for path, band in product((data, folder / name), range(BANDS)):
            read = envi.read_band(path, band)
            assert read.dtype == wanted
            assert read.dtype.isnative
            assert read.flags.c_contiguous
            assert type(read) is np.ndarray
            assert np.array_equal(read, truth[:, :, band].astype(wanted))
        info = envi.read_info(data)
        assert (info.rows, info.columns, info.bands) == (ROWS, COLUMNS, BANDS)
        assert (info.dtype, info.kind) == (truth.dtype.name, "envi")


def test_one_band_of_a_large_file_takes_the_memory_of_one_band(tmp_path):
    data = tmp_path / "x.img"
    with data.open("wb") as file:
        file.truncate(100 * 100 * 100_000 * 4)  # 4 GB on paper, nothing on the disk
    (tmp_path / "x.hdr").write_text(
        "ENVI\nsamples = 100\nlines = 100\nbands = 100000\ndata type = 4\n"
        "interleave = bsq\nbyte order = 0\n"
    )
    tracemalloc.start()
    assert not envi.read_band(data, 99_999).any()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000


@pytest.mark.parametrize("key", ["samples", "lines", "bands", "data type", "interleave"])
def test_missing_field(tmp_path, key):
    data = write(tmp_path, drop=(key,))
    with pytest.raises(FileError, match=rf"x\.img\.hdr: the field '{key}' is missing; allowed"):
        envi.read_info(data)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("samples", "-7", "samples = -7; allowed: a whole number of 1 or more"),
        ("lines", "0", "lines = 0; allowed"),
        ("lines", "5.0", "lines = 5.0; allowed"),
        ("bands", "many", "bands = many; allowed"),
        ("bands", "{3}", "is a list"),
        ("bands", "9" * 40, "bands = 9999"),
        ("header_offset", "-1", "header offset = -1; allowed: a whole number of 0 or more"),
        ("data_type", "7", "data type = 7; allowed: 1, 2, 3, 4, 5, 12, 13, 14, 15"),
        ("data_type", "6", "data type = 6 is complex"),
        ("data_type", "9", "data type = 9 is complex"),
        ("interleave_", "tiled", "interleave = tiled; allowed: bsq, bil, bip"),
        ("byte_order", "2", "byte order = 2; allowed"),
        ("file_compression", "1", "file compression = 1"),
        ("file_type", "ENVI Spectral Library", "Spectral Library; allowed"),
        ("major_frame_offsets", "{0, 4}", "major frame offsets"),
        (
            "wavelength",
            "{1, 2}",
            "wavelength has 2 values for 3 bands; allowed: one value per band",
        ),
        ("wavelength", "{1, 2, x}", "wavelength contains a value that is not a number"),
        ("fwhm", "{1, 2, -1}", "fwhm of band 2 = -1; allowed: positive"),
        ("fov", "wide", "fov = 'wide' is not a positive number"),
        ("fov", "190", "field of view 190 deg; allowed: above 0 and below 180"),
        ("focal_length", "-38", "focal length = '-38'"),
    ],
)
def test_bad_field(tmp_path, field, value, message):
    data = write(tmp_path, **{field: value})
    with pytest.raises(FileError, match=message) as caught:
        envi.read_info(data)
    assert "\n" not in caught.value.message
    with pytest.raises(FileError):
        read_pixels(data)


def test_truncated_and_oversized(tmp_path):
    data = write(tmp_path)
    whole = data.read_bytes()
    data.write_bytes(whole[:-3])
    with pytest.raises(
        FileError,
        match=r"contains 837 bytes, but x\.img\.hdr gives header offset 0 \+ lines 5 × samples 7 × "
        r"bands 3 × 8 bytes = 840 \(3 missing\); the file is truncated",
    ):
        envi.read_band(data)
    data.write_bytes(whole + b"12345")
    with pytest.raises(
        FileError, match=r"\(5 too many\); the size would fit with header offset = 5"
    ):
        envi.read_band(data)
    data.write_bytes(b"")
    with pytest.raises(FileError, match="file is empty"):
        envi.read_band(data)


def test_header_that_is_none(tmp_path):
    data = write(tmp_path)
    header = tmp_path / "x.img.hdr"
    text = header.read_text()
    header.write_text(text.replace("ENVI", "#ENV", 1))
    with pytest.raises(FileError, match="header is missing"):
        envi.read_info(data)
    with pytest.raises(FileError, match="not an ENVI header"):
        envi.read_info(header)
    header.write_bytes(text.encode() + b"\0\1")
    with pytest.raises(FileError, match="not an ENVI header"):
        envi.read_info(data)
    header.write_text(text + "\nwavelength = {1,\n 2,\n 3\n")
    with pytest.raises(FileError, match="the brace opened after 'wavelength' is never closed"):
        envi.read_info(data)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: (
            text.replace("samples", "Samples").replace("interleave", "INTERLEAVE").encode()
        ),
        lambda text: text.replace("made up", "23.8° µm").encode("latin-1"),
        lambda text: text.replace("made up", "23.8° µm").encode(),
        lambda text: text.encode("utf-8-sig"),
        lambda text: text.replace("\n", "\r\n").encode(),
        lambda text: text.replace("= bip", "= BIP").encode(),
        lambda text: text.replace("{made up}", "{\n made = up,\n Samples = 9}").encode(),
        lambda text: (text + "\n; a comment {\n\nband names = {A,\n B,\n C}\n").encode(),
    ],
)
def test_headers_as_others_write_them(tmp_path, change):
    data = write(tmp_path)
    header = tmp_path / "x.img.hdr"
    header.write_bytes(change(header.read_text()))
    assert np.array_equal(envi.read_band(data, 2), cube(5)[:, :, 2])


def test_names_of_data_files(tmp_path):
    data = write(tmp_path, name="x.hdr")
    for name in ("x", "x.dat", "x.BSQ"):
        data = data.rename(tmp_path / name)
        assert envi.read_info(tmp_path / "x.hdr").path == data
        assert np.array_equal(read_pixels(data, 1), cube(5)[:, :, 1])


def test_what_the_header_says(tmp_path):
    data = write(
        tmp_path,
        wavelength="{8000, 9000, 10000}",
        fwhm="{100, 200, 300}",
        wavelength_units="Nanometers",
        data_units="W/cm^2/sr/um",
        fov="{23.8, 17.9}",
        focal_length="3.8 cm",
    )
    info = envi.read_info(data)
    assert info.wavelengths_um == pytest.approx((8, 9, 10), rel=1e-15)
    assert info.fwhm_um == pytest.approx((0.1, 0.2, 0.3), rel=1e-15)
    assert (info.unit, info.fov_x_deg, info.fov_y_deg) == ("W/cm^2/sr/um", 23.8, 17.9)
    assert info.focal_length_mm == pytest.approx(38, rel=1e-15)


def test_angle_in_mrad(tmp_path):
    info = envi.read_info(write(tmp_path, fov_x="100 mrad", fov_y="0"))
    assert info.fov_x_deg == pytest.approx(np.degrees(0.1), rel=1e-15)
    assert info.fov_y_deg is None


@pytest.mark.parametrize("units", [{}, {"wavelength_units": ""}])
def test_wavelengths_without_their_unit(tmp_path, units):
    info = envi.read_info(write(tmp_path, wavelength="{8, 9, 14.5}", **units))
    assert info.wavelengths_um == (8, 9, 14.5)
    assert info.wavelengths_assumed
    nanometres = write(tmp_path, wavelength="{99, 450, 550}", **units)
    with pytest.raises(
        FileError, match=r"wavelengths up to 550 without wavelength units.*Nanometers"
    ):
        envi.read_info(nanometres)
    named = envi.read_info(write(tmp_path, wavelength="{8, 9, 14.5}", wavelength_units="um"))
    assert not named.wavelengths_assumed


def test_wavenumbers(tmp_path):
    changed = {"wavelength": "{1250, 1000, 2000}", "wavelength_units": "Wavenumber"}
    info = envi.read_info(write(tmp_path, **changed))
    assert info.wavelengths_um == (8, 10, 5)
    info = envi.read_info(write(tmp_path, **(changed | {"wavelength_units": "Index"})))
    assert info.wavelengths_um is None


@pytest.mark.parametrize(
    ("code", "value", "count"),
    [(2, "3", 1), (1, "-9999", 0), (4, "-3", 1), (5, "1e400", 0), (15, "4", 1), (2, "3.5", 0)],
)
def test_samples_the_header_calls_missing(tmp_path, code, value, count):
    data = write(tmp_path, code, data_ignore_value=value)
    stored = cube(code)
    is_missing = stored.astype(np.float64) == float(value)
    assert is_missing.sum() == count
    read = np.stack([envi.read_band(data, band) for band in range(3)], axis=2)
    assert np.array_equal(np.isnan(read), is_missing)
    assert np.array_equal(read[~is_missing], stored[~is_missing])


@pytest.mark.parametrize("code", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("interleave", ["bsq", "bil", "bip"])
def test_gains_and_offsets_of_the_header_are_applied(tmp_path, code, interleave):
    stored = cube(code).astype(np.float64)
    missing = cube(code)[1, 2, 0]
    extra = "data gain values = {2, 1, 0.5}\ndata offset values = {0, 0, -3}\n"
    extra += f"data ignore value = {missing}"
    data = write(tmp_path, code=code, interleave=interleave, extra=extra)
    truth = np.where(stored == missing, np.nan, stored * [2, 1, 0.5] + [0, 0, -3])
    info = read_info(data)
    assert np.dtype(info.dtype).kind == "f"
    for band in range(3):
        read = read_pixels(data, band)
        assert read.dtype == info.dtype
        np.testing.assert_allclose(read, truth[:, :, band], rtol=1e-6)
    layout = envi.read_layout(data)
    sums = weighted_sums(layout, np.array([[1.0, 2.0, 3.0]]), dtype=np.dtype(np.float64))
    np.testing.assert_allclose(sums[0], truth @ [1.0, 2.0, 3.0], rtol=1e-14)
    one_for_all = write(tmp_path, code=code, interleave=interleave, extra="data gain values = 3")
    np.testing.assert_allclose(read_pixels(one_for_all, 1), 3 * stored[:, :, 1], rtol=1e-6)


@pytest.mark.parametrize("text", ["{1, 2}", "{1, 2, x}", "{1, 2, nan}", "{1, 2, 1e999}"])
def test_gains_that_are_no_numbers_are_refused(tmp_path, text):
    with pytest.raises(FileError, match=r"x.img.hdr: data gain values (has 2|contains)"):
        read_info(write(tmp_path, extra=f"data gain values = {text}"))


@pytest.mark.parametrize(
    ("extra", "named"),
    [
        ("reflectance scale factor = 10000", ("reflectance scale factor",)),
        ("reflectance scale factor = 1.0", ()),
        ("data gain values = {1, 1, 1}\ndata offset values = {0, 0, 0}", ()),
        ("", ()),
    ],
)
def test_what_would_change_the_samples_is_named(tmp_path, extra, named):
    data = write(tmp_path, extra=extra)
    assert read_info(data).not_applied == named
    assert read_info(data).dtype == "float64"
    np.testing.assert_array_equal(read_pixels(data, 1), cube(5)[:, :, 1])
