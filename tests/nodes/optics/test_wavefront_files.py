"""Wavefront maps of files on pupils: against the same Zernike polynomials typed in."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from core.physics.optics.pupil_shapes import PupilShape, sample_pupil, support_circle
from node_bench import NodeBench
from nodes.library import standard_library
from picture_samples import fits as fits_of

SIZE, RADIUS = 128, 40.0
WAVELENGTH_UM, SIZE_CM = 10.0, 2.56
SCENE = {"kind": "uniform", "width": 32, "height": 32, "fov_x_deg": 3.0, "fov_y_deg": 3.0}
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
                "cut_on_um": WAVELENGTH_UM,
                "cut_off_um": WAVELENGTH_UM,
                "size_x_cm": SIZE_CM,
                "size_y_cm": SIZE_CM,
                **optics,
            },
        ),
    }
    return NodeBench(standard_library(), folder, nodes)


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
    expected = 2 * np.pi * 0.5 * WAVELENGTH_UM * 2 * interval / radius_mm
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
        ("a.txt", b"1 2 3\n4 five 6\n", "line 2: must be 3 numbers"),
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
