"""The response of a planned node over wavelength, as it is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.engine import PlannedNode
from core.chain.wires import Image
from core.modules.declaration import NodeContext
from nodes.detector.focal_plane import FocalPlane
from nodes.detector.spectral_response import SpectralResponse

Vector = NDArray[np.float64]
Band = tuple[float, float]
_POINTS = 241
_BESIDE = 1e-9  # of a wavelength, on both sides of where a response may jump


@dataclass(frozen=True, eq=False)
class DrawnResponse:
    """A response over wavelength.

    Parameters
    ----------
    name : str
        What it is of every wavelength.
    band_um : (float, float)
        Wavelengths shown: the picture's band, and what lies within the response beside it.
    wavelength_um, values : ndarray, shape (points,)
        The curve.
    """

    name: str
    band_um: Band
    wavelength_um: Vector
    values: Vector


def response_over_band(planned: PlannedNode, folder: Path) -> DrawnResponse | None:
    """Response of a Focal Plane or Spectral Response; None of any other node, or without a band.

    Parameters
    ----------
    planned : PlannedNode
        The node, without an error.
    folder : Path
        The network's, from which its files are named.
    """
    image: Image | None = planned.inputs.get("image")
    module = planned.module
    if image is None or planned.node.disabled:
        return None
    if isinstance(module, FocalPlane):
        efficiency = module.efficiency(planned.result)
        filter_um = efficiency.cut_on_um, efficiency.cut_off_um
        knots = [place for place, _ in efficiency.points]
        return _drawn(
            "quantum efficiency", image.band_um or filter_um, filter_um, knots, efficiency
        )
    if isinstance(module, SpectralResponse) and image.band_um is not None:
        curve = module.response(image.band_um, NodeContext(planned.node.id, folder=folder))
        knots = [place for place, _ in curve.points] or list(curve.ends_um)
        return _drawn("response", image.band_um, image.band_um, knots, curve)
    return None


def _drawn(name: str, band: Band, own: Band, knots: list[float], response: Any) -> DrawnResponse:
    low, high = min(band[0], own[0]), max(band[1], own[1])
    ends = np.array([*own, *knots])
    ends = ends[(ends >= low) & (ends <= high)]
    beside = np.concatenate([ends * (1 - _BESIDE), ends, ends * (1 + _BESIDE)])
    places = np.unique(np.concatenate([np.linspace(low, high, _POINTS), beside]))
    return DrawnResponse(name, (low, high), places, np.asarray(response.at(places)))
