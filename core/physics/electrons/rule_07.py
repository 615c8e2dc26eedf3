"""Dark current of HgCdTe by the rule of thumb of 2007."""

from __future__ import annotations

import math

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import positive
from core.physics.radiometry.constants import BOLTZMANN_J_K, ELEMENTARY_CHARGE_C

_J0_A_PER_CM2 = 8367.00001853855
_EXPONENT = -1.16239134096245
_SCALE_UM = 0.200847413564122
_THRESHOLD_UM = 4.63513642316149
_POWER = 0.544071281108481
_PHOTON_EV_UM = 1.24  # as published, rounded


def rule_07_A_per_cm2(*, cutoff_um: float, detector_K: float) -> float:  # noqa: N802
    """Dark current density of good HgCdTe photodiodes.

    Parameters
    ----------
    cutoff_um : float
        Cutoff wavelength of the material at the temperature, µm, above 0.201.
    detector_K : float
        Temperature of the detector, K, above 0.

    Returns
    -------
    float
        J₀·exp(C·1.24 q/(k·λₑ·T)), A/cm². λₑ is the cutoff from 4.635 µm on, and below it
        λ/(1 − (λₛ/λ − λₛ/λₜ)^P).

    Raises
    ------
    ParameterError
        For a value out of range.

    Notes
    -----
    Within a factor of 2.5 for λ·T from 400 to 1700 µm K and 77 K and above. Source: Tennant, Lee,
    Zandian, Piquette and Carmody 2008, MBE HgCdTe technology: a very general solution to IR
    detection, described by "Rule 07", J. Electronic Materials 37, 1406.
    """
    cutoff = positive("material_cutoff_um", cutoff_um, unit="µm")
    temperature = positive("detector_K", detector_K, unit="K")
    effective = cutoff
    if cutoff < _THRESHOLD_UM:
        left = 1.0 - (_SCALE_UM / cutoff - _SCALE_UM / _THRESHOLD_UM) ** _POWER
        if left <= 0.0:
            raise ParameterError(
                "material_cutoff_um", cutoff_um, f"above {_shortest_um():.3g}", unit="µm"
            )
        effective = cutoff / left
    energy = _PHOTON_EV_UM * ELEMENTARY_CHARGE_C / (BOLTZMANN_J_K * effective * temperature)
    return _J0_A_PER_CM2 * math.exp(_EXPONENT * energy)


def rule_07_e_per_s(*, cutoff_um: float, detector_K: float, area_um2: float) -> float:
    """Electrons per second of that current through a pixel of some area, µm²."""
    density = rule_07_A_per_cm2(cutoff_um=cutoff_um, detector_K=detector_K)
    area_cm2 = positive("area_um2", area_um2, unit="µm²") * 1e-8
    return density * area_cm2 / ELEMENTARY_CHARGE_C


def _shortest_um() -> float:
    return _SCALE_UM / (1.0 + _SCALE_UM / _THRESHOLD_UM)
