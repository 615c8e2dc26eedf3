"""Mean responses of interpolation against waves sampled and interpolated here."""

from __future__ import annotations

import numpy as np
import pytest

from core.physics.sampling.interpolation import folded, resampling_response

FREQUENCY = np.array([0.0, 0.03, 0.11, 0.2, 0.37, 0.49])
OLD = 400


def linear(places):
    base = np.floor(places).astype(np.intp)
    return base, [(base + 1, places - base)]


def kept(places):
    return np.rint(places).astype(np.intp), []


@pytest.mark.parametrize("ratio", [3.0, 2.0, 1.0, 0.949, 0.37])
def test_linear_is_the_mean_of_interpolated_waves(ratio):
    places = 20.0 + (np.arange(int(300 * ratio)) + 0.5) / ratio
    base, further = linear(places)
    found = resampling_response(frequency=FREQUENCY, places=places, base=base, further=further)
    n = np.arange(OLD)
    for frequency, each in zip(FREQUENCY, found, strict=True):
        wave = np.exp(2j * np.pi * frequency * n)
        made = np.interp(places, n, wave.real) + 1j * np.interp(places, n, wave.imag)
        true = np.exp(2j * np.pi * frequency * places)
        assert each == pytest.approx(abs(np.mean(made / true)), abs=1e-12)


def test_at_all_places_it_is_the_transform_of_the_kernel():
    places = 10.0 + (np.arange(20000) + 0.5) / 1000
    base, further = linear(places)
    found = resampling_response(frequency=FREQUENCY, places=places, base=base, further=further)
    np.testing.assert_allclose(found, np.sinc(FREQUENCY) ** 2, atol=1e-6)
    base, further = kept(places)
    found = resampling_response(frequency=FREQUENCY, places=places, base=base, further=further)
    np.testing.assert_allclose(found, np.abs(np.sinc(FREQUENCY)), atol=1e-6)


def test_samples_on_samples_stay_as_they_are():
    places = np.arange(5.0, 50.0)
    base, further = linear(places)
    found = resampling_response(frequency=FREQUENCY, places=places, base=base, further=further)
    np.testing.assert_allclose(found, 1.0, rtol=1e-14)


def test_folded_frequencies_show_the_same_wave():
    frequency = np.array([0.0, 0.2, 0.5, 0.7, 1.0, -1.3, 7.25])
    found = folded(frequency)
    assert np.all(np.abs(found) <= 0.5)
    n = np.arange(9)[:, None]
    np.testing.assert_allclose(
        np.exp(2j * np.pi * n * found), np.exp(2j * np.pi * n * frequency), atol=1e-12
    )


def test_samples_count_by_their_share():
    places = np.array([10.0, 10.5, 11.25])
    base, further = linear(places)
    share = np.array([1.0, 0.25, 0.0])
    found = resampling_response(
        frequency=FREQUENCY, places=places, base=base, further=further, share=share
    )
    # One sample as it is, and a quarter of one halfway between two: cos(πf).
    np.testing.assert_allclose(found, (1 + 0.25 * np.cos(np.pi * FREQUENCY)) / 1.25, rtol=1e-12)
