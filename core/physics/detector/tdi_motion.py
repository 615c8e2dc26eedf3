"""Time delay and integration: charge that follows a moving image in steps, and not quite.

In a stage, of one pitch, the charge moves in as many steps as the clock has phases; between them it
stands while the image moves on. In units of the step s = pitch/phases the image is, at the share u
of step k, m·k + (1 + m)·u ahead of its charge, for an image faster by the share m. The mean over
all steps is a smear of one step and a sum over shifted exposures:

    sinc((1 + m)·s·f) · sin(πNm·s·f)/(N·sin(πm·s·f)),   N = stages·phases.

Sources: Wong, Yao and Schlig 1992, TDI charge-coupled devices: design and applications, IBM J. Res.
Develop. 36 (discrete charge motion, velocity mismatch); Holst and Lomheim 2007, CMOS/CCD Sensors
and Camera Systems, chapter 10.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import finite, positive
from core.physics.numerics.sinc import sinc


def tdi_mtf(
    *,
    frequency: ArrayLike,
    pitch_mrad: float,
    stages: int,
    phases: int,
    velocity_mismatch: float,
) -> NDArray[np.float64]:
    """MTF of the motion between image and charge, about its mean place.

    Parameters
    ----------
    frequency : array_like
        Along the motion, cycles/mrad.
    pitch_mrad : float
        Of the stages.
    stages : int
        1 or more.
    phases : int
        Steps of the charge in a stage; 0: it moves without steps.
    velocity_mismatch : float
        Velocity of the image over that of the charge, less 1; above −1.

    Returns
    -------
    ndarray of float64
        Signed.

    Raises
    ------
    ParameterError
        When a value is out of range.
    """
    pitch = positive("pitch", pitch_mrad, unit="mrad")
    if not stages >= 1:
        raise ParameterError("stages", stages, "1 or more")
    if not phases >= 0:
        raise ParameterError("phases", phases, "0 or more")
    mismatch = finite("velocity_mismatch", velocity_mismatch)
    if not mismatch > -1.0:
        raise ParameterError("velocity_mismatch", mismatch, "above -1")
    place = np.asarray(frequency, np.float64)
    if phases == 0:
        return np.asarray(sinc(stages * mismatch * pitch * place))
    step = pitch / phases
    smear = sinc((1.0 + mismatch) * step * place)
    return np.asarray(smear * _mean_of_shifts(mismatch * step * place, stages * phases))


def _mean_of_shifts(turns: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """sin(πnt)/(n·sin(πt)), with all digits where sin(πt) is next to 0."""
    whole = np.rint(turns)
    rest = turns - whole
    odd = (count % 2 == 0) & (whole % 2 != 0)
    return np.where(odd, -1.0, 1.0) * sinc(count * rest) / sinc(rest)


def smear_mrad(
    *, pitch_mrad: float, stages: int, phases: int, velocity_mismatch: float
) -> tuple[float, float]:
    """Smear of one step of the charge, and how far image and charge part over all stages.

    Parameters
    ----------
    pitch_mrad, stages, phases, velocity_mismatch
        As in `tdi_mtf`.

    Returns
    -------
    (float, float)
        In mrad; the second has the sign of the mismatch.
    """
    pitch = positive("pitch", pitch_mrad, unit="mrad")
    step = (1.0 + velocity_mismatch) * pitch / phases if phases else 0.0
    return step, stages * velocity_mismatch * pitch
