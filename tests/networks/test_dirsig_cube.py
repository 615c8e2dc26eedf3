"""The shipped cube: what it is made of, and what the network makes of it, by hand."""

import csv
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from child_process import ROOT
from node_bench import shipped_bench
from planck_truth import band_radiance

ROWS, COLUMNS, BANDS = 160, 192, 16
LOW_UM, HIGH_UM = 3.0, 5.0
LIGHT = {
    "temperature_K": 293.15,
    "delta_K": 6.0,
    "emissivity": "spectra",
    "sun_elevation_deg": 40.0,
}
UNIT_PER_W = 1000.0
HEADER = """ENVI
description = {{Imagechain's Test Scene by day, stored as DIRSIG stores its scenes}}
samples = {columns}
lines = {rows}
bands = {bands}
header offset = 0
file type = ENVI Standard
data type = 12
interleave = bip
byte order = 0
data units = mW/m^2/sr/um
wavelength units = Micrometers
wavelength = {{{centres}}}
fwhm = {{{widths}}}
"""


def samples():
    """Milliwatts, (rows, columns, bands), as they are stored."""
    from nodes.scenes.draw import draw_shares, scene_spectra, show_radiances
    from nodes.scenes.scene_canvas import Canvas

    shares = draw_shares("dormitory", Canvas(COLUMNS, ROWS, np.float64))
    spectra = scene_spectra(
        kind="dormitory", cut_on_um=LOW_UM, cut_off_um=HIGH_UM, bands=BANDS, **LIGHT
    )
    bands = [
        show_radiances(shares, {name: values[band] for name, values in spectra.items()})
        for band in range(BANDS)
    ]
    return np.rint(UNIT_PER_W * np.stack(bands, axis=2)).astype("<u2")


def header():
    """The text of the header."""
    width = (HIGH_UM - LOW_UM) / BANDS
    centres = [f"{LOW_UM + (band + 0.5) * width:g}" for band in range(BANDS)]
    return HEADER.format(
        rows=ROWS,
        columns=COLUMNS,
        bands=BANDS,
        centres=", ".join(centres),
        widths=", ".join([f"{width:g}"] * BANDS),
    )


def main(folder):
    """Write both files."""
    samples().tofile(folder / "scene.img")
    (folder / "scene.img.hdr").write_text(header(), encoding="utf-8")


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
    main(Path(sys.argv[1]))


FOLDER = ROOT / "networks" / "cubes"
EDGES_UM = np.linspace(3.0, 5.0, BANDS + 1)
PHOTON_J_UM = 6.62607015e-34 * 299792458.0 * 1e6


@pytest.fixture(scope="module")
def stored():
    """W/m²/sr/µm, (rows, columns, bands)."""
    numbers = np.fromfile(FOLDER / "scene.img", "<u2").reshape(ROWS, COLUMNS, BANDS)
    return numbers.astype(float) / 1000.0


@pytest.fixture(scope="module")
def network():
    bench = shipped_bench("dirsig_cube", tolerance=0.0)
    assert bench.plan.errors() == []
    return bench


def test_the_file_is_what_the_script_makes(stored):
    made = samples().astype(float) / 1000.0
    # Another processor rounds a few halves the other way.
    assert np.abs(made - stored).max() <= 1.001e-3
    assert np.mean(made != stored) < 1e-3
    assert (FOLDER / "scene.img.hdr").read_text(encoding="utf-8") == header()
    assert 0.01 < stored.min() < stored.max() < 65.0


def test_the_picture_is_the_integral_of_the_cube(network, stored):
    made = network.value("scene.image")
    np.testing.assert_allclose(made, 0.125 * stored.sum(axis=2), rtol=1e-12)


@pytest.fixture(scope="module")
def transmission():
    """Mean of the path's in every band, by a fine sum."""
    lines = (FOLDER / "air_4km.csv").read_text(encoding="utf-8").splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))[1:]
    wavelengths, values = np.array(rows, float).T
    fine = [np.linspace(low, high, 4001) for low, high in pairwise(EDGES_UM)]
    return np.array([np.interp(one, wavelengths, values).mean() for one in fine])


def test_pixels_count_the_photons_of_every_band(network, stored, transmission):
    """QE·A·Ω·t·Σ τ·(τ_air·L + (1 − τ_air)·L(293.15 K))·λ/hc: 0.5 % for where in a band light is."""
    made = network.readouts("focal_plane")
    centres = (EDGES_UM[1:] + EDGES_UM[:-1]) / 2
    air = np.array([band_radiance(low, high, 293.15) for low, high in pairwise(EDGES_UM)])
    light = transmission * 0.125 * stored.mean(axis=(0, 1)) + (1 - transmission) * air
    photons = np.sum(light * centres / PHOTON_J_UM)
    area, solid_angle = (15e-6) ** 2 * 0.95**2, np.pi / (4 * 4.0**2 + 1)
    electrons = 0.7 * area * solid_angle * 0.016 * 0.8 * photons
    assert made["signal_e"] == pytest.approx(electrons, rel=5e-3)
    assert 30 < made["well_fill_percent"] < 60
    assert made["photon_weighting"] == "spectrum"
