"""A picture in bands where its sum is wanted: of all bands, or of those within a filter."""

from __future__ import annotations

from core.chain.wires import Image
from core.errors import ParameterError
from core.spectrum.band_stack import BandStack, Row


def weights_within(bands: BandStack, low_um: float | None, high_um: float | None) -> Row:
    """Weights of the bands between two wavelengths; one at an end counts by its part within.

    Raises
    ------
    ParameterError
        If no band lies there.
    """
    first, last = bands.band_um
    low, high = low_um or first, high_um or last
    weights = []
    for centre, width, weight in zip(bands.centres_um, bands.widths_um, bands.whole, strict=True):
        part = min(centre + width / 2, high) - max(centre - width / 2, low)
        weights.append(weight * min(max(part / width, 0.0), 1.0))
    if not any(weights):
        raise ParameterError(
            "cut_on_um", low, f"a band that meets the picture's, {first:g} to {last:g} µm",
            unit="µm",
        )  # fmt: skip
    return tuple(weights)


def summed_within(image: Image, low_um: float | None, high_um: float | None) -> Image:
    """A picture in bands as the radiance within a filter; one without bands as it is."""
    bands = image.bands
    if bands is None:
        return image
    first, last = bands.band_um
    band = max(first, low_um or first), min(last, high_um or last)
    weights = weights_within(bands, low_um, high_um)
    return image.with_recipe(bands.picture(weights), band_um=band)
