"""Pictures with bands of wavelength: their mean spectra, and the responses that weight them."""

from __future__ import annotations

from typing import Any

from app.assessment.response_over_band import response_over_band
from app.run.evaluation import Evaluation
from core.chain.back_transformed import Delivered
from core.chain.wires import Image
from core.spectrum.band_stack import BandStack

Fact = dict[str, Any]


def spectrum_facts(evaluation: Evaluation) -> Fact:
    """Mean spectra, responses, and what stands for all wavelengths; empty lists without bands."""
    spectra: dict[str, Fact] = {}
    for port, image in _with_bands(evaluation):
        assert image.bands is not None
        means = image.bands.means()
        if means.key not in spectra:
            values = evaluation.work.value(means)
            spectra[means.key] = _spectrum(image.bands, values, image.unit)
        spectra[means.key]["ports"].append(port)
    return {
        "means": list(spectra.values()),
        "responses": _responses(evaluation) if spectra else [],
        "transformed": _transformed(evaluation),
    }


def _with_bands(evaluation: Evaluation) -> list[tuple[str, Image]]:
    return [
        (f"{name}.{port}", value)
        for name, planned in evaluation.plan.nodes.items()
        for port, value in planned.outputs.items()
        if not planned.node.disabled and isinstance(value, Image) and value.bands is not None
    ]


def _transformed(evaluation: Evaluation) -> list[Fact]:
    """Of filtered pictures: how many wavelengths stand for all bands, and what that changes."""
    transformed: dict[Any, Fact] = {}
    for port, image in _with_bands(evaluation):
        rank = image.recipe.rank(evaluation.work) if isinstance(image.recipe, Delivered) else None
        if rank is None:
            continue
        alike = tuple(rank.chosen), rank.bound
        fact = {"ports": [], "wavelengths": len(rank.chosen), "bands": rank.shares.shape[1]}
        transformed.setdefault(alike, {**fact, "bound": rank.bound})["ports"].append(port)
    return list(transformed.values())


def _spectrum(bands: BandStack, means: Any, unit: str) -> Fact:
    return {
        "ports": [],
        "bands": bands.count,
        "band_um": bands.band_um,
        "centres_um": list(bands.centres_um),
        "widths_um": list(bands.widths_um),
        "mean": [float(value) for value in means],
        "unit": f"{unit}/µm" if bands.density else unit,
    }


def _responses(evaluation: Evaluation) -> list[Fact]:
    """Of nodes into which a picture with bands comes."""
    responses = []
    for name, planned in evaluation.plan.nodes.items():
        image = planned.inputs.get("image")
        if not isinstance(image, Image) or image.bands is None:
            continue
        drawn = response_over_band(planned, evaluation.plan.folder)
        if drawn is not None:
            responses.append(
                {
                    "node": name,
                    "title": planned.declaration.title,
                    "name": drawn.name,
                    "wavelength_um": drawn.wavelength_um,
                    "values": drawn.values,
                }
            )
    return responses
