"""Noise of a display as the eye filters it while it looks for a sine of one frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.numerics.array_checks import all_above_zero, all_from_zero
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.numerics.scalar_checks import positive

Vector = NDArray[np.float64]
_CD_M2_OF_FOOT_LAMBERT = 3.4262590996
_NODES = 4  # of a cell of the spectrum
_CHANNEL = 2.2  # of the logarithm squared: a channel of vision is 1.6 octaves wide


def eyeball_mtf(*, frequency_cyc_per_mrad: ArrayLike, luminance_cd_m2: float) -> Vector:
    """MTF of the eye's optics, retina and tremor, both eyes' pupils as wide as the display makes.

    Parameters
    ----------
    frequency_cyc_per_mrad
        At the eye, zero or above.
    luminance_cd_m2
        Mean luminance of the display, above zero.

    Returns
    -------
    ndarray
        exp(−(43.69·u/f0)^i0)·exp(−0.375·u^1.21)·exp(−0.4441·u²), with f0 = exp(3.663 −
        0.0216·D²·ln D), i0 = (0.7155 + 0.277/√D)² and a pupil of D = −9.011 +
        13.23·exp(−lg(L/fL)/21.082) mm, 2 to 8.

    Raises
    ------
    ParameterError
        For a value out of range.

    Notes
    -----
    Source: Overington 1976, Vision and Acquisition, as Vollmerhausen and Jacobs 2004, report
    AMSEL-NV-TR-230, has it. Written down from the literature that quotes it; the coefficients could
    not be checked.
    """
    places = all_from_zero("frequency_cyc_per_mrad", frequency_cyc_per_mrad, unit="cyc/mrad")
    luminance = positive("luminance_cd_m2", luminance_cd_m2, unit="cd/m²")
    foot_lamberts = np.log10(luminance / _CD_M2_OF_FOOT_LAMBERT)
    pupil = float(np.clip(-9.011 + 13.23 * np.exp(-foot_lamberts / 21.082), 2.0, 8.0))
    f0 = np.exp(3.663 - 0.0216 * pupil**2 * np.log(pupil))
    i0 = (0.7155 + 0.277 / np.sqrt(pupil)) ** 2
    with np.errstate(under="ignore", over="ignore"):
        optics = (43.69 * places / f0) ** i0
        return np.asarray(np.exp(-optics - 0.375 * places**1.21 - 0.4441 * places**2), np.float64)


def perceived_share(
    *,
    frequency: ArrayLike,
    across_cyc_per_mrad: float,
    along_cyc_per_mrad: float,
    magnification: float,
    luminance_cd_m2: float,
    spectrum: ArrayLike | None = None,
) -> Vector:
    """Share of a noise's variance that hides a sine across, of each frequency.

    Parameters
    ----------
    frequency
        Of the sines, cycles/mrad in the scene, above zero, shape (n,).
    across_cyc_per_mrad, along_cyc_per_mrad
        Frequencies up to which the spectrum goes, above zero.
    magnification
        Angle on the display over angle in the scene, above zero.
    luminance_cd_m2
        Mean luminance of the display.
    spectrum
        Power of the noise in equal cells from 0 to these, shape (along, across); white if not
        given.

    Returns
    -------
    ndarray
        ∬ S(ξ′, η)·B²(ξ′/ξ)·E²(ξ′/M)·E²(η/M) dξ′ dη over ∬ S dξ′ dη, with the channel of vision
        B(r) = exp(−2.2·ln² r) and the eyeball's MTF E; the display is perfect. Within 1e-5: E has a
        cusp at zero.

    Raises
    ------
    ParameterError
        For a value out of range.

    Notes
    -----
    Source: Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230: the noise integrals Q_H and Q_V.
    The numbers of the equations could not be checked.
    """
    places = all_above_zero("frequency", frequency, unit="cyc/mrad")
    magnified = positive("magnification", magnification)
    power = np.ones((1, 1)) if spectrum is None else all_from_zero("spectrum", spectrum)
    if power.ndim != 2 or not power.sum() > 0.0:
        raise ParameterError("spectrum", f"an array of shape {power.shape}", "two axes, some power")
    rows, columns = power.shape
    # A white spectrum is one cell: cut finely enough for the channel's logarithm.
    finer_x, finer_y = max(1, 256 // columns), max(1, 64 // rows)
    power = np.repeat(np.repeat(power, finer_x, axis=1), finer_y, axis=0)
    x = _nodes(power.shape[1], positive("across_cyc_per_mrad", across_cyc_per_mrad))
    y = _nodes(power.shape[0], positive("along_cyc_per_mrad", along_cyc_per_mrad))
    weights = gauss_legendre(_NODES)[1] / 2.0

    def eye(points: Vector) -> Vector:
        return eyeball_mtf(
            frequency_cyc_per_mrad=points / magnified, luminance_cd_m2=luminance_cd_m2
        )

    across = (eye(y) ** 2 @ weights) @ power / power.sum()
    with np.errstate(under="ignore", over="ignore"):
        channel = np.exp(-2.0 * _CHANNEL * np.log(x / places[:, np.newaxis, np.newaxis]) ** 2)
    return np.asarray(((channel * eye(x) ** 2) @ weights) @ across, np.float64)


def _nodes(cells: int, highest: float) -> Vector:
    """Points of each of the equal cells from 0 to the highest frequency, shape (cells, nodes)."""
    nodes, _ = gauss_legendre(_NODES)
    width = highest / cells
    return np.asarray(width * (np.arange(cells)[:, np.newaxis] + (1.0 + nodes) / 2.0), np.float64)
