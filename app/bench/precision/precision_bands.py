"""A cube through optics: time against error of few wavelengths, of all, and of one band."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table, verdict
from app.bench.measuring.spectral_chain import (
    APERTURE_MM,
    HIGH_UM,
    INTERVAL_MRAD,
    LOW_UM,
    SpectralChain,
    wavelengths_um,
    write_cube,
)
from app.bench.measuring.timing import paired, round_trip
from core.evaluation.policy import Policy

Array = NDArray[Any]
_BANDS = 60
_REACH_T0, _REACH_ERROR = 6.0, 1e-5
_TOLERANCES = (1e-2, 2e-3, 2e-5)
_HEADS = {
    "way": "way",
    "wavelengths": "wavelengths",
    "bound": "bound",
    "error": "error of range",
    "cube_t0": "cube, T0",
    "t0": "behind it, T0",
    "choice_t0": "choice, T0",
    "reach": "reach",
    "verdict": "",
}


def bands(settings: Settings) -> list[Table]:
    """Sixty bands through diffraction: exact, few wavelengths, one, and one band in three ways."""
    size = settings.small
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        cube = write_cube(folder, size, _BANDS)
        truth = _band_by_band(cube)
        t0 = round_trip(np.ascontiguousarray(cube[0]), Policy().workers)
        pairs = 3 if settings.quick else 9
        ways: list[tuple[str, float | None]] = [
            ("every band", 0.0),
            *((f"tolerance {tolerance:g}", tolerance) for tolerance in _TOLERANCES),
            ("as it is used", None),
        ]
        for way, tolerance in ways:
            chain = SpectralChain(folder, size, Policy("single", tolerance))
            rank = chain.rank()
            assert rank is not None
            timing = paired(chain.behind_the_cube, t0, pairs=pairs, warm_up=1)
            error = _error(chain.picture(), truth)
            is_met = _REACH_T0 if tolerance == _TOLERANCES[1] else None
            rows.append(
                {
                    "way": way,
                    "wavelengths": len(rank.chosen),
                    "bound": rank.bound,
                    "error": error,
                    "cube_t0": paired(chain.over_the_cube, t0, pairs=pairs, warm_up=1).ratio,
                    **timing.facts(),
                    "choice_t0": paired(chain.choice, t0, pairs=3, warm_up=1).ratio,
                    "reach": is_met,
                    "verdict": "" if is_met is None else _verdict(timing.ratio, error),
                }
            )
        one_band: dict[str, dict[str, Any]] = {
            "one band, its middle": {"wavelengths": 1},
            "one band, uniform weights": {"weighting": "uniform"},
            "one band, photons of its mean": {},
        }
        for way, optics in one_band.items():
            chain = SpectralChain(folder, size, Policy("single"), bands="one", **optics)
            error = _error(chain.picture(), truth)
            timing = paired(chain.behind_the_cube, t0, pairs=pairs, warm_up=1)
            rows.append({"way": way, "error": error, **timing.facts()})
    text = (
        f"{_BANDS} bands from {LOW_UM:g} to {HIGH_UM:g} µm in a file, five materials, an aperture "
        f"of {APERTURE_MM:g} mm, single precision. T0 is a round trip of one band. The cube is "
        "read in one pass, then as many transforms are made as there are wavelengths, and one "
        "back; their choice depends on the optics alone and is kept. The bound is of the rms of "
        "every band's contrast; the truth filters band by band in double precision. Of one band "
        "the spectrum is that of one wavelength, or of a black body, for the whole picture."
    )
    title = f"A cube of {_BANDS} bands through optics, {size}²"
    chart = Chart("t0", "error", "time (T0)", "error of range", "way")
    return [Table("bands", title, _HEADS, tuple(rows), text, chart)]


def _verdict(t0: float, error: float) -> str:
    if error > _REACH_ERROR:
        return f"missed: error {error:.1g}"
    return verdict(t0, _REACH_T0, None)


def _error(picture: Array, truth: Array) -> float:
    return float(np.abs(picture - truth).max() / np.ptp(truth))


def _band_by_band(cube: Array) -> Array:
    """Every band by a cosine transform of its own, with a disc's OTF (Goodman 2005, eq. 6-32)."""
    count, rows, columns = cube.shape
    xi = np.arange(columns) / (2 * columns * INTERVAL_MRAD)
    eta = np.arange(rows) / (2 * rows * INTERVAL_MRAD)
    rho = np.hypot(xi, eta[:, np.newaxis])
    total = np.zeros((rows, columns))
    for band, wavelength in zip(cube, wavelengths_um(count), strict=True):
        ratio = np.minimum(rho * wavelength / APERTURE_MM, 1.0)
        otf = 2.0 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1.0 - ratio**2))
        total += scipy.fft.idctn(scipy.fft.dctn(band.astype(float)) * otf)
    return np.asarray(total * ((HIGH_UM - LOW_UM) / count))


MEASURES = (bands,)
