"""Every read-out of Electronics & Noise against its formula; detectors are not square."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planck_truth import band_radiance
from readout_bench import (
    DX,
    F_NUMBER,
    FILL_X,
    FILL_Y,
    PITCH_X_UM,
    PITCH_Y_UM,
    SCAN_MRAD_PER_S,
    bench_of,
)

BACKGROUND_K, D_STAR, AMPLIFIER_SNR, SPREAD = 290.0, 1e9, 80.0, 0.3
PARAMS = {
    "material": "manual", "d_star": D_STAR, "background_K": BACKGROUND_K,
    "amplifier_snr": AMPLIFIER_SNR, "optics_transmission": 0.8, "filter_transmission": 0.9,
    "noise_variability_percent": 100 * SPREAD, "bits": 8,
}  # fmt: skip


def slope():
    """dL/dT of Planck's law in 8 to 12 µm, by a difference."""
    up, down = (float(band_radiance(8.0, 12.0, BACKGROUND_K + d)) for d in (0.01, -0.01))
    return (up - down) / 0.02


@pytest.mark.parametrize(
    ("given", "bandwidth_Hz"),
    [
        ({}, SCAN_MRAD_PER_S / (2 * DX)),  # 1/(2τ), τ the time over one sample across
        ({"time_constant_s": 2e-5}, 25e3),
        ({"scan_mirror_rate_Hz": 2.0}, 2 * 2 * math.pi * 1000 / (2 * DX)),
        ({"bandwidth_Hz": 4e4}, 4e4),
    ],
)
def test_readouts_of_the_electronics(tmp_path, given, bandwidth_Hz):
    bench = bench_of(tmp_path, "electronics_noise", {**PARAMS, **given})
    found = bench.readouts("it")
    area_cm2 = PITCH_X_UM * FILL_X * PITCH_Y_UM * FILL_Y * 1e-8
    g_number = (1 + 4 * F_NUMBER**2) / (math.pi * 0.8 * 0.9)
    nep = math.sqrt(area_cm2 * bandwidth_Hz) / D_STAR
    ner = nep * g_number / (1e-4 * area_cm2)
    mean = float(bench.value("scene.image").mean())
    # All detectors together are noisier than one of mean noise, by the spread among them.
    detectors, amplifier = ner * math.hypot(1, SPREAD), mean / AMPLIFIER_SNR
    exact = {
        "bandwidth_Hz": bandwidth_Hz,
        "g_number": g_number,
        "d_star": D_STAR,
        "nep_W": nep,
        "ner": ner,
        "snr": mean / math.hypot(detectors, amplifier),
        "background_K": BACKGROUND_K,
    }
    kelvin = {
        "netd_detector_K": detectors / slope(),
        "netd_amplifier_K": amplifier / slope(),
        "netd_system_K": math.hypot(detectors, amplifier) / slope(),
    }
    error = bench.value("it.quantization_error")
    rounding = {"quantization_rms": math.sqrt(float(np.mean(error**2)))}
    assert found.keys() == {*exact, *kelvin, *rounding}
    for names, rel in ((exact, 1e-11), (kelvin, 1e-6), (rounding, 1e-9)):
        for name, value in names.items():
            assert found[name] == pytest.approx(value, rel=rel), name
