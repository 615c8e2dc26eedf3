"""Atmosphere MTF: turbulence and turbidity."""

from typing import Any, Literal

import numpy as np

from core.chain.band_stack import BandStack
from core.chain.wires import Context, Magnitude, Transfer, transfer_plane
from core.errors import ParameterError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.atmosphere import scattering_and_turbulence as physics
from core.physics.atmosphere.air_path import VISIBLE_UM
from core.physics.optics.blur import fwhm_to_sigma_mrad, gaussian_mtf
from core.transfer.factors import AtWavelength, Factor, Law, Planar
from nodes.optics.band_spectrum import at_each_band
from nodes.shared.context_defaults import F_NUMBER_NEAR, NEAR, apart, of_context, wavelength_caution
from nodes.shared.module_ports import MtfModule, MtfOutputs, radial, separable

NEGLIGIBLE = 1 / 256  # a change that 8 bits cannot show


class AtmosphereMTF(MtfModule, key="atmosphere_mtf", title="Atmosphere MTF", group="Atmosphere"):
    """Blur by atmospheric turbulence and aerosol scattering (turbidity).

    `turbulence` selects a Gaussian blur of a given width, or Fried's long- or short-exposure MTF.
    r0 is entered or, if empty, computed from a Cn² profile. The turbidity MTF is exp(−τ(ρ/ρc)²) up
    to ρc and a plateau of exp(−τ) beyond it. τ comes from the aerosol level (plateau 0.99, 0.975 or
    0.955) or, if `turbidity` is custom, from a number or the scattering coefficient along the path.
    On a downward or upward path, the scattering coefficient falls exponentially with height.
    Absorption attenuates all frequencies equally and does not blur; for absorption, use Atmospheric
    Path. The blur is stronger on an upward path than on a downward path, because the strongest
    turbulence of an upward path is near the aperture. r0 scales with λ^(6/5), and the aerosol
    cutoff ρc with 1/λ. Each band of a spectral picture is blurred at its own wavelength.

    Sources: Tantalo 1996, section 4.2; Fried 1966; Sadot and Kopeika 1992.
    """

    formulas = (
        Formula(
            r"H=e^{-2\pi^2\sigma^2\rho^2},\quad\sigma=\frac{\mathrm{FWHM}}{2\sqrt{2\ln 2}}",
            where="ρ² = ξ² + η², cycles/mrad",
            when="turbulence gaussian",
        ),
        Formula(
            r"H=\exp\left[-3.44\left(\frac{\lambda\rho}{r_0}\right)^{5/3}\left(1-\alpha\left("
            r"\frac{\lambda\rho}{D}\right)^{1/3}\right)\right]",
            where="λρ: in mm; r₀: Fried parameter; D: aperture; α: 0 for a long exposure; "
            "the last bracket is never below 0",
            when="turbulence long_exposure or short_exposure",
        ),
        Formula(
            r"r_0=\left(0.423\,k^2\int C_n^2(z)\,w(z)\,dz\right)^{-3/5}",
            where="k = 2π/λ; w: 1 for a plane wave, (z/L)^(5/3) for a spherical wave, z "
            "measured from the target",
            when="r₀ from a Cn² profile",
        ),
        Formula(
            r"H=\exp\left[-\tau\,\min\left(1,\;\rho/\rho_c\right)^2\right]",
            where="τ: scattering optical depth; ρ_c: particle radius over wavelength",
            when="turbidity",
        ),
    )

    turbulence: Literal["gaussian", "long_exposure", "short_exposure", "none"] = param(
        "gaussian", "turbulence model"
    )
    fwhm_mrad: float = param(
        0.0, "full width at half maximum of the Gaussian blur", low=0, slider=(0, 5)
    )
    fried_r0_m: float | None = param(
        None, "Fried parameter r0; empty: from Cn²", low=0, slider=(0.005, 1)
    )
    wavelength_um: float | None = param(
        None,
        "wavelength of the blur; empty: the middle of the band, or of each band of a cube",
        low=0,
    )
    r0_wavelength_um: float | None = param(
        None,
        "wavelength for which r0 is given, often 0.5 µm; empty: the wavelength of the blur",
        low=0,
    )
    aperture_mm: float | None = param(
        None, "aperture diameter, for a short exposure; empty: from Camera", low=0
    )
    alpha: float = param(
        0.5, "α for a short exposure, 1 in the near field and 0.5 in the far field", (0, 1)
    )
    cn2: float | None = param(
        None,
        "Cn² along a horizontal path, or at the ground for a vertical path",
        low=0,
        unit="m^(-2/3)",
    )
    turbidity: Literal["none", "low", "moderate", "high", "custom"] = param(
        "none", "aerosol level; custom: τ from scatter_depth or, if empty, from scattering_per_km"
    )
    scatter_depth: float | None = param(
        None, "optical depth τ, used when turbidity is custom; empty: from scattering_per_km", low=0
    )
    turbidity_cutoff_cyc_per_mrad: float = param(
        0.001, "cutoff frequency: particle radius over wavelength", low=0, above=True
    )
    particle_radius_um: float | None = param(
        None,
        "particle radius, which sets the cutoff (radius over wavelength); empty: "
        "from turbidity_cutoff_cyc_per_mrad",
        (0, 1e6),
        slider=(0.1, 20),
    )
    view: Literal["horizontal", "vertical", "up"] = param(
        "horizontal",
        "line of sight, used with scattering_per_km and Cn²; vertical: looking down from a "
        "height; up: looking up to a height",
    )
    absorption_per_km: float = param(
        0.0,
        "absorption coefficient, which has no effect here: absorption attenuates the scene without "
        "blurring it; use Atmospheric Path",
        low=0,
    )
    scattering_per_km: float = param(
        0.0, "scattering coefficient, used when turbidity is custom", low=0
    )

    scale_height_km: float = param(
        1.0, "scale height of the aerosol, used when looking down or up", low=0, above=True
    )

    panel = (
        Section("", "apply"),
        Section("Turbulence", "turbulence"),
        Section("", "fwhm_mrad", shown_when=("turbulence", ("gaussian",))),
        Section(
            "",
            "fried_r0_m r0_wavelength_um cn2",
            shown_when=("turbulence", ("long_exposure", "short_exposure")),
        ),
        Section("", "aperture_mm alpha", shown_when=("turbulence", ("short_exposure",))),
        Section("Turbidity", "turbidity"),
        Section(
            "",
            "turbidity_cutoff_cyc_per_mrad particle_radius_um",
            shown_when=("turbidity", ("low", "moderate", "high", "custom")),
        ),
        Section(
            "",
            "scatter_depth absorption_per_km scattering_per_km scale_height_km",
            shown_when=("turbidity", ("custom",)),
        ),
        Section("Path", "view wavelength_um"),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        image = magnitude.image
        # Of the picture, if the wavelength is not fixed here.
        bands = image.bands if image is not None and self.wavelength_um is None else None
        factors = *self._turbulence(context, here, bands), *self._aerosol(context, here, bands)
        return self.mtf_outputs(magnitude, *factors)

    def _turbulence(
        self, context: Context, here: NodeContext, bands: BandStack | None
    ) -> tuple[Factor, ...]:
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
                "aperture_mm",
                None,
                "turbulence = short_exposure needs the aperture diameter; give it here or on "
                "Camera",
            )
        wavelength = self._wavelength(context)
        how: dict[str, Any] = {
            "fried_r0_m": self.r0_m(context),
            "aperture_mm": aperture_mm if short else None,
            "alpha": self.alpha if short else 0.0,
        }
        blur = radial(physics.fried_mtf, wavelength_um=wavelength, **how, label=label, node=node)
        return _by_bands(blur, Law.of(physics.fried_mtf, r0_wavelength_um=wavelength, **how), bands)

    def _aerosol(
        self, context: Context, here: NodeContext, bands: BandStack | None
    ) -> tuple[Factor, ...]:
        depth = self.optical_depth(context)
        if depth == 0:
            return ()
        label, node = f"{self.title} (turbidity)", here.node
        if self.particle_radius_um is None:
            cutoff = {"cutoff_cyc_per_mrad": self.turbidity_cutoff_cyc_per_mrad}
            return radial(
                physics.aerosol_mtf, optical_depth=depth, **cutoff, label=label, node=node
            )
        how = {"optical_depth": depth, "particle_radius_um": self.particle_radius_um}
        wavelength = self._wavelength(context)
        particles = physics.aerosol_mtf_of_particles
        blur = radial(particles, wavelength_um=wavelength, **how, label=label, node=node)
        return _by_bands(blur, Law.of(particles, **how), bands)

    def _wavelength(self, context: Context) -> float:
        if self.wavelength_um is not None:
            return self.wavelength_um
        if context.band_um is None:
            raise ParameterError(
                "wavelength_um", None, "the image has no band. Give the wavelength here"
            )
        return sum(context.band_um) / 2

    @warning
    def cutoff(self, given: frozenset[str]) -> Caution | None:
        """A cutoff frequency is entered, but the particle radius already sets the cutoff."""
        if self.particle_radius_um is None or "turbidity_cutoff_cyc_per_mrad" not in given:
            return None
        return Caution(
            f"turbidity_cutoff_cyc_per_mrad = {self.turbidity_cutoff_cyc_per_mrad:g} is not "
            f"used: the cutoff follows from particle_radius_um = {self.particle_radius_um:g} "
            "µm",
            "leave turbidity_cutoff_cyc_per_mrad at its default, or leave particle_radius_um empty",
        )

    @warning
    def path(self, magnitude: Magnitude) -> Caution | None:
        """Scattering and absorption add up to more than the extinction of Atmospheric Path."""
        image = magnitude.image
        known = [] if image is None else [air for air in image.air if air.range_m]
        scattering = self.scattering_per_km
        if self.turbidity != "custom" or self.scatter_depth is not None or not known:
            return None
        if self.view != "horizontal" or image is None or len(known) < len(image.air):
            return None
        middle = sum(image.band_um) / 2 if image.band_um else VISIBLE_UM
        extinction = sum(1000.0 * float(air.depth_per_m(middle)) for air in known)
        if scattering + self.absorption_per_km <= extinction * (1 + NEAR):
            return None
        return Caution(
            "scattering and extinction disagree: absorption_per_km and "
            f"scattering_per_km add up to {scattering + self.absorption_per_km:g} 1/km, but "
            f"the extinction of Atmospheric Path is {extinction:.4g} 1/km at {middle:g} µm",
            "lower absorption_per_km or scattering_per_km, or raise the extinction on Atmospheric "
            "Path",
        )

    @warning
    def wavelength(self, context: Context) -> Caution | None:
        """The wavelength lies outside the picture's band."""
        turbulent = self.turbulence not in ("gaussian", "none")
        particles = self.turbidity != "none" and self.particle_radius_um is not None
        if not (turbulent or particles):
            return None
        return wavelength_caution(context.band_um, self.wavelength_um, name="wavelength_um")

    @warning
    def aperture(self, context: Context) -> Caution | None:
        """The aperture differs from focal length divided by F-number."""
        if self.turbulence != "short_exposure" or not context.f_number:
            return None
        if context.focal_length_mm is None:
            return None
        return apart(
            self,
            {"aperture_mm": context.focal_length_mm / context.f_number},
            where="from focal_length_mm and f_number on Init & Trans",
            near=F_NUMBER_NEAR,
            remedy="make aperture_mm agree with focal_length_mm and f_number",
        )

    @readout("m")
    def r0_m(self, context: Context) -> float | None:
        """Fried parameter r0 at the blur's wavelength, entered or from Cn²; empty if not used."""
        if self.turbulence in ("gaussian", "none"):
            return None
        if self.fried_r0_m is not None:
            if self.r0_wavelength_um is None:
                return self.fried_r0_m
            return physics.fried_r0_at_m(
                fried_r0_m=self.fried_r0_m,
                from_wavelength_um=self.r0_wavelength_um,
                wavelength_um=self._wavelength(context),
            )
        if self.cn2 is None:
            raise ParameterError("fried_r0_m", None, "give fried_r0_m or cn2")
        path, wavelength = of_context("range_m", context), self._wavelength(context)
        if self.view == "horizontal":
            return physics.fried_r0_uniform_m(cn2=self.cn2, path_m=path, wavelength_um=wavelength)
        up = self.view == "up"
        return physics.fried_r0_slant_m(
            target_height_m=path if up else 0.0,
            sensor_height_m=0.0 if up else path,
            path_m=path,
            wavelength_um=wavelength,
            ground_cn2=self.cn2,
        )

    @readout()
    def optical_depth(self, context: Context) -> float:
        """Optical depth τ due to scattering alone."""
        if self.turbidity == "none":
            return 0.0
        if self.turbidity != "custom":
            return physics.turbidity_optical_depth(level=self.turbidity)
        if self.scatter_depth is not None:
            return self.scatter_depth
        if self.scattering_per_km == 0:
            return 0.0
        return physics.path_optical_depth(
            scattering_per_km=self.scattering_per_km,
            path_m=of_context("range_m", context),
            view=self.view,
            scale_height_km=self.scale_height_km,
        )

    @readout()
    def largest_change(self, outputs: MtfOutputs) -> Step | float:
        """Largest |1 − MTF| up to the image's Nyquist frequencies."""
        if not outputs.mtf.factors:
            return 0.0
        return Step.of(_largest_change, transfer=outputs.mtf)

    @readout()
    def negligible(self, outputs: MtfOutputs) -> Step | str:
        """Whether largest_change is below 1/256 (one 8-bit step)."""
        if not outputs.mtf.factors:
            return "yes"
        return Step.of(_negligible, Step.of(_largest_change, transfer=outputs.mtf))


def _by_bands(blur: tuple[Planar, ...], law: Law, bands: BandStack | None) -> tuple[Planar, ...]:
    if bands is None:
        return blur
    return tuple(at_each_band(one, AtWavelength(law), bands, "photons") for one in blur)


def _largest_change(work: Work, *, transfer: Transfer) -> float:
    """Look along the radius to the band's corner: every form here depends on ρ alone."""
    corner = np.hypot(transfer.grid.nyquist_x, transfer.grid.nyquist_y)
    line = transfer_plane(work, transfer, np.linspace(0.0, corner, 4097), np.zeros(1))
    return float(np.max(np.abs(1.0 - line)))


def _negligible(work: Work, largest: float) -> str:
    return "yes" if largest < NEGLIGIBLE else "no"
