"""Sampling of a frame in angle and in frequency, and the footprint of a detector element."""

from __future__ import annotations

import math

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import positive, within

# Far below any optics, and so far above the least number that frequencies have squares.
LEAST_FIELD_DEG = 1e-30


def interval_mrad(*, fov_deg: float, samples: int, name: str = "fov_deg") -> float:
    """Angle from one sample to the next.

    Parameters
    ----------
    fov_deg : float
        Field of view of the whole frame along this axis, from 1e-30° and below 180°.
    samples : int
        Samples along this axis.
    name : str
        Of the parameter, for people.

    Returns
    -------
    float
        Sampling interval in mrad.

    Raises
    ------
    ParameterError
        When the field of view or the number of samples is out of range.

    Notes
    -----
    Source: Tantalo 1996, eq. 4.1: the angle itself is divided, not its tangent.
    """
    angle = positive(name, fov_deg, unit="deg")
    if not LEAST_FIELD_DEG <= angle < 180.0:
        allowed = f"at least {LEAST_FIELD_DEG:g} and below 180"
        raise ParameterError(name, fov_deg, allowed, unit="deg")
    return angle * (math.pi / 180.0) * 1000.0 / _count(samples)


def nyquist_cyc_per_mrad(*, interval_mrad: float) -> float:
    """Highest frequency the samples carry: 1/(2·interval) (Tantalo 1996, eq. 4.2).

    Parameters
    ----------
    interval_mrad : float
        Sampling interval in mrad, above zero.

    Returns
    -------
    float
        Nyquist frequency in cycles/mrad.

    Raises
    ------
    ParameterError
        When the interval is not positive and finite.
    """
    return 0.5 / positive("interval_mrad", interval_mrad, unit="mrad")


def frequency_interval_cyc_per_mrad(*, interval_mrad: float, samples: int) -> float:
    """Step from one frequency to the next: 1/(samples·interval) (Tantalo 1996, eq. 4.3).

    Parameters
    ----------
    interval_mrad : float
        Sampling interval in mrad, above zero.
    samples : int
        Samples along this axis.

    Returns
    -------
    float
        Frequency interval in cycles/mrad.

    Raises
    ------
    ParameterError
        When the interval or the number of samples is out of range.
    """
    return 1.0 / (positive("interval_mrad", interval_mrad, unit="mrad") * _count(samples))


def ifov_mrad(*, pitch_um: float, focal_length_mm: float, fill: float = 1.0) -> float:
    """Instantaneous field of view of one detector element.

    Parameters
    ----------
    pitch_um : float
        Detector pitch along this axis, above zero.
    focal_length_mm : float
        Focal length, above zero.
    fill : float
        Sensitive share of the pitch along this axis, above 0 and up to 1; 1 gives the plain IFOV,
        less the effective one.

    Returns
    -------
    float
        pitch·fill/focal length, in mrad.

    Raises
    ------
    ParameterError
        When a value is out of range.

    Notes
    -----
    Source: Tantalo 1996, eqs. 4.41-4.42 (IFOV) and 4.48 (effective IFOV).
    """
    share = positive("fill", fill)
    if share > 1.0:
        raise ParameterError("fill", fill, "above 0 and up to 1")
    pitch = positive("pitch_um", pitch_um, unit="µm")
    return pitch / positive("focal_length_mm", focal_length_mm, unit="mm") * share


def oversampling(*, pitch_um: float, focal_length_mm: float, interval_mrad: float) -> float:
    """Samples of the scene per detector pitch, along one axis; the fill does not enter.

    Parameters
    ----------
    pitch_um : float
        Detector pitch, above zero.
    focal_length_mm : float
        Focal length, above zero.
    interval_mrad : float
        Sampling interval of the scene in mrad, above zero.

    Returns
    -------
    float
        pitch/focal length/interval, without unit.

    Raises
    ------
    ParameterError
        When a value is out of range.

    Notes
    -----
    Source: Tantalo 1996, section 4.1.
    """
    footprint = ifov_mrad(pitch_um=pitch_um, focal_length_mm=focal_length_mm)
    return footprint / positive("interval_mrad", interval_mrad, unit="mrad")


def _count(samples: int) -> int:
    if within("samples", samples, 1, 2**53) != int(samples):
        raise ParameterError("samples", samples, "a whole number, 1 or above")
    return int(samples)
