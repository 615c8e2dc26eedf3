"""What a small random wavefront error takes off the MTF, known by its rms alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError

MOST_RMS_WAVES = 0.18


def wavefront_factor(*, frequency_ratio: ArrayLike, rms_waves: ArrayLike) -> NDArray[np.float64]:
    """Shannon's aberration transfer factor.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff, 0 to 1; beyond there is no contrast left.
    rms_waves : array_like
        Wavefront error over the pupil [waves rms], 0 to 0.18; broadcasts.

    Returns
    -------
    ndarray
        1 − (W/0.18)²·(1 − 4(ν − 1/2)²), least at half the cutoff.

    Raises
    ------
    ParameterError
        For an error out of range: beyond 0.18 waves the form gives negative contrast.

    Notes
    -----
    Source: Shannon 1994, "Optical specifications", in Handbook of Optics, 2nd ed., vol. I, chapter
    35. An empirical mean over aberrations of low order; a known wavefront belongs to Exit Pupils.
    """
    rms = np.asarray(rms_waves, np.float64)
    if not np.all((rms >= 0.0) & (rms <= MOST_RMS_WAVES)):
        worst = float(rms.max() if np.all(rms >= 0.0) else rms.min())
        raise ParameterError(
            "rms_wavefront_waves",
            worst,
            f"0 to {MOST_RMS_WAVES:g} waves of the shortest wavelength, within which Shannon's "
            "form holds: give a larger error to Exit Pupils",
            unit="waves",
        )
    ratio = np.minimum(np.abs(np.asarray(frequency_ratio, np.float64)), 1.0)
    return np.asarray(1.0 - (rms / MOST_RMS_WAVES) ** 2 * (1.0 - 4.0 * (ratio - 0.5) ** 2))
