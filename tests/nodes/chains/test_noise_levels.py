"""Noise of detector and amplifier, of gain and bias, has the size it claims."""

from __future__ import annotations

import numpy as np
import pytest

from noise_bench import BOUND, NOISY, QUIET, assert_rms, network, rms


class TestDetectorAndAmplifier:
    def test_rms_is_the_readout(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        ner = bench.readouts(network(NOISY))["ner"]
        area_cm2 = 30e-4 * 20e-4 * 0.9 * 0.8
        nep = np.sqrt(area_cm2 * 30000) / 1e9
        g_number = (1 + 4 * 2**2) / np.pi
        assert ner == pytest.approx(1e4 * nep * g_number / area_cm2, rel=1e-12)
        for seed in range(5):
            for precision in ("single", "double"):
                noise = bench.get(
                    network(NOISY, seed=seed), "noise.detector_noise", precision=precision
                ).astype(float)
                assert_rms(noise, ner)
                assert abs(noise.mean()) <= BOUND * ner / np.sqrt(noise.size)
                # Fourth moment of a normal deviate: 3σ⁴, standard error √(96/n)·σ⁴.
                kurtosis = np.mean(noise**4) / ner**4
                assert abs(kurtosis - 3) <= BOUND * np.sqrt(96 / noise.size)

    @pytest.mark.parametrize(("reference", "level"), [("mean", 35.0), ("contrast", 30.0)])
    @pytest.mark.parametrize("snr", [0.01, 12.5, 1e9])
    def test_amplifier_noise_is_reference_over_snr(self, bench, reference, level, snr):
        picture = np.full((100, 200), 20.0)
        picture[:, 100:] = 50.0
        bench.picture(picture)
        document = network({**QUIET, "amplifier_snr": snr, "snr_reference": reference})
        image, noise = bench.get(document, "noise.image", "noise.noise")
        assert_rms(noise, level / snr)
        assert np.allclose(image - picture, noise, atol=1e-11 * np.abs(image).max())

    def test_spread_of_noise_among_detectors(self, bench):
        rows, columns, spread = 400, 250, 0.2
        bench.picture(np.full((rows, columns), 40.0))
        document = network({**NOISY, "noise_variability_percent": 100 * spread},
                           sensor={"platform": "push"})  # fmt: skip
        ner = bench.readouts(document)["ner"]
        noise = bench.get(document, "noise.detector_noise")
        columns_rms = np.sqrt(np.mean(noise**2, axis=0)) / ner
        # Each column's rms varies by the spread, and by its own sampling error 1/√(2·rows).
        expected = np.hypot(spread, np.sqrt((1 + spread**2) / (2 * rows)))
        error = expected / np.sqrt(2 * columns)
        assert abs(np.std(columns_rms) - expected) <= BOUND * error
        assert abs(np.mean(columns_rms) - 1) <= BOUND * expected / np.sqrt(columns)

    @pytest.mark.parametrize("edges", ["periodic", "reflect"])
    def test_pre_amplifier_filters_the_detector_noise(self, bench, edges):
        rows, columns = 200, 300
        bench.picture(np.full((rows, columns), 40.0))
        document = network({**NOISY, "use_mtf": True}, sensor={"edges": edges})
        noise, white = bench.get(document, "noise.noise", "noise.detector_noise")
        velocity, interval = 8000.0, np.radians(3) * 1000 / columns
        tau = interval / velocity
        xi = np.fft.fftfreq(columns, interval)
        power = np.mean(1 / (1 + (2 * np.pi * tau * velocity * xi) ** 2))
        assert power < 0.5
        expected = rms(white) * np.sqrt(power)
        # Coloured noise has fewer independent samples: n·(Σ|H|²)²/(n·Σ|H|⁴).
        fewer = power**2 / np.mean(1 / (1 + (2 * np.pi * tau * velocity * xi) ** 2) ** 2)
        assert abs(rms(noise) - expected) <= BOUND * expected / np.sqrt(2 * noise.size * fewer)


# ---------------------------------------------------------------- gain and bias

SEEDS = range(400)


@pytest.mark.thorough(but=7)
@pytest.mark.parametrize("model", ["per_pixel", "published"])
@pytest.mark.parametrize("platform", ["line", "push", "array"])
@pytest.mark.parametrize(("gain", "bias"), [(4.0, 0.0), (0.0, 3.0), (4.0, 3.0)])
def test_spread_of_gain_and_bias(bench, platform, model, gain, bias):
    rows, columns, level = 3, 4, 50.0
    bench.picture(np.full((rows, columns), level))
    how = {**QUIET, "gain_percent": gain, "bias_percent": bias, "gain_model": model}
    seeds = SEEDS if platform == "line" else SEEDS[:120]
    errors = np.array([
        bench.get(network(how, seed=seed, sensor={"platform": platform}), "noise.noise")
        for seed in seeds
    ])  # fmt: skip
    expected = level * np.hypot(gain, bias) / 100
    quiet = 1e-9 * level
    if platform == "line":
        assert np.ptp(errors, axis=(1, 2)).max() <= quiet
        errors = errors[:, :1, :1]
    elif platform == "push":
        assert np.ptp(errors, axis=1).max() <= quiet
        assert np.ptp(errors, axis=2).min() > quiet
        errors = errors[:, :1, :]
    else:
        assert np.ptp(errors, axis=1).min() > quiet
        assert np.ptp(errors, axis=2).min() > quiet
    assert_rms(errors, expected)
    assert abs(errors.mean()) <= BOUND * expected / np.sqrt(errors.size)


@pytest.mark.parametrize("model", ["per_pixel", "published"])
def test_gain_scales_what_each_pixel_sees_or_the_mean(bench, model):
    picture = np.full((300, 200), 10.0)
    picture[:, 100:] = 90.0
    bench.picture(picture)
    how = {**QUIET, "gain_percent": 2, "gain_model": model}
    noise = bench.get(network(how, sensor={"platform": "array"}), "noise.noise")
    for side, level in ((noise[:, :100], 10.0), (noise[:, 100:], 90.0)):
        assert_rms(side, 0.02 * (level if model == "per_pixel" else 50.0))


def test_literal_equation_scales_the_picture(bench):
    picture = np.random.default_rng(0).uniform(20, 60, (9, 14))
    bench.picture(picture)
    how = {**QUIET, "gain_percent": 2, "bias_percent": 1, "gain_model": "literal"}
    image = bench.get(network(how), "noise.image")
    mean = picture.mean()
    assert np.allclose(image, picture * 0.02 * mean + 0.01 * mean, rtol=1e-9)
