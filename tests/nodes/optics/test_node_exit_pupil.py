"""Exit pupils: files, wavefronts and bands."""

import struct

import numpy as np
import pytest
from scipy.integrate import quad

from core.evaluation.work import Policy
from core.physics.optics.pupil_shapes import PupilShape, sample_pupil, support_circle
from cube_files import C2_UM, centres, disc_otf, materials_cube, write_cube
from node_bench import NodeBench, fov_of
from picture_samples import fits as fits_of

SIZE, RADIUS = 128, 40.0
WAVELENGTH, SIZE_CM = 10.0, 2.56
SCENE = {"kind": "uniform", "width": 32, "height": 32, "fov_x_deg": 3.0, "fov_y_deg": 3.0}


def defocused_disc(lag, w20):
    """Overlap of two unit discs `lag` apart, of phases 2π·W20·ρ²: one integral across them."""
    if lag >= 2:
        return 0.0
    end = 1 - lag / 2
    return 2 / np.pi * quad(
        lambda x: np.sqrt(max(1 - (abs(x) + lag / 2) ** 2, 0)) * np.cos(4 * np.pi * w20 * lag * x),
        -end, end, points=[0.0], epsabs=1e-10, limit=400,
    )[0]  # fmt: skip


def mtf(folder, pupil):
    """MTF, and the frequencies across that are below the cutoff."""
    bench = planned(folder, pupil)
    assert bench.plan.errors() == []
    return bench.value("optics.mtf")


def saved(folder, shape="clear", shift=(0, 0), size=SIZE):
    samples = sample_pupil(PupilShape(shape, radius=RADIUS), rows=SIZE, columns=SIZE)
    array = np.zeros((size, size))
    array[:SIZE, :SIZE] = samples
    np.save(folder / "pupil.npy", np.roll(array, shift, axis=(0, 1)))
    return {"shape": "file", "path": "pupil.npy"}


def truth(w20):
    """At the image's frequencies across: lags λ·xi over the aperture's radius."""
    interval = np.radians(3.0) * 1000 / 32
    xi = np.arange(16) / (32 * interval)
    radius_mm = RADIUS / SIZE * SIZE_CM * 10
    return np.array([defocused_disc(WAVELENGTH * f / radius_mm, w20) for f in xi])


@pytest.mark.parametrize("w20", [0.5, -1.0, 2.0])
@pytest.mark.parametrize("shift", [(0, 0), (17, -20)])
def test_defocus_is_that_at_the_rim_of_the_aperture(tmp_path, w20, shift):
    pupil = {**saved(tmp_path, shift=shift), "defocus_waves": w20}
    expected = truth(w20)
    assert np.ptp(expected) > 0.05  # it tells
    np.testing.assert_allclose(mtf(tmp_path, pupil)[0, :16], np.abs(expected), atol=4e-3)


@pytest.mark.parametrize(
    ("pupil", "expected"),
    [
        ({"shape": "clear"}, 75.0),
        ({"shape": "cassegrain", "radius": 60.0}, 60.0),
        ({"shape": "file", "path": "pupil.npy"}, 13.0),
        ({"shape": "file", "path": "pupil.npy", "radius": 20.0}, 20.0),
    ],
)
def test_the_radius_that_was_taken_is_read_out(tmp_path, pupil, expected):
    """Two open samples, 24 across and 10 along of one another: 26 apart, off the middle."""
    array = np.zeros((64, 64))
    array[10, 8] = array[20, 32] = 1.0
    np.save(tmp_path / "pupil.npy", array)
    bench = NodeBench(tmp_path, {"pupil": ("exit_pupil", pupil)})
    assert bench.plan.nodes["pupil"].declaration.readouts[0].unit == "samples"
    assert bench.readouts("pupil") == {"aperture_radius": pytest.approx(expected, abs=1e-9)}


def test_the_amplitude_of_a_file_is_relative_to_its_largest(tmp_path):
    array = np.zeros((64, 64))
    array[20:30, 20:40], array[30:40, 20:40] = 0.5, 0.2
    np.save(tmp_path / "pupil.npy", array)
    pupil = {"shape": "file", "path": "pupil.npy"}
    bench = NodeBench(tmp_path, {"pupil": ("exit_pupil", pupil)})
    np.testing.assert_allclose(np.abs(bench.value("pupil.pupil")), 2 * array, rtol=1e-12)


Z7 = [0, 0, 0, 0, 0, 0, 0.15]


def coma(x, y):
    """Noll's Z7, √8·(3ρ³ − 2ρ)·sin θ, written out."""
    square = x * x + y * y
    return np.sqrt(8.0) * (3.0 * square - 2.0) * y


