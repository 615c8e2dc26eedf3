"""Photon noise is Poisson's."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import ImagechainError
from noise_bench import BOUND, QUIET, network


def assert_poisson(samples, mean):
    """Mean and variance of n Poisson deviates: standard errors √(λ/n) and √((λ + 2λ²)/n)."""
    n = samples.size
    assert abs(samples.mean() - mean) <= BOUND * np.sqrt(mean / n)
    assert abs(samples.var() - mean) <= BOUND * np.sqrt((mean + 2 * mean**2) / n)
    # The two agree with each other too (they are positively correlated).
    assert abs(samples.var() - samples.mean()) <= BOUND * np.sqrt(2) * mean / np.sqrt(n)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("seed", [1])
class TestPoissonPanels:
    """Two panels of means 50 and 12.5 have variances like their means (Tantalo 1996, fig. 4.23)."""

    def panels(self, bench):
        picture = np.full((120, 160), 12.5)
        picture[:, 80:] = 50.0
        bench.picture(picture)
        return picture

    def test_photon(self, bench, precision, seed):
        picture = self.panels(bench)
        document = network(QUIET, seed=seed, photons={"mode": "photon", "photons_per_unit": 1})
        image, noise = bench.get(document, "photons.image", "photons.noise", precision=precision)
        image = image.astype(float)
        assert_poisson(image[:, :80], 12.5)
        assert_poisson(image[:, 80:], 50.0)
        assert np.array_equal(image - picture, noise)

    def test_published(self, bench, precision, seed):
        picture = self.panels(bench)
        document = network(QUIET, seed=seed, photons={"percent": 100})
        image, noise = bench.get(document, "photons.image", "photons.noise", precision=precision)
        noise = noise.astype(float)
        # Five weights' widths away from the step the local mean is that of the panel to 3e-7.
        assert_poisson(noise[:, : 80 - 25], 12.5)
        assert_poisson(noise[:, 80 + 25 :], 50.0)
        assert np.allclose(image, picture + noise, rtol=1e-6)

    @pytest.mark.parametrize("scale", [4e-3, 0.1, 1.0, 1e6])
    def test_photon_mean_is_kept_at_any_count(self, bench, precision, seed, scale):
        self.panels(bench)
        document = network(QUIET, seed=seed, photons={"mode": "photon", "photons_per_unit": scale})
        image = bench.get(document, "photons.image", precision=precision).astype(float)
        for side, level in ((image[:, :80], 12.5), (image[:, 80:], 50.0)):
            counts = side * scale
            assert np.abs(counts - np.rint(counts)).max() <= 3e-7 * counts.max()
            assert_poisson(counts, level * scale)


def test_no_light_no_photons(bench):
    bench.picture(np.zeros((5, 6)))
    for photons in ({"mode": "photon", "photons_per_unit": 3}, {"percent": 50}):
        assert np.all(bench.get(network(QUIET, photons=photons), "photons.image") == 0)


def test_negative_light_is_refused(bench):
    bench.picture(np.linspace(-1, 5, 30).reshape(5, 6))
    for photons in ({"mode": "photon", "photons_per_unit": 3}, {"percent": 50, "width_px": 0}):
        with pytest.raises(ImagechainError, match="below 0") as caught:
            bench.get(network(QUIET, photons=photons), "photons.image")
        assert caught.value.node == "photons"
        assert caught.value.exit_code == 2
