"""Spectral cubes for tests: written as ENVI files, and filtered band by band."""

import numpy as np
import scipy.fft

C1_UM = 1.191042972397188e8  # W µm⁴ m⁻² sr⁻¹: 2hc²
C2_UM = 1.438776877503933e4  # µm K: hc/k
PHOTON_J_UM = 6.62607015e-34 * 299792458.0 * 1e6

ORDERS = {"bsq": (0, 1, 2), "bil": (1, 0, 2), "bip": (1, 2, 0)}
TYPES = {"f4": 4, "f8": 5, "u2": 12}


def centres(count, *, low=3.0, high=5.0):
    """Middles of bands that fill an interval, and their width."""
    width = (high - low) / count
    return low + (np.arange(count) + 0.5) * width, width


def materials_cube(size, wavelengths, *, seed=1):
    """Five materials in blocks, with emissivities that ripple and temperatures that differ."""
    drawn = np.random.default_rng(seed)
    rows, columns = size
    planck = [
        C1_UM / wavelengths**5 / np.expm1(C2_UM / wavelengths / kelvin)
        for kelvin in (280.0, 300.0, 310.0, 290.0, 320.0)
    ]
    spectra = np.array(
        [
            np.clip(0.85 + 0.15 * np.sin(wavelengths * (3 + k)), 0, 1) * one
            for k, one in enumerate(planck)
        ]
    )
    blocks = drawn.integers(0, 5, (rows // 8 + 1, columns // 8 + 1))
    places = np.kron(blocks, np.ones((8, 8), int))[:rows, :columns]
    return spectra[places].transpose(2, 0, 1) * (1 + 0.05 * drawn.standard_normal(size))


def write_cube(
    folder, cube, wavelengths, width, *, unit="W/m^2/sr/um", order="bsq", kind="f8", extra=()
):
    """Write (bands, rows, columns) as cube.img with its header."""
    bands, rows, columns = cube.shape
    path = folder / "cube.img"
    cube.transpose(ORDERS[order]).astype(f"<{kind}").tofile(path)
    lines = [
        "ENVI",
        f"samples = {columns}",
        f"lines = {rows}",
        f"bands = {bands}",
        "header offset = 0",
        f"data type = {TYPES[kind]}",
        f"interleave = {order}",
        "byte order = 0",
        *([f"data units = {unit}"] if unit else []),
        "wavelength units = um",
        f"wavelength = {{{', '.join(repr(float(one)) for one in wavelengths)}}}",
        f"fwhm = {{{', '.join([repr(float(width))] * bands)}}}",
        *extra,
    ]
    path.with_name("cube.img.hdr").write_text("\n".join(lines) + "\n")
    return path


def disc_otf(frequency, wavelength_um, aperture_mm):
    """Diffraction by a disc: Goodman 2005, eq. 6-32."""
    ratio = np.minimum(np.abs(frequency) * wavelength_um / aperture_mm, 1.0)
    return 2.0 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1.0 - ratio**2))


def band_by_band(cube, wavelengths, weights, *, interval_mrad, aperture_mm):
    """Weighted sum of bands, each blurred by a disc at its own wavelength; edges mirrored."""
    _, rows, columns = cube.shape
    xi = np.arange(columns) / (2 * columns * interval_mrad)
    eta = np.arange(rows) / (2 * rows * interval_mrad)
    rho = np.hypot(xi, eta[:, np.newaxis])
    total = 0.0
    for band, wavelength, weight in zip(cube, wavelengths, weights, strict=True):
        spectrum = scipy.fft.dctn(band) * disc_otf(rho, wavelength, aperture_mm)
        total = total + weight * scipy.fft.idctn(spectrum)
    return total
