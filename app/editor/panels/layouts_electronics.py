"""The pages of Electronics & Noise, in the order in which the picture passes its stages."""

from __future__ import annotations

from types import MappingProxyType

from app.editor.panels.sections import Offer, Section
from core.physics.radiometry.materials import MANUAL, MATERIALS_BY_REGION

_DETECTOR = "Detector"
_GAIN = "Gain"
_AMPLIFIER = "Amplifier"
_QUANTIZER = "Quantizer"

_MATERIALS = MappingProxyType(
    {
        region: (*(material.name for material in materials), MANUAL)
        for region, materials in MATERIALS_BY_REGION.items()
    }
)
_POLES = ("lowpass", "highpass")

ELECTRONICS = (
    Section("Band", ("cut_on_um", "cut_off_um"), page=_DETECTOR),
    Section(
        "Wavelength region and material",
        ("region", "material", "d_star"),
        page=_DETECTOR,
        offer=Offer("material", "region", _MATERIALS),
    ),
    Section("Optics", ("optics_transmission", "filter_transmission"), page=_DETECTOR),
    Section(
        "Scan and bandwidth",
        ("scan_mirror_rate_Hz", "time_constant_s", "bandwidth_Hz"),
        page=_DETECTOR,
    ),
    Section("Background", ("background_K",), page=_DETECTOR),
    Section("Gain and bias", ("gain_percent", "bias_percent", "gain_model"), page=_GAIN),
    Section("Noise among detectors", ("noise_variability_percent",), page=_GAIN),
    Section("Pre-amplifier", ("use_mtf",), page=_AMPLIFIER),
    Section("Amplifier noise", ("amplifier_snr", "snr_reference"), page=_AMPLIFIER),
    Section("Post filter", ("post_filter",), page=_AMPLIFIER),
    Section(
        "",
        ("post_corner_Hz",),
        page=_AMPLIFIER,
        shown_when=("post_filter", (*_POLES, "boost")),
    ),
    Section("", ("post_poles",), page=_AMPLIFIER, shown_when=("post_filter", _POLES)),
    Section("", ("post_gain",), page=_AMPLIFIER, shown_when=("post_filter", ("boost",))),
    Section("Quantize the picture", ("bits",), page=_QUANTIZER),
    Section(
        "Range",
        ("range_low", "range_high"),
        page=_QUANTIZER,
        shown_when=("bits", (4, 6, 8, 12, 16, 24, 32, 64)),
    ),
    Section("Seed", ("seed_mode",)),
    Section("", ("seed",), shown_when=("seed_mode", ("typed",))),
)
