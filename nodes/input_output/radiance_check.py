"""Whether samples can be the radiance they are read as."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from core.evaluation.recipes import ends_lineage, in_blocks
from core.evaluation.work import Work
from core.modules.caution import Caution
from core.physics.radiometry.scene_limits import (
    COLDEST_SURFACE_K,
    HOTTEST_SURFACE_K,
    brightest_surface_radiance,
    coldest_for_radiance,
)
from nodes.input_output.sample_statistics import Statistics, statistics

_REMEDY = "give the samples' unit, such as K or DN, or the scale that makes W/m²/sr of them"


@in_blocks()
@ends_lineage
def radiance_caution(
    work: Work,
    samples: NDArray[Any],
    *,
    band_um: tuple[float, float] | None,
    unit_stated: bool,
) -> Caution | None:
    """Samples in W/m²/sr that cannot be radiance of a scene, or look like temperatures.

    They cannot where their mean is above what any surface of the Earth gives in the band, sunlight
    included (`brightest_surface_radiance`). Where the band is not known, that is the radiance of
    all wavelengths, and kelvin may lie below it: then they look like temperatures where no unit
    is stated, and mean ± 2 σ (three quarters of the samples at least, after Chebyshev) lie
    between the coldest and the hottest land surface ever seen.
    """
    stats = statistics(samples, for_each=work.for_each)
    limit = brightest_surface_radiance(band_um=band_um)
    kelvin = _like_kelvin(stats)
    if stats.mean > limit:
        where = (
            "at all wavelengths" if band_um is None else f"in {band_um[0]:g} to {band_um[1]:g} µm"
        )
        looks = "; they look like temperatures in kelvin" if kelvin else ""
        return Caution(
            f"the samples' mean, {stats.mean:.4g} W/m²/sr, is more than the {limit:.3g} that a "
            f"surface on Earth can give {where}{looks}",
            f"{_REMEDY}; it is well of flames, lamps, engines and the Sun",
        )
    if band_um is None and kelvin and not unit_stated:
        least = coldest_for_radiance(radiance=stats.mean)
        return Caution(
            f"the samples, {stats.mean:.4g} ± {stats.sigma:.2g}, look like temperatures in kelvin "
            f"and are read as W/m²/sr, which not even all wavelengths give below {least:.0f} K",
            f"{_REMEDY}; cut_on_um and cut_off_um, if it is radiance",
        )
    return None


def _like_kelvin(stats: Statistics) -> bool:
    low, high = stats.mean - 2 * stats.sigma, stats.mean + 2 * stats.sigma
    return low >= COLDEST_SURFACE_K and high <= HOTTEST_SURFACE_K