def planned(folder, pupil, **optics):
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {}),
        "pupil": ("exit_pupil", pupil),
        "optics": (
            "exit_pupil_mtf",
            {
                "cut_on_um": WAVELENGTH,
                "cut_off_um": WAVELENGTH,
                "size_x_cm": SIZE_CM,
                "size_y_cm": SIZE_CM,
                **optics,
            },
        ),
    }
    return NodeBench(folder, nodes)


def otf(folder, pupil, **optics):
    bench = planned(folder, pupil, **optics)
    assert bench.plan.errors() == []
    return bench.value("optics.mtf") * np.exp(1j * bench.value("optics.ptf"))


def refusal(folder, pupil, node="pupil", **optics):
    return planned(folder, pupil, **optics).refusal("optics.mtf", node)


def disc(shift=(0, 0)):
    samples = sample_pupil(PupilShape("clear", radius=RADIUS), rows=SIZE, columns=SIZE)
    return np.roll(samples, shift, axis=(0, 1))


def on_support(samples):
    """Z7 at the samples, on the circle round them."""
    x, y, radius = support_circle(samples)
    places = np.arange(SIZE)
    return 0.15 * coma((places[None, :] - x) / radius, (places[:, None] - y) / radius)


def fits(values):
    """A FITS picture of doubles, the last row first, with NaN where nothing is known."""
    cards = [("SIMPLE", "T"), ("BITPIX", -64), ("NAXIS", 2), ("NAXIS1", SIZE), ("NAXIS2", SIZE)]
    return fits_of(cards, values[::-1].astype(">f8").tobytes())


def zemax(values, wavelength="10.0000 µm", newline="\r\n"):
    """A listing as Zemax writes it: lines of words, then the matrix, 0 outside the pupil."""
    rows, columns = values.shape
    head = [
        "Listing of Wavefront Map Data", "", "File : C:\\lens.ZMX", "Title: ", "Date : 1/1/2026",
        "", "", "Wavefront Function", f"{wavelength} at 0.0000, 0.0000 (deg).",
        "Peak to valley = 0.8485 waves, RMS = 0.1500 waves.", "Surface: Image",
        "Exit Pupil Diameter: 1.6000E+001 Millimeters", "",
        f"Pupil grid size: {columns} by {rows}", f"Center point is: {columns // 2 + 1}, 33", "",
    ]  # fmt: skip
    body = ["\t".join(f"{value: .8E}" for value in row) for row in values]
    return (newline.join([*head, *body]) + newline).encode("utf-16")


def written(folder, samples, waves):
    """The map in every form that it can have; unknown where the pupil is dark."""
    known = np.where(samples > 0, waves, np.nan)
    np.save(folder / "opd.npy", known)
    np.savetxt(folder / "opd.txt", known)
    (folder / "opd.fits").write_bytes(fits(known))
    (folder / "zemax.txt").write_bytes(zemax(np.where(samples > 0, waves, 0.0)))
    np.save(folder / "amplitude.npy", samples)
    np.save(folder / "complex.npy", samples * np.exp(2j * np.pi * waves))


@pytest.mark.parametrize("shift", [(0, 0), (17, -20)])
@pytest.mark.parametrize(
    "of_map",
    [
        {"wavefront_path": "opd.npy"},
        {"wavefront_path": "opd.txt"},
        {"wavefront_path": "opd.fits"},
        {"wavefront_path": "zemax.txt"},
        {"path": "complex.npy", "wavefront_path": None},
    ],
    ids=lambda params: params["wavefront_path"] or "complex",
)
def test_a_map_of_noll_7_is_that_polynomial_typed_in(tmp_path, of_map, shift):
    """To rounding of the files: the radius is that of what the file holds."""
    samples = disc(shift)
    written(tmp_path, samples, on_support(samples))
    amplitude = {"shape": "file", "path": "amplitude.npy"}
    wanted = otf(tmp_path, {**amplitude, "zernike_waves": Z7})
    assert np.ptp(np.angle(wanted)) > 0.5
    got = otf(tmp_path, {**amplitude, **of_map})
    np.testing.assert_allclose(got, wanted, atol=1e-7)


@pytest.mark.parametrize(
    ("unit", "number", "wavelength_um"),
    [("waves", 0.5, 8.0), ("rad", np.pi, 8.0), ("um", 4.0, None), ("nm", 4000.0, 2.0)],
)
def test_a_map_keeps_its_path_at_another_wavelength(tmp_path, unit, number, wavelength_um):
    """Half a wave at 8 µm is 4 µm of path, 0.4 waves at 10 µm."""
    samples = disc()
    shape = on_support(samples)
    np.save(tmp_path / "amplitude.npy", samples)
    np.save(tmp_path / "opd.npy", np.where(samples > 0, number * shape, np.nan))
    pupil = {"shape": "file", "path": "amplitude.npy"}
    of_map = {"wavefront_path": "opd.npy", "wavefront_unit": unit}
    if wavelength_um:
        of_map["map_wavelength_um"] = wavelength_um
    typed = [0.4 * value for value in Z7]
    for optics in ({}, {"cut_on_um": 8.0, "cut_off_um": 12.0, "wavelengths": 3}):
        wanted = otf(tmp_path, {**pupil, "zernike_waves": typed}, **optics)
        np.testing.assert_allclose(otf(tmp_path, {**pupil, **of_map}, **optics), wanted, atol=1e-12)


