"""Jitter MTF: random line-of-sight motion."""

import math

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Formula, NodeContext, param, readout
from core.physics.optics.blur import gaussian_mtf
from nodes.shared.module_ports import MtfModule, MtfOutputs


class JitterMTF(MtfModule, key="jitter_mtf", title="Jitter MTF", group="Motion"):
    """Blur by random line-of-sight motion within one exposure, with a Gaussian distribution.

    The MTF is exp(−2π²σ²(ξ² + η²)). Source: Tantalo 1996, eq. 4.36, after Pinsky 1991 (typical
    rms motion: 20 to 60 µrad). Erratum: the thesis calls σ² the variance in µrad and gives σ in
    mrad.
    """

    formulas = (
        Formula(
            r"H(\xi,\eta)=e^{-2\pi^2\sigma^2(\xi^2+\eta^2)}",
            where="σ: rms jitter per axis within an exposure, mrad",
        ),
    )

    sigma_mrad: float = param(0.02, "rms line-of-sight motion per axis", low=0, slider=(0, 1))

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        sigma = {"sigma_mrad": self.sigma_mrad} if self.sigma_mrad else None
        return self.separated(magnitude, here, gaussian_mtf, x=sigma, y=sigma)

    @readout("cyc/mrad")
    def half_contrast(self) -> float | None:
        """MTF50: frequency at which the MTF is 0.5."""
        return math.sqrt(math.log(2) / 2) / (math.pi * self.sigma_mrad) if self.sigma_mrad else None
