"""Gaussian MTF: blur that no other module accounts for."""

from core.chain.wires import Context, Magnitude
from core.modules.declaration import Formula, NodeContext, param
from core.physics.optics.blur import gaussian_mtf
from nodes.shared.module_ports import MtfModule, MtfOutputs


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
