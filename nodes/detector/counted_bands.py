"""Focal Plane on a picture in bands: the photons of each that the detector counts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.physics.electrons.spectral_photons import PHOTON_ENERGY_J_UM, QuantumEfficiency
from core.spectrum.band_stack import BandStack, Row

_TOUCHING = 1e-9  # of the wavelength


def counted_weights(bands: BandStack, efficiency: QuantumEfficiency) -> Row:
    """Weights that make counted photons, s⁻¹ m⁻² sr⁻¹, of radiances per µm.

    λ_b/(hc)·∫ QE dλ over the part of each band that the filter lets through: the radiance of a band
    is the same all over it, and so is the energy of its photons.

    Raises
    ------
    DataError
        For bands that are no radiance.
    ParameterError
        If the filter lets no band through.
    """
    if not bands.density:
        raise DataError("the picture's bands are no radiance per µm: no photons can be counted")
    weights = tuple(
        centre / PHOTON_ENERGY_J_UM * efficiency.integral(centre - width / 2, centre + width / 2)
        for centre, width in zip(bands.centres_um, bands.widths_um, strict=True)
    )
    if not any(weights):
        low, high = bands.band_um
        raise ParameterError(
            "cut_on_um",
            efficiency.cut_on_um,
            f"a filter that lets some of the picture's bands through, {low:g} to {high:g} µm",
            unit="µm",
        )
    return weights


def lit_windows(bands: BandStack) -> tuple[tuple[float, float], ...]:
    """Parts of a picture's band in which its bands lie; none where they touch all over it."""
    ends = sorted(
        (centre - width / 2, centre + width / 2)
        for centre, width in zip(bands.centres_um, bands.widths_um, strict=True)
    )
    windows = [ends[0]]
    for low, high in ends[1:]:
        if abs(low - windows[-1][1]) <= _TOUCHING * low:
            windows[-1] = windows[-1][0], high
        else:
            windows.append((low, high))
    return tuple(windows) if len(windows) > 1 else ()


def counted_photons(image: Image, efficiency: QuantumEfficiency) -> Recipe:
    """Recipe of the photons of a picture in bands that the detector counts."""
    assert image.bands is not None
    return image.bands.picture(counted_weights(image.bands, efficiency))


def radiance_per_photon(image: Image, efficiency: QuantumEfficiency, node: str) -> Recipe:
    """Recipe of the mean radiance over the mean of the photons counted, W s."""
    bands = image.bands
    assert bands is not None
    weights = counted_weights(bands, efficiency)
    return Step.of(_ratio, bands.means(), node=node, radiance=bands.whole, photons=weights)


@ends_lineage
def _ratio(work: Work, means: NDArray[Any], *, radiance: Row, photons: Row) -> float:
    counted = float(np.dot(means, photons))
    if not counted > 0.0:
        raise DataError("the picture has no light in the bands that the detector counts")
    return float(np.dot(means, radiance)) / counted
