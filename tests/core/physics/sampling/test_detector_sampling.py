"""Transfer functions of resampling against integrals of the kernels and sums of waves."""

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.sampling.detector_sampling import (
    block_mean_mtf,
    folded,
    interpolation_mtf,
    interpolation_ptf,
    resampling_response,
)


def kernel(order, x):
    x = abs(x)
    if order == 0:
        return mpmath.mpf(x < 0.5)
    if order == 1:
        return max(mpmath.mpf(0), 1 - x)
    if x < 1:
        return (mpmath.mpf(3) / 2 * x - mpmath.mpf(5) / 2) * x * x + 1
    return ((-x / 2 + mpmath.mpf(5) / 2) * x - 4) * x + 2 if x < 2 else mpmath.mpf(0)


@pytest.mark.thorough(but=11)
@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize(
    ("old", "new"), [(2, 5), (80, 200), (3, 3), (7, 4), (170, 512), (8, 4), (12, 3), (4, 3)]
)
def test_places_of_few_samples(order, old, new):
    """Each new sample by the kernel itself, its centre where the field's share says."""
    frequency = np.array([0.03, 0.21, 0.5])
    expected = np.zeros(3, complex)
    for number in range(new):
        centre = (number + 0.5) * old / new - 0.5
        for sample in range(-4, old + 5):
            weight = float(kernel(order, sample - centre))
            if order == 0 and sample - centre == 0.5:
                weight = 1.0  # of two as near, the later
            expected += weight * np.exp(2j * np.pi * frequency * (sample - centre)) / new
    how = {"frequency": frequency, "interval_mrad": 1.0, "order": order, "old": old, "new": new}
    found = interpolation_mtf(**how) * np.exp(1j * interpolation_ptf(**how))
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("samples", [1, 2, 3, 8])
def test_block_means(samples):
    """Sums of the wave over the block, up to beyond the samples' own period."""
    frequency = np.linspace(0.0, 1.4, 141)
    places = np.arange(samples) - (samples - 1) / 2
    expected = np.mean(np.cos(2 * np.pi * np.outer(frequency * 1.3, places)), axis=1)
    found = block_mean_mtf(frequency=frequency, interval_mrad=1.3, samples=samples)
    assert found == pytest.approx(expected, abs=1e-13)
    assert found[0] == 1.0


def test_refused():
    with pytest.raises(ParameterError, match="interval_mrad"):
        interpolation_mtf(frequency=[0.1], interval_mrad=0.0, order=1, old=3, new=4)


# Mean responses of interpolation against waves sampled and interpolated here.


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
