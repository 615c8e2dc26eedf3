"""Atmosphere MTF: turbulence and turbidity."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from core.chain.realize import transfer_plane
from core.chain.wires import Context, Magnitude, Transfer
from core.errors import ParameterError
from core.evaluation.recipes import Step, ends_lineage
from core.evaluation.work import Work
from core.modules.caution import Caution
from core.modules.declaration import NodeContext, readout, warning
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.physics.atmosphere.scattering_and_turbulence import (
    aerosol_mtf,
    fried_mtf,
    path_optical_depth,
    turbidity_optical_depth,
)
from core.physics.atmosphere.turbulence_profile import fried_r0_slant_m, fried_r0_uniform_m
from core.physics.optics.gaussian import fwhm_to_sigma_mrad, gaussian_mtf
from core.transfer.factors import Factor
from nodes.shared.context_defaults import of_context
from nodes.shared.factor_helpers import radial, separable
from nodes.shared.module_ports import MtfModule, MtfOutputs
from nodes.shared.shared_warnings import F_NUMBER_NEAR, apart_caution, wavelength_caution

NEGLIGIBLE = 1 / 256  # a change that 8 bits cannot show


class AtmosphereMTF(MtfModule, key="atmosphere_mtf", title="Atmosphere MTF", group="Atmosphere"):
    """Blur by turbulence, and by light scattered on aerosols (turbidity).

    Turbulence is a Gaussian blur of given width, or Fried's long or short exposure with r0 given
    or from a Cn² profile. Turbidity falls to a plateau: exp(−τ(ρ/ρc)²), beyond ρc exp(−τ), with
    τ of a level (plateaus 0.99, 0.975, 0.955), typed in, or from the scattering coefficient along
    the path (looking down or up, of an exponential profile). Absorption dims all frequencies
    alike: it does not blur, and belongs to the path's transmission, which is no part of this
    module. Looking up blurs more than looking down, as turbulence is near the aperture.
    Sources: Tantalo 1996, section 4.2; Fried 1966; Sadot and Kopeika 1992.
    """

    turbulence: Annotated[
        Literal["gaussian", "long_exposure", "short_exposure", "none"], Param("form of turbulence")
    ] = "gaussian"
    fwhm_mrad: Annotated[
        float, Param("full width at half maximum of the blur", unit="mrad", low=0, slider=(0, 5))
    ] = 0.0
    fried_r0_m: Annotated[
        float | None, Param("Fried's r0; empty: from Cn²", unit="m", low=0, slider=(0.005, 1))
    ] = None
    wavelength_um: Annotated[
        float | None, Param("wavelength; empty: middle of the band", unit="µm", low=0)
    ] = None
    aperture_mm: Annotated[
        float | None, Param("aperture, for short exposure; empty: of Camera", unit="mm", low=0)
    ] = None
    alpha: Annotated[float, Param("short exposure: 1 near field, 0.5 far field", low=0, high=1)] = (
        0.5
    )
    cn2: Annotated[
        float | None, Param("Cn² along a horizontal path, or at the ground", unit="m^(-2/3)", low=0)
    ] = None
    turbidity: Annotated[
        Literal["none", "low", "moderate", "high", "custom"],
        Param("level of aerosols; custom: by τ or the coefficients below"),
    ] = "none"
    scatter_depth: Annotated[
        float | None, Param("custom optical depth τ; empty: from coefficients", low=0)
    ] = None
    turbidity_cutoff_cyc_per_mrad: Annotated[
        float,
        Param("cutoff, particle radius over wavelength", unit="cyc/mrad", low=0, above=True),
    ] = 0.001
    view: Annotated[
        Literal["horizontal", "vertical", "up"],
        Param("line of sight, for coefficients and Cn²; vertical: down from a height, up: to one"),
    ] = "horizontal"
    absorption_per_km: Annotated[
        float,
        Param(
            "of no effect: absorption dims and does not blur (path transmission)",
            unit="1/km",
            low=0,
        ),
    ] = 0.0
    scattering_per_km: Annotated[
        float, Param("scattering coefficient, for custom", unit="1/km", low=0)
    ] = 0.0

    scale_height_km: Annotated[
        float,
        Param("scale height of the aerosol, looking down or up", unit="km", low=0, above=True),
    ] = 1.0

    panel = (
        Section("", ("apply",)),
        Section("Turbulence", ("turbulence",)),
        Section("", ("fwhm_mrad",), shown_when=("turbulence", ("gaussian",))),
        Section(
            "",
            ("fried_r0_m", "cn2", "wavelength_um"),
            shown_when=("turbulence", ("long_exposure", "short_exposure")),
        ),
        Section("", ("aperture_mm", "alpha"), shown_when=("turbulence", ("short_exposure",))),
        Section("Turbidity", ("turbidity",)),
        Section(
            "",
            ("turbidity_cutoff_cyc_per_mrad",),
            shown_when=("turbidity", ("low", "moderate", "high", "custom")),
        ),
        Section(
            "",
            ("scatter_depth", "absorption_per_km", "scattering_per_km", "scale_height_km"),
            shown_when=("turbidity", ("custom",)),
        ),
        Section("Path", ("view",)),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        """Plan turbulence and turbidity."""
        factors = *self._turbulence(context, here), *self._aerosol(context, here)
        return self.mtf_outputs(magnitude, *factors)

    def _turbulence(self, context: Context, here: NodeContext) -> tuple[Factor, ...]:
        label, node = self.title, here.node
        if self.turbulence == "none":
            return ()
        if self.turbulence == "gaussian":
            if self.fwhm_mrad == 0:
                return ()
            sigma = {"sigma_mrad": fwhm_to_sigma_mrad(fwhm_mrad=self.fwhm_mrad)}
            return separable(gaussian_mtf, x=sigma, y=sigma, label=label, node=node)
        short = self.turbulence == "short_exposure"
        aperture_mm = self.aperture_mm or context.aperture_mm
        if short and aperture_mm is None:
            raise ParameterError(
                "aperture_mm", None, "a short exposure needs the aperture", unit="mm"
            )
        return radial(
            fried_mtf,
            wavelength_um=self._wavelength(context),
            fried_r0_m=self.r0_m(context),
            aperture_mm=aperture_mm if short else None,
            alpha=self.alpha if short else 0.0,
            label=label,
            node=node,
        )

    def _aerosol(self, context: Context, here: NodeContext) -> tuple[Factor, ...]:
        depth = self.optical_depth(context)
        if depth == 0:
            return ()
        return radial(
            aerosol_mtf,
            optical_depth=depth,
            cutoff_cyc_per_mrad=self.turbidity_cutoff_cyc_per_mrad,
            label=f"{self.title} (turbidity)",
            node=here.node,
        )

    def _wavelength(self, context: Context) -> float:
        if self.wavelength_um is not None:
            return self.wavelength_um
        if context.band_um is None:
            raise ParameterError(
                "wavelength_um", None, "the image does not say its band: give it here", unit="µm"
            )
        return sum(context.band_um) / 2

    @warning
    def wavelength(self, context: Context) -> Caution | None:
        """Turbulence at a wavelength that the picture does not have."""
        if self.turbulence in ("gaussian", "none"):
            return None
        return wavelength_caution(context.band_um, self.wavelength_um, name="wavelength_um")

    @warning
    def aperture(self, context: Context) -> Caution | None:
        """An aperture that is not the one of the F number and focal length."""
        if self.turbulence != "short_exposure" or not context.f_number:
            return None
        if context.focal_length_mm is None:
            return None
        return apart_caution(
            "aperture_mm",
            self.aperture_mm,
            context.focal_length_mm / context.f_number,
            unit="mm",
            where="by focal_length_mm and f_number of Init & Trans",
            near=F_NUMBER_NEAR,
            remedy="make them agree",
        )

    @readout("m")
    def r0_m(self, context: Context) -> float | None:
        """Fried's r0, given or from the Cn² profile; empty where turbulence does not use it."""
        if self.turbulence in ("gaussian", "none"):
            return None
        if self.fried_r0_m is not None:
            return self.fried_r0_m
        if self.cn2 is None:
            raise ParameterError("fried_r0_m", None, "give fried_r0_m or cn2", unit="m")
        path, wavelength = of_context("range_m", context, unit="m"), self._wavelength(context)
        if self.view == "horizontal":
            return fried_r0_uniform_m(cn2=self.cn2, path_m=path, wavelength_um=wavelength)
        up = self.view == "up"
        return fried_r0_slant_m(
            target_height_m=path if up else 0.0,
            sensor_height_m=0.0 if up else path,
            path_m=path,
            wavelength_um=wavelength,
            ground_cn2=self.cn2,
        )

    @readout()
    def optical_depth(self, context: Context) -> float:
        """Optical depth τ of the turbidity: of scattering alone."""
        if self.turbidity == "none":
            return 0.0
        if self.turbidity != "custom":
            return turbidity_optical_depth(level=self.turbidity)
        if self.scatter_depth is not None:
            return self.scatter_depth
        if self.scattering_per_km == 0:
            return 0.0
        return path_optical_depth(
            absorption_per_km=0.0,
            scattering_per_km=self.scattering_per_km,
            path_m=of_context("range_m", context, unit="m"),
            view=self.view,
            scale_height_km=self.scale_height_km,
        ).scattering

    @readout()
    def largest_change(self, outputs: MtfOutputs) -> Step | float:
        """Largest |1 − MTF| in the image's band."""
        if not outputs.mtf.factors:
            return 0.0
        return Step.of(_largest_change, transfer=outputs.mtf)

    @readout()
    def negligible(self, outputs: MtfOutputs) -> Step | str:
        """Whether the largest change is below one step of 8 bits."""
        if not outputs.mtf.factors:
            return "yes"
        return Step.of(_negligible, Step.of(_largest_change, transfer=outputs.mtf))


@ends_lineage
def _largest_change(work: Work, *, transfer: Transfer) -> float:
    """Look along the radius to the band's corner: every form here depends on ρ alone."""
    corner = np.hypot(transfer.grid.nyquist_x, transfer.grid.nyquist_y)
    line = transfer_plane(work, transfer, np.linspace(0.0, corner, 4097), np.zeros(1))
    return float(np.max(np.abs(1.0 - line)))


@ends_lineage
def _negligible(work: Work, largest: float) -> str:
    return "yes" if largest < NEGLIGIBLE else "no"
