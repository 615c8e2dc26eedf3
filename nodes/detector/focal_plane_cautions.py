"""What Focal Plane warns of: its band beside the picture's and the optics', and what is clipped."""

from __future__ import annotations

from dataclasses import replace

from core.chain.wires import Image
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.modules.caution import Caution
from core.physics.electrons.spectral_photons import QuantumEfficiency
from core.transfer.factors import Factor
from nodes.detector.focal_plane_figures import ElectronLevels, ReadOut, mean_clipped
from nodes.shared.passed_factors import passed_factors
from nodes.shared.shared_warnings import F_NUMBER_NEAR, NEAR, Band, alike


def filter_caution(picture: Band, passed: Band, *, in_bands: bool) -> Caution | None:
    """A cold filter that lets through what the picture's band does not hold."""
    low, high = passed
    if low >= picture[0] * (1 - NEAR) and high <= picture[1] * (1 + NEAR):
        return None
    return Caution(
        f"the cold filter passes {low:g} to {high:g} µm and the picture's radiance is that of "
        f"{picture[0]:g} to {picture[1]:g} µm: what lies beyond is "
        + ("not counted" if in_bands else "extrapolated by a black body"),
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


@ends_lineage
def overflow_caution(work: Work, levels: ElectronLevels, *, reading: ReadOut) -> Caution | None:
    """A picture whose mean is clipped, so that it has no NETD and no SNR, or its brightest.

    Noise and unlike pixels are left out: what they alone clip is in `saturated_pixels`.
    """
    clipped = mean_clipped(levels, reading)
    if clipped is not None:
        return replace(clipped, message=f"{clipped.message}: it has no NETD, SNR or NEI")
    saturation = reading.saturation_e
    if levels.brightest_e > saturation:
        return Caution(
            f"the picture's brightest gives {levels.brightest_e:.4g} e- and is clipped at "
            f"{saturation:.4g} e-: SNR and noise are those of the mean; saturated_pixels says how "
            "many are clipped",
            "make integration_time_s smaller, or full_well_e, gain_e_per_dn or bits larger",
        )
    return None


def response_caution(efficiency: QuantumEfficiency) -> Caution | None:
    """A curve whose first or last point is within the band and not zero."""
    if not efficiency.points:
        return None
    (first, at_first), (last, at_last) = efficiency.points[0], efficiency.points[-1]
    ends = []
    if at_first > 0.0 and first > efficiency.cut_on_um * (1 + NEAR):
        ends.append(f"begins at {first:g} µm with {at_first:g}")
    if at_last > 0.0 and last < efficiency.cut_off_um * (1 - NEAR):
        ends.append(f"ends at {last:g} µm with {at_last:g}")
    if not ends:
        return None
    return Caution(
        f"the response {' and '.join(ends)}, within the band of {efficiency.cut_on_um:g} to "
        f"{efficiency.cut_off_um:g} µm: no photons are counted beyond",
        "give points over the whole band, or close the curve by points of 0",
    )
