"""Figures of a detector and its amplifier, from the mean of their input."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np

from core.chain.results import TableData, TableRow
from core.errors import DataError, ParameterError
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.detector.detectivity import band_d_star, cold_shield_half_angle_deg
from core.physics.noise.noise_equivalent import (
    amplifier_noise_radiance,
    g_number,
    nep_W,
    ner_W_m2_sr,
    netd_K,
    system_netd_K,
)
from core.physics.radiometry.planck import brightness_temperature
from core.physics.radiometry.spectra import find_material
from nodes.shared.context_defaults import Lens
from nodes.shared.steps import PictureRange


@dataclass(frozen=True)
class Detector:
    """What the figures are computed from; the cone of a cold shield is matched to the optics."""

    cut_on_um: float
    cut_off_um: float
    region: str
    material: str
    d_star: float | None
    lens: Lens
    filter_transmission: float
    area_cm2: float
    bandwidth_Hz: float
    background_K: float | None


@dataclass(frozen=True)
class DetectorFigures:
    """What does not depend on the amplifier."""

    background_K: float
    g_number: float
    d_star: float
    nep_W: float
    ner: float
    netd_K: float


@ends_lineage
def detector_figures(
    work: Work, seen: PictureRange, *, detector: Detector, vignetting: float
) -> DetectorFigures:
    """The background and NETD are those of the scene before the vignetting."""
    band = {"cut_on_um": detector.cut_on_um, "cut_off_um": detector.cut_off_um}
    background = detector.background_K
    if background is None:
        if seen.mean <= 0:
            raise DataError(
                f"the picture's mean {seen.mean:.6g} is not the radiance of a background: give "
                "background_K"
            )
        background = float(brightness_temperature(radiance=seen.mean / vignetting, **band))
    d_star = detector.d_star or _band_d_star(detector, background)
    throughput = g_number(
        f_number=detector.lens.f_number,
        filter_transmission=detector.filter_transmission,
        optics_transmission=detector.lens.transmission,
        obscuration_ratio=detector.lens.obscuration_ratio,
        irradiance=detector.lens.irradiance,
    )
    nep = nep_W(area_cm2=detector.area_cm2, bandwidth_Hz=detector.bandwidth_Hz, d_star=d_star)
    ner = ner_W_m2_sr(nep_W=nep, area_cm2=detector.area_cm2, g_number=throughput)
    netd = float(netd_K(noise_radiance=ner / vignetting, background_K=background, **band))
    return DetectorFigures(background, throughput, d_star, nep, ner, netd)


@ends_lineage
def figures(
    work: Work,
    seen: PictureRange,
    computed: DetectorFigures,
    *,
    detector: Detector,
    amplifier_snr: float | None,
    snr_reference: str,
    variability_percent: float,
) -> TableData:
    """All read-outs of noise, in the order of the panel.

    NEP and NER are of a detector of mean noise; NETD and SNR are of the picture, with the rms over
    all detectors: √(1 + v²) times as much where v is the spread of their noise.
    """
    rms_over_mean = hypot(1.0, variability_percent / 100.0)
    sigma = amplifier_sigma(seen, snr=amplifier_snr, reference=snr_reference)
    # NETD is noise over dL/dT: the detector's own gives the slope without Planck's integral.
    netd_amplifier = computed.netd_K * sigma / computed.ner
    netd_detector = computed.netd_K * rms_over_mean
    noise = float(np.hypot(computed.ner * rms_over_mean, sigma))
    rows = (
        ("background_K", computed.background_K, "K", "background temperature for D* and dL/dT"),
        ("bandwidth_Hz", detector.bandwidth_Hz, "Hz", "noise bandwidth"),
        ("g_number", computed.g_number, "1/sr", "optical throughput"),
        ("d_star", computed.d_star, "cm √Hz/W", "specific detectivity over the band"),
        ("nep_W", computed.nep_W, "W", "noise-equivalent power of a detector with mean noise"),
        ("ner", computed.ner, "W/m²/sr", "noise-equivalent radiance of a detector with mean noise"),
        ("amplifier_noise", sigma, "W/m²/sr", "rms noise of the amplifier"),
        ("netd_detector_K", netd_detector, "K", "NETD of the detectors, rms over all"),
        ("netd_amplifier_K", netd_amplifier, "K", "NETD of the amplifier"),
        ("netd_system_K",
         system_netd_K(amplifier_netd_K=netd_amplifier, detector_netd_K=netd_detector), "K",
         "NETD of detector and amplifier together"),
        ("snr", seen.mean / noise, "",
         "mean signal divided by the rms noise of detector and amplifier"),
    )  # fmt: skip
    return TableData(tuple(TableRow(*row) for row in rows))


def amplifier_sigma(seen: PictureRange, *, snr: float | None, reference: str) -> float:
    """Rms noise of the amplifier: the reference over its SNR; none without an SNR."""
    if snr is None:
        return 0.0
    level = abs(seen.mean) if reference == "mean" else seen.high - seen.low
    sigma = float(amplifier_noise_radiance(reference_radiance=level, snr=snr))
    if not np.isfinite(sigma):
        raise ParameterError("amplifier_snr", snr, "large enough for finite noise")
    return sigma


def _band_d_star(detector: Detector, background_K: float) -> float:
    if detector.material == "manual":
        raise ParameterError("d_star", None, "the material `manual` needs it", unit="cm √Hz/W")
    d_star = band_d_star(
        material=find_material(
            region=detector.region, material=detector.material, cut_off_um=detector.cut_off_um
        ),
        cut_on_um=detector.cut_on_um,
        cut_off_um=detector.cut_off_um,
        background_K=background_K,
        half_angle_deg=cold_shield_half_angle_deg(f_number=detector.lens.f_number),
    )
    if d_star <= 0:
        raise ParameterError(
            "material",
            detector.material,
            f"the material does not respond between {detector.cut_on_um:g} and "
            f"{detector.cut_off_um:g} µm; choose another material, or set another band",
        )
    return float(d_star)
