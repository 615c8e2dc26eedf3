"""The figures of a photon transfer curve with their units and meanings, for all that show them."""

from __future__ import annotations

import math

from core.physics.measurement.levels.photon_transfer import EmvaFigures, PhotonTransfer

Row = tuple[str, float | None, str, str]


def transfer_rows(curve: PhotonTransfer) -> list[Row]:
    """Every figure: name, value or None, unit, meaning."""
    ratio = None
    if curve.full_well_e and curve.read_noise_e:
        ratio = curve.full_well_e / curve.read_noise_e
    return [
        ("gain_e_per_dn", curve.gain_e_per_dn, "e-/DN", "electrons of one digital number"),
        ("gain_error", curve.gain_error, "e-/DN", "its standard error"),
        ("offset_dn", curve.offset_dn, "DN", "number of no electrons"),
        ("read_noise_e", curve.read_noise_e, "e-", "temporal noise in the dark, less rounding"),
        ("read_noise_error", curve.read_noise_error, "e-", "its standard error"),
        ("full_well_e", curve.full_well_e, "e-", "level of saturation"),
        ("brightest_e", curve.brightest_e, "e-", "the brightest level"),
        ("dynamic_range_dB", _decibels(ratio), "dB", "full well over read noise"),
        ("dsnu_e", curve.dsnu_e, "e-", "fixed pattern in the dark"),
        ("prnu_percent", curve.prnu_percent, "%", "fixed pattern that grows with the signal"),
        *_emva_rows(curve.emva),
    ]


def _emva_rows(emva: EmvaFigures) -> list[Row]:
    """Where EMVA 1288 defines a figure otherwise, or has one more."""
    return [
        ("system_gain_dn_per_e", emva.system_gain_dn_per_e, "DN/e-", "K of EMVA 1288: 1/gain"),
        ("saturation_capacity_e", emva.saturation_capacity_e, "e-",
         "µe.sat of EMVA 1288: level of the largest temporal variance"),
        ("sensitivity_threshold_e", emva.sensitivity_threshold_e, "e-",
         "µe.min of EMVA 1288: light of SNR 1"),
        ("emva_dynamic_range_dB", _decibels(emva.dynamic_range), "dB", "µe.sat over µe.min"),
        ("snr_max_dB", _decibels(emva.snr_max), "dB", "√µe.sat"),
        ("dsnu_row_e", emva.dsnu_row_e, "e-", "DSNU of whole rows"),
        ("dsnu_column_e", emva.dsnu_column_e, "e-", "DSNU of whole columns"),
        ("dsnu_pixel_e", emva.dsnu_pixel_e, "e-", "DSNU of single pixels"),
        ("prnu_row_percent", emva.prnu_row_percent, "%", "PRNU of whole rows"),
        ("prnu_column_percent", emva.prnu_column_percent, "%", "PRNU of whole columns"),
        ("prnu_pixel_percent", emva.prnu_pixel_percent, "%", "PRNU of single pixels"),
    ]  # fmt: skip


def _decibels(ratio: float | None) -> float | None:
    return 20.0 * math.log10(ratio) if ratio else None
