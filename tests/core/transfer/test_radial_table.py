"""Tables of the radius against the function that they stand for."""

import numpy as np
import pytest

from core.physics.optics.overlap_area import annular_otf
from core.physics.optics.polychromatic import band_wavelengths
from core.transfer.planar_blocks import RadialTable


def band_otf(hole, count):
    wavelengths, weights = band_wavelengths(cut_on_um=3.0, cut_off_um=5.0, count=count)

    def function(radii):
        return sum(
            weight * annular_otf(frequency_ratio=wavelength * radii / 4.0, obscuration_ratio=hole)
            for wavelength, weight in zip(wavelengths, weights, strict=True)
        )

    kinks = [4.0 / w * v for w in wavelengths for v in (1.0, hole, (1 - hole) / 2, (1 + hole) / 2)]
    return function, kinks


@pytest.mark.parametrize("hole", [0.0, 1 / 3, 0.9])
@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("reach", [0.1, 0.9, 1.25])
def test_errors_are_within_what_was_asked_for(hole, count, reach):
    function, kinks = band_otf(hole, count)
    table = RadialTable.of(function, reach=reach, error=5e-8)
    rng = np.random.default_rng(1)
    near = [kink * (1.0 + 1e-3 * rng.normal(size=3000)) for kink in kinks]
    radii = np.concatenate([rng.uniform(0.0, reach, 20000), *near])
    radii = radii[(radii >= 0.0) & (radii <= reach)]
    # Halfway between its entries a table shows most of its error, not all.
    assert np.abs(table.at(radii**2, function) - function(radii)).max() < 1e-7


def test_places_too_rough_to_interpolate_are_evaluated():
    def step(radii):
        return np.where(radii < 0.31, 1.0, 0.25)

    table = RadialTable.of(step, reach=1.0, error=1e-8)
    assert table.rough
    radii = 0.31 + np.linspace(-1e-3, 1e-3, 1001)
    np.testing.assert_array_equal(table.at(radii**2, step), step(np.sqrt(radii**2)))


def test_what_is_rough_everywhere_has_no_table():
    assert RadialTable.of(lambda radii: np.sin(1e6 * radii), reach=1.0, error=1e-8) is None
