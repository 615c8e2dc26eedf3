"""Gaussian MTF and Veiling Glare: blur and stray light by a formula."""

from typing import Any, Literal

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.optics.blur import gaussian_mtf, harvey_mtf, harvey_scatter, veiling_glare_mtf
from nodes.shared.module_ports import MtfModule, MtfOutputs, radial


class GaussianMTF(MtfModule, key="gaussian_mtf", title="Gaussian MTF", group="Optics"):
    """Apply a Gaussian blur, for aberrations and other blur that no other module covers.

    The MTF is exp(−2π²(σx²·ξ² + σy²·η²)). Source: Tantalo 1996, eq. 4.22.
    """

    formulas = (
        Formula(
            r"H(\xi,\eta)=\exp\left[-2\pi^2(\sigma_x^2\,\xi^2+\sigma_y^2\,\eta^2)\right]",
            where="σ: standard deviation of the blur spot, mrad; ξ, η: cycles/mrad",
        ),
    )

    sigma_x_mrad: float = param(
        0.0, "horizontal standard deviation of the blur", low=0, slider=(0, 5)
    )
    sigma_y_mrad: float = param(
        0.0, "vertical standard deviation of the blur", low=0, slider=(0, 5)
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        sigmas = self.sigma_x_mrad, self.sigma_y_mrad
        x, y = ({"sigma_mrad": sigma} if sigma else None for sigma in sigmas)
        return self.separated(magnitude, here, gaussian_mtf, x=x, y=y)


class VeilingGlare(MtfModule, key="veiling_glare", title="Veiling Glare", group="Optics"):
    """Spread a share of the light over a wide area, like scatter and ghosts in the lens.

    The point spread function has two parts. A fraction 1 − g of the light is not scattered. The
    fraction g falls off with distance as ℓ/(2π(r² + ℓ²)^(3/2)), with half of this light within
    √3·ℓ. The MTF drops to 1 − g over a few cycles per ℓ: dark areas near bright ones become
    brighter, and fine detail loses a fraction g of its contrast. If g is not known otherwise, enter
    the veiling glare index of the lens, measured as in ISO 9358 in a small black area within an
    evenly bright field. Light that leaves the frame is mirrored or repeated, as Init & Trans
    defines.

    `harvey` models the scatter of optical surfaces instead: BSDF = b·[1 + ((β − β₀)/l)²]^(s/2),
    where β and β₀ are the sines of the angles of the scattered and the direct ray. The total
    integrated scatter (TIS) of a surface, the integral of BSDF·cos θ over the hemisphere, is lost
    from the direct light. Angles refer to the space in front of the lens, at the entrance pupil.
    For an ABg fit enter b = A/B, l = B^(1/g) and s = −g: the two models agree near the direct ray
    and far from it.

    Sources: ISO 9358:1994; Bracewell 2000, The Fourier Transform and Its Applications, table 13
    (Hankel transforms); Harvey and Shack 1978, Applied Optics 17, 3003; Stover 2012, Optical
    Scattering, section 4.5.
    """

    formulas = (
        Formula(
            r"H(\rho)=1-g+g\,e^{-2\pi\ell\rho}",
            where="g: fraction of the light that is scattered; ℓ: angular scale of the scatter, "
            "mrad; ρ: radial frequency",
            when="length",
        ),
        Formula(
            r"H(\rho)=\left(1-T(0)+T(\rho)\right)^n,\quad T(\rho)=2\pi b\int_0^1\left(1+\frac{"
            r"\beta^2}{l^2}\right)^{s/2}J_0(2\pi\rho\beta)\,\beta\,d\beta",
            where="T(0): total integrated scatter of a surface; n: surfaces; β: sine of the angle "
            "from the direct ray; ρ in cycles/rad",
            when="harvey",
        ),
    )

    form: Literal["length", "harvey"] = param(
        "length", "model of the scatter: share and angular scale, or Harvey's surface scatter"
    )

    share_percent: float = param(
        0.0, "share of the light that is scattered", (0, 100), slider=(0, 20)
    )
    length_mrad: float = param(
        10.0,
        "angular scale of the scatter: half of the scattered light falls within 1.73 times it",
        (0, 1e6),
        above=True,
        slider=(0.1, 100),
    )
    b_per_sr: float = param(0.0, "BSDF of a surface at the direct ray", (0, 1e12), slider=(0, 10))
    s: float = param(-1.5, "slope of the BSDF: exponent of β far from the direct ray", (-5, 0))
    l_mrad: float = param(
        10.0, "shoulder of the BSDF, 1000 times Harvey's l", (1e-3, 1000), slider=(0.1, 50)
    )
    surfaces: int = param(1, "number of scattering surfaces", (1, 1000), slider=(1, 30))

    panel = (
        Section("", "apply form"),
        Section("Stray light", "share_percent length_mrad", shown_when=("form", ("length",))),
        Section("", "b_per_sr s l_mrad surfaces", shown_when=("form", ("harvey",))),
    )

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        how: dict[str, Any] = {"label": self.title, "node": here.node}
        if not self.scatter_percent():
            return self.mtf_outputs(magnitude)
        if self.form == "harvey":
            how |= {**self._surface(), "surfaces": self.surfaces}
            return self.mtf_outputs(magnitude, *radial(harvey_mtf, **how))
        how |= {"share": self.share_percent / 100.0, "length_mrad": self.length_mrad}
        return self.mtf_outputs(magnitude, *radial(veiling_glare_mtf, **how))

    def _surface(self) -> dict[str, float]:
        return {"b_per_sr": self.b_per_sr, "s": self.s, "l_mrad": self.l_mrad}

    @warning
    def unused(self) -> Caution | None:
        """A stray-light value is entered that the chosen form does not use."""
        name, other = ("share_percent", "length") if self.form == "harvey" else (
            "b_per_sr", "harvey")  # fmt: skip
        value = getattr(self, name)
        if not value:
            return None
        return Caution(
            f"{name} = {value:g} is not used: form is {self.form}",
            f"set {name} to 0, or set form to {other}",
        )

    @readout("%")
    def scatter_percent(self) -> float:
        """Fraction of the light that is scattered."""
        if self.form == "length":
            return self.share_percent
        return 100.0 * (1.0 - (1.0 - harvey_scatter(**self._surface())) ** self.surfaces)
