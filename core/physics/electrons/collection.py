"""What a pixel collects: solid angles, and electrons per photon radiance."""

from __future__ import annotations

from math import pi

from core.physics.numerics.scalar_checks import non_negative, positive, within


def cone_sr(*, f_number: float) -> float:
    """Projected solid angle in which a pixel sees the exit pupil.

    Parameters
    ----------
    f_number : float
        Focal length over aperture, above 0.

    Returns
    -------
    float
        Ω = π/(4F² + 1), sr.

    Notes
    -----
    Source: Dereniak and Boreman 1996, Infrared Detectors and Systems, chapter 2: π·sin²θ with
    tan θ = 1/(2F).
    """
    return pi / (4.0 * positive("f_number", f_number) ** 2 + 1.0)


def housing_sr(*, f_number: float, cold_shield_efficiency: float) -> float:
    """Projected solid angle in which a pixel sees its warm housing past the cold shield.

    Parameters
    ----------
    f_number : float
        Focal length over aperture, above 0.
    cold_shield_efficiency : float
        Share of the half space outside the cone of the optics that the shield covers, 0 to 1.

    Returns
    -------
    float
        (π − Ω)(1 − η), sr.

    Notes
    -----
    Source: Dereniak and Boreman 1996, chapter 2.
    """
    efficiency = within("cold_shield_efficiency", cold_shield_efficiency, 0.0, 1.0)
    return (pi - cone_sr(f_number=f_number)) * (1.0 - efficiency)


def exposure_m2_s(
    *,
    pitch_x_um: float,
    pitch_y_um: float,
    fill_x: float,
    fill_y: float,
    integration_time_s: float,
    tdi_stages: int = 1,
) -> float:
    """Light-sensitive area times the time in which it collects, m² s.

    Parameters
    ----------
    pitch_x_um, pitch_y_um : float
        Of the pixels, above 0.
    fill_x, fill_y : float
        Share of the pitch that is sensitive, above 0, at most 1.
    integration_time_s : float
        Of one stage, above 0.
    tdi_stages : int
        Stages that add their charge, 1 or more.

    Returns
    -------
    float
        t·n·A·FF. Times a photon radiance and a solid angle it is a number of photons.

    Notes
    -----
    Source: Holst and Lomheim 2007, CMOS/CCD Sensors and Camera Systems, chapter 4.
    """
    area_m2 = (
        positive("pitch_x_um", pitch_x_um, unit="µm")
        * positive("pitch_y_um", pitch_y_um, unit="µm")
        * 1e-12
    )
    fill = positive("fill_x", fill_x) * positive("fill_y", fill_y)
    time = positive("integration_time_s", integration_time_s, unit="s")
    return area_m2 * fill * time * positive("tdi_stages", tdi_stages)


def dark_electrons(
    *, dark_current_e_per_s: float, integration_time_s: float, tdi_stages: int = 1
) -> float:
    """Electrons of the dark current in an exposure, of all its stages.

    Parameters
    ----------
    dark_current_e_per_s : float
        Of one pixel, 0 or above.
    integration_time_s, tdi_stages : float, int
        As in `exposure_m2_s`.

    Returns
    -------
    float
        i·t·n.
    """
    current = non_negative("dark_current_e_per_s", dark_current_e_per_s, unit="e/s")
    time = positive("integration_time_s", integration_time_s, unit="s")
    return current * time * positive("tdi_stages", tdi_stages)
