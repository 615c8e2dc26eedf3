"""Diffraction of cubes of visible light, whose bands no black body of 1 K could weight."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.fft

from cube_files import write_cube
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()

SIZE = (29, 12)
INTERVAL = 0.01
OUTER_MM, INNER_MM = 60.0, 21.0


def overlap(first, second, apart):
    """Area that two discs of these radii have in common."""
    if apart <= abs(first - second):
        return np.pi * min(first, second) ** 2
    if apart >= first + second:
        return 0.0
    along = (apart**2 + first**2 - second**2) / (2 * apart)
    areas = 0.0
    for radius, cut in ((first, along), (second, apart - along)):
        angle = np.arccos(np.clip(cut / radius, -1, 1))
        areas += radius**2 * (angle - np.sin(2 * angle) / 2)
    return areas


@np.vectorize
def annulus_otf(rho, wavelength):
    """Diffraction by an annulus: what it has in common with itself, moved by λ·ρ."""
    outer, inner, apart = OUTER_MM / 2, INNER_MM / 2, rho * wavelength
    both = overlap(outer, outer, apart) + overlap(inner, inner, apart)
    return (both - 2 * overlap(outer, inner, apart)) / (np.pi * (outer**2 - inner**2))


def band_by_band(cube, wavelengths, width):
    rows, columns = SIZE
    xi = np.arange(columns) / (2 * columns * INTERVAL)
    eta = np.arange(rows) / (2 * rows * INTERVAL)
    rho = np.hypot(xi, eta[:, np.newaxis])
    return width * sum(
        scipy.fft.idctn(scipy.fft.dctn(band) * annulus_otf(rho, one))
        for band, one in zip(cube, wavelengths, strict=True)
    )


@pytest.mark.parametrize("weighting", ["photons", "energy", "uniform"])
@pytest.mark.parametrize(
    ("wavelengths", "width"),
    [([0.675], 0.045), (np.linspace(0.46, 0.89, 13), 0.02), ([1.4, 1.6, 2.0, 4.1], 0.15)],
    ids=["one band", "visible and near infrared", "short waves to medium"],
)
def test_every_band_of_reflected_light_is_blurred_at_its_own_wavelength(
    tmp_path, wavelengths, width, weighting
):
    wavelengths = np.asarray(wavelengths)
    cube = np.random.default_rng(3).uniform(5, 50, (len(wavelengths), *SIZE))
    write_cube(tmp_path, cube, wavelengths, width)
    nodes = {
        "read": (
            "read_image",
            {
                "path": "cube.img",
                "bands": "all",
                "fov_x_deg": float(np.degrees(INTERVAL * 1e-3 * SIZE[1])),
                "fov_y_deg": float(np.degrees(INTERVAL * 1e-3 * SIZE[0])),
            },
        ),
        "init": ("init_trans", {"focal_length_mm": 120.0, "f_number": 2.0}),
        "optics": ("diffraction_mtf", {"weighting": weighting, "obscuration_ratio": 0.35}),
        "back": ("back_transform", {}),
    }
    made = NodeBench(LIBRARY, tmp_path, nodes).value("back.image")
    want = band_by_band(cube, wavelengths, width)
    assert np.abs(made - want).max() <= 1e-12 * np.abs(want).max()
