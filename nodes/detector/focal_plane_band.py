"""What Focal Plane warns of: its band beside the picture's, the optics' and the material's."""

from __future__ import annotations

from core.chain.wires import Image
from core.modules.caution import Caution
from core.transfer.factors import Factor
from nodes.shared.passed_factors import passed_factors
from nodes.shared.shared_warnings import F_NUMBER_NEAR, NEAR, Band, alike


def filter_caution(picture: Band, passed: Band) -> Caution | None:
    """A cold filter that lets through what the picture's band does not hold."""
    low, high = passed
    if low >= picture[0] * (1 - NEAR) and high <= picture[1] * (1 + NEAR):
        return None
    return Caution(
        f"the cold filter passes {low:g} to {high:g} µm and the picture's radiance is that of "
        f"{picture[0]:g} to {picture[1]:g} µm: what lies beyond is extrapolated by a black body",
        "give a picture of the filter's whole band, or a narrower filter",
    )


def material_caution(passed: Band, material_cutoff_um: float | None) -> Caution | None:
    """A band that goes on beyond the wavelength up to which the material detects."""
    if not material_cutoff_um or passed[1] <= material_cutoff_um * (1 + NEAR):
        return None
    return Caution(
        f"photons of {passed[0]:g} to {passed[1]:g} µm are counted, by one quantum efficiency, and "
        f"the detector material cuts off at material_cutoff_um = {material_cutoff_um:g} µm",
        "set cut_off_um to the cutoff or below it, or give the quantum efficiency over wavelength "
        "in response",
    )


def optics_caution(image: Image, passed: Band) -> Caution | None:
    """Diffraction over other wavelengths than those which the cold filter lets through.

    The cutoff of the optics goes as 1 over the wavelength, as it goes as 1 over the F-number: the
    middles of both bands may differ by as much as a nominal F-number may.
    """
    for factor in passed_factors(image):
        band = _band_of(factor)
        if band is None or alike(sum(band), sum(passed), near=F_NUMBER_NEAR):
            continue
        return Caution(
            f"{factor.label} ({factor.node}) blurs as over {band[0]:g} to {band[1]:g} µm, and the "
            f"cold filter passes {passed[0]:g} to {passed[1]:g} µm: MTF and ranges are those of "
            "the wrong wavelengths",
            f"set cut_on_um = {passed[0]:g} and cut_off_um = {passed[1]:g} on {factor.node} too, "
            "or give a picture of the filter's band",
        )
    return None


def _band_of(factor: Factor) -> Band | None:
    """Wavelengths over which a factor is a mean; None where it names none."""
    for law in factor.laws:
        bound = dict(law.parameters)
        if "cut_on_um" in bound and "cut_off_um" in bound:
            return bound["cut_on_um"], bound["cut_off_um"]
    return None