def test_the_wavelength_of_a_listing_is_taken(tmp_path):
    samples = disc()
    waves = on_support(samples)
    np.save(tmp_path / "amplitude.npy", samples)
    pupil = {"shape": "file", "path": "amplitude.npy", "wavefront_path": "zemax.txt"}
    pictures = []
    for name, params in (
        ("8.0000 µm", {}),
        ("8000.0 nm", {}),
        ("10.000 µm", {"map_wavelength_um": 8.0}),
    ):
        (tmp_path / "zemax.txt").write_bytes(zemax(waves * (samples > 0), name))
        pictures.append(otf(tmp_path, {**pupil, **params}))
    typed = [0.8 * value for value in Z7]
    wanted = otf(tmp_path, {"shape": "file", "path": "amplitude.npy", "zernike_waves": typed})
    for picture in pictures:
        np.testing.assert_allclose(picture, wanted, atol=1e-7)


def test_row_0_is_at_the_top(tmp_path):
    """A tilt W = y/2 over the radius, downwards: lags s along differ by s/(2R) waves.

    Between the lags of whole samples the OTF is interpolated, which costs 1e-3 here.
    """
    samples = disc()
    y = (np.arange(SIZE) - (SIZE - 1) / 2)[:, None] / RADIUS + 0 * samples
    np.save(tmp_path / "opd.npy", np.where(samples > 0, 0.5 * y, np.nan))
    got = otf(tmp_path, {"shape": "file", "wavefront_path": "opd.npy"})
    interval = 1 / np.radians(3.0) / 1000
    radius_mm = RADIUS / SIZE * SIZE_CM * 10
    expected = 2 * np.pi * 0.5 * WAVELENGTH * 2 * interval / radius_mm
    assert np.angle(got[2, 0]) == pytest.approx(expected, rel=2e-3)
    assert np.angle(got[0, 2]) == pytest.approx(0.0, abs=1e-9)


def test_a_complex_pupil_holds_at_its_own_wavelength(tmp_path):
    samples = disc()
    written(tmp_path, samples, on_support(samples))
    pupil = {"shape": "file", "path": "complex.npy"}
    band = {"cut_on_um": 8.0, "cut_off_um": 12.0}
    for own, optics in (({}, {**band, "wavelengths": 2}), ({"map_wavelength_um": 9.0}, band)):
        message = refusal(tmp_path, {**pupil, **own}, "optics", **optics)
        assert "modulo one wave" in message
    assert otf(tmp_path, {**pupil, "map_wavelength_um": 10.0}, **band).shape == (32, 32)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.txt", b"", "the file is empty"),
        ("a.txt", b"Listing of Wavefront Map Data\n", "contains no matrix"),
        ("a.txt", b"1 2 3\n4 5\n", "line 2 has 2 numbers; allowed: 3"),
        ("a.txt", b"1 2 3\n4 five 6\n", "line 2: must contain 3 numbers"),
        ("a.txt", b"1 2 3\n4 inf 6\n", "infinite at row 1, column 1"),
        ("a.txt", b"0 0\n0 0\n", "the aperture is unknown"),
        ("a.txt", b"nan nan\nnan nan\n", "the aperture is unknown"),
        ("a.txt", b"Pupil grid size: 3 by 2\n1 2 3\n", "3 by 2 samples, but the file has 3 by 1"),
        ("a.txt", bytes(range(256)), "not a text file"),
        ("a.txt", struct.pack("<99d", *range(99)), "a.txt"),
        ("a.npy", b"\x93NUMPY\x01\0 and no more", "damaged or truncated"),
        ("a.fits", b"SIMPLE  =                    T", "a.fits"),
        ("a.txt", b"1 " * 9000 + b"\n", "9000 × 1 samples; at most 8192 on a side"),
    ],
)  # fmt: skip
def test_bad_maps_are_one_clear_line(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    message = refusal(tmp_path, {"shape": "file", "wavefront_path": name})
    assert words in message
    assert name in message
    assert len(message) < 400


def test_what_does_not_fit(tmp_path):
    np.save(tmp_path / "small.npy", np.ones((4, 4)))
    np.save(tmp_path / "wide.npy", np.ones((4, 5)))
    np.save(tmp_path / "complex.npy", np.ones((4, 4)) * 1j)
    half = np.ones((4, 4))
    half[:, 2:] = 0
    np.save(tmp_path / "left.npy", half)
    np.save(tmp_path / "right.npy", np.where(half > 0, np.nan, 1.0))
    np.save(tmp_path / "cube.npy", np.ones((2, 2, 2)) * 1j)
    np.save(tmp_path / "bands.npy", np.ones((2, 2, 3)))

    def of(path, wavefront):
        return {"shape": "file", "path": path, "wavefront_path": wavefront}

    for pupil, words in (
        (of(None, None), "needs a pupil in path, or a map in wavefront_path"),
        (of("small.npy", "wide.npy"), "small.npy is 4 × 4 samples and wide.npy 5 × 4"),
        (of("complex.npy", "small.npy"), "already contains its wavefront"),
        (of(None, "complex.npy"), "already contains its wavefront"),
        (of("left.npy", "right.npy"), "no value where the pupil transmits"),
        (of("cube.npy", None), "complex array of shape (2, 2, 2)"),
        (of(None, "bands.npy"), "bands.npy has 3 bands; a wavefront map must have one"),
        (of(None, "other.npy"), "no such file"),
    ):
        assert words in refusal(tmp_path, pupil)


CUBE_SIZE = (32, 40)
INTERVAL = 0.035
BANDS = 6
PUPIL = {"size_x": 128, "size_y": 128, "radius": 50}


@pytest.fixture
def cube(tmp_path):
    wavelengths, width = centres(BANDS)
    samples = materials_cube(CUBE_SIZE, wavelengths)
    write_cube(tmp_path, samples, wavelengths, width)
    return samples, wavelengths, width


def bench(folder, *, read, pupil=(), otf=()):
    nodes = {
        "read": ("read_image", {**fov_of(CUBE_SIZE, INTERVAL), **read}),
        "init": ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0}),
        "pupil": ("exit_pupil", {**PUPIL, **dict(pupil)}),
        "otf": ("exit_pupil_mtf", {"size_x_cm": 12.8, "size_y_cm": 12.8, **dict(otf)}),
        "back": ("back_transform", {}),
    }
    return NodeBench(folder, nodes)


