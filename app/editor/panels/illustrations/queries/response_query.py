"""The query of a response over wavelength, beside the mean spectrum of the picture it is for."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.assessment.response_over_band import DrawnResponse, response_over_band
from app.editor.evaluation.queries import Passing, Query
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Image

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MeanSpectrum:
    """The mean of every band of a picture.

    Parameters
    ----------
    centres_um, means : ndarray, shape (bands,)
        Where the bands lie, and their means.
    unit : str
        Of the means.
    """

    centres_um: Vector
    means: Vector
    unit: str


@dataclass(frozen=True, eq=False)
class ResponseOverSpectrum:
    """A response and a spectrum, as far as there are; the node may be disabled."""

    response: DrawnResponse | None = None
    spectrum: MeanSpectrum | None = None


@dataclass(frozen=True)
class ResponseQuery(Query):
    """The response of a node over the mean spectrum of the picture that comes in.

    Parameters
    ----------
    node : str
        A Focal Plane or a Spectral Response.
    """

    node: str

    def key(self, plan: Plan) -> Hashable:
        """What comes in, and what is made of it."""
        planned = _planned(plan, self.node)
        made = planned.outputs.get("table") or planned.outputs.get("image")
        image = planned.inputs.get("image")
        bands = image.bands.key if isinstance(image, Image) and image.bands is not None else None
        return made and made.key, bands, repr(planned.module), planned.node.disabled

    def answer(self, passing: Passing) -> ResponseOverSpectrum:
        """Both."""
        planned = _planned(passing.plan, self.node)
        response = response_over_band(planned, passing.plan.folder)
        if response is None:
            return ResponseOverSpectrum()
        return ResponseOverSpectrum(response, mean_spectrum(planned.inputs.get("image"), passing))


def mean_spectrum(image: Image | None, passing: Passing) -> MeanSpectrum | None:
    """Of a picture with bands."""
    if image is None or image.bands is None:
        return None
    unit = f"{image.unit}/µm" if image.bands.density else image.unit
    means = np.asarray(passing.work.value(image.bands.means()), np.float64)
    return MeanSpectrum(np.array(image.bands.centres_um), means, unit)


def _planned(plan: Plan, node: str) -> PlannedNode:
    planned = plan.node(node)
    if planned.error is not None:
        raise planned.error
    return planned
