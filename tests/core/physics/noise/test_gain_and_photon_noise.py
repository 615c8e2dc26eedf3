"""Gain and bias models, and the means of photon noise, against their formulas written out."""

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.detector.quantization import apply_gain_bias
from core.physics.noise.poisson import photon_means, published_means, radiance_of_photons

GIVEN = {"gain_percent": 1.0, "bias_percent": 2.0, "mean_radiance": 1.4}


@pytest.fixture
def picture():
    return np.linspace(0.5, 2.5, 20).reshape(4, 5)


@pytest.mark.parametrize("shape", [(), (1, 5), (4, 1), (4, 5)])
def test_models_with_any_pattern(picture, shape):
    rng = np.random.default_rng(1)
    n1, n2 = rng.standard_normal(shape), rng.standard_normal(shape)
    expected = {
        "per_pixel": picture * (1 + 0.01 * n1) + 0.02 * n2 * 1.4,
        "published": picture + (0.01 * n1 + 0.02 * n2) * 1.4,
        "literal": picture * (0.01 * 1.4) + 0.02 * 1.4,
    }
    for model, truth in expected.items():
        got = apply_gain_bias(picture, gain_pattern=n1, bias_pattern=n2, model=model, **GIVEN)
        np.testing.assert_allclose(got, truth, rtol=1e-14)
        single = apply_gain_bias(
            picture.astype(np.float32), gain_pattern=n1, bias_pattern=n2, model=model, **GIVEN
        )
        assert single.dtype == np.float32
        np.testing.assert_allclose(single, truth, rtol=1e-6)


@pytest.mark.parametrize("model", ["per_pixel", "published"])
def test_no_error_changes_nothing(picture, model):
    got = apply_gain_bias(
        picture,
        gain_pattern=3.0,
        bias_pattern=-2.0,
        gain_percent=0.0,
        bias_percent=0.0,
        mean_radiance=1.4,
        model=model,
    )
    assert np.array_equal(got, picture)


def test_wrong_gain_parameters_are_refused(picture):
    patterns = {"gain_pattern": 1.0, "bias_pattern": 1.0}
    with pytest.raises(ParameterError, match="bias_percent"):
        apply_gain_bias(picture, **patterns, **(GIVEN | {"bias_percent": -1.0}))
    with pytest.raises(ParameterError, match="gain_percent"):
        apply_gain_bias(picture, **patterns, **(GIVEN | {"gain_percent": np.nan}))
    with pytest.raises(ParameterError, match="per_pixel, published, literal"):
        apply_gain_bias(picture, **patterns, **GIVEN, model="none")


def test_published_mean_is_a_percentage(picture):
    np.testing.assert_allclose(published_means(picture, percent=1.0), picture / 100, rtol=1e-15)
    assert not published_means(picture, percent=0.0).any()


def test_photons_and_back(picture):
    means = photon_means(picture, photons_per_unit=5e4)
    np.testing.assert_allclose(means, picture * 5e4, rtol=1e-15)
    back = radiance_of_photons(means, photons_per_unit=5e4)
    np.testing.assert_allclose(back, picture, rtol=1e-15)


def test_rounding_below_zero_is_zero_and_more_is_refused(picture):
    picture[1, 1] = -1e-7
    assert published_means(picture, percent=1.0)[1, 1] == 0.0
    picture[1, 1] = -0.1
    with pytest.raises(DataError, match="1 of 20 means"):
        photon_means(picture, photons_per_unit=10.0)
    picture[1, 1] = np.nan
    with pytest.raises(DataError, match="not finite"):
        published_means(picture, percent=1.0)


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_wrong_photon_parameters_are_refused(picture, bad):
    with pytest.raises(ParameterError, match="percent"):
        published_means(picture, percent=bad)
    with pytest.raises(ParameterError, match="photons_per_unit"):
        photon_means(picture, photons_per_unit=bad)
    with pytest.raises(ParameterError, match="photons_per_unit"):
        radiance_of_photons(picture, photons_per_unit=0.0)