def delivered(there):
    work = there.engine.work(Policy("double", 0.0))
    return there.engine.value(there.plan, "back.image", work)


ALL = {"path": "cube.img", "bands": "all"}


@pytest.mark.parametrize(
    "pupil", [{"defocus_waves": 0.4}, {"zernike_waves": (0, 0, 0, 0, 0, 0, 0.12, 0.05)}]
)
def test_a_wavefront_error_counts_by_the_waves_of_every_band(tmp_path, cube, pupil):
    """The same as the sum of pictures of one band, whose waves are those of the whole band."""
    made = delivered(bench(tmp_path, read=ALL, pupil=pupil))
    samples, wavelengths, width = cube
    middle = 4.0
    want = 0.0
    for band, wavelength in zip(samples, wavelengths, strict=True):
        np.save(tmp_path / "one.npy", band)
        scaled = {
            name: value * middle / wavelength
            if np.isscalar(value)
            else tuple(one * middle / wavelength for one in value)
            for name, value in pupil.items()
        }
        at = {"cut_on_um": float(wavelength), "cut_off_um": float(wavelength)}
        one = bench(tmp_path, read={"path": "one.npy"}, pupil=scaled, otf=at)
        want = want + width * delivered(one)
    assert np.abs(made - want).max() <= 1e-11 * np.ptp(want)


@pytest.mark.parametrize(("weighting", "power"), [("photons", 4), ("energy", 5)])
def test_wavelengths_of_one_band_count_by_the_light_of_a_body(tmp_path, weighting, power):
    np.save(tmp_path / "flat.npy", np.ones(CUBE_SIZE))
    there = bench(
        tmp_path,
        read={"path": "flat.npy", "cut_on_um": 3.0, "cut_off_um": 5.0},
        otf={"wavelengths": 24, "weighting": weighting, "source_K": 300.0},
    )
    mtf = there.value("otf.mtf")
    um = 3.0 + 2.0 * (np.arange(20000) + 0.5) / 20000
    light = um**-power / np.expm1(C2_UM / um / 300.0)
    row = np.asarray(mtf)[0] if np.asarray(mtf)[0, 0] == 1.0 else None
    frequency = there.port("otf.mtf").grid.xi()
    at = 5
    want = np.sum(light * disc_otf(frequency[at], um, 100.0)) / light.sum()
    measured = (
        row[at] if row is not None else np.asarray(mtf)[CUBE_SIZE[0] // 2, CUBE_SIZE[1] // 2 + at]
    )
    assert measured == pytest.approx(want, abs=1e-6)
