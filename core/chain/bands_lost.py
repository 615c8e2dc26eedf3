"""The warning of a module that takes the sum of a picture's bands, as it knows none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.chain.wires import Image, SpectrumWire
from core.modules.caution import Caution
from core.spectrum.band_stack import BandStack


def bands_of(value: Any) -> BandStack | None:
    """Bands of the picture on a wire."""
    image = value.image if isinstance(value, SpectrumWire) else value
    return image.bands if isinstance(image, Image) else None


def sum_caution(
    inputs: Mapping[str, Any], outputs: Mapping[str, Any], *, node: str
) -> Caution | None:
    """What to say where a picture comes in with bands and goes on without."""
    bands = next((one for one in map(bands_of, inputs.values()) if one is not None), None)
    made = [value for value in outputs.values() if isinstance(value, Image | SpectrumWire)]
    if bands is None or not made or any(bands_of(value) is not None for value in made):
        return None
    low, high = bands.band_um
    return Caution(
        f"works on the sum of the picture's {bands.count} bands, {low:.4g} to {high:.4g} µm: "
        "behind it there are none",
        "count them by a detector first, with Focal Plane or Spectral Response, or leave it out",
        node,
    )
