"""Averages over a detector's area that a picture has gone through already."""

from __future__ import annotations

from core.chain.wires import Image
from core.physics.detector.detector_aperture import aperture_mtf
from core.physics.optics.measured.tabulated_mtf import radial_tabulated_mtf, tabulated_mtf
from core.transfer.factors import Separable
from nodes.shared.passed_factors import passed_factors


def detector_averages(image: Image) -> list[Separable]:
    """The factors of detectors' areas on the way to a picture, the last one first."""
    return [
        factor
        for factor in passed_factors(image)
        if isinstance(factor, Separable) and any(_is_of_area(law) for law in factor.laws)
    ]


def _is_of_area(law: object) -> bool:
    return getattr(law, "function", None) is aperture_mtf


def passes_table(image: Image) -> bool:
    """Whether a table of MTF is on the way, which may have been measured through the pixels."""
    tables = (tabulated_mtf, radial_tabulated_mtf)
    laws = [law for factor in passed_factors(image) for law in factor.laws]
    return any(getattr(law, "function", None) in tables for law in laws)


def width_mrad(average: Separable, axis: str) -> float:
    """How wide an average is along an axis; 0 where it is none."""
    law = average.x if axis == "x" else average.y
    width: float = 0.0 if law is None else dict(law.parameters)["effective_ifov_mrad"] * law.scale
    return width
