"""OTF of a diffraction-limited circular aperture, clear or centrally obscured."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.optics.overlap_area import annulus_overlap_fraction, disc_overlap_fraction


def annular_otf(
    *, frequency_ratio: ArrayLike, obscuration_ratio: float = 0.0
) -> NDArray[np.float64]:
    """OTF of a disc or annulus: the overlap of the aperture with itself moved.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff (aperture diameter over wavelength), of either sign.
    obscuration_ratio : float
        Inner over outer radius, 0 up to but not including 1.

    Returns
    -------
    ndarray
        Real OTF, shape of `frequency_ratio`: 1 at zero, 0 from the cutoff on.

    Raises
    ------
    ParameterError
        If the obscuration leaves no opening.
    DataError
        If a frequency is not finite.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-32 (disc); O'Neill 1956, JOSA 46,
    285 (annulus). Relative precision holds up to the cutoff, where arc cosine forms cancel.
    """
    ratio = float(obscuration_ratio)
    if not 0.0 <= ratio < 1.0:
        raise ParameterError(
            "obscuration_ratio", ratio, "0 up to but not including 1 (an opening must remain)"
        )
    v = np.abs(np.asarray(frequency_ratio, dtype=np.float64))
    if not np.all(np.isfinite(v)):
        raise DataError("frequency_ratio holds a value that is not finite")
    if ratio == 0.0:
        return disc_overlap_fraction(distance_ratio=v)
    return annulus_overlap_fraction(distance_ratio=v, obscuration_ratio=ratio)
