"""Glare MTF: light that surfaces scatter into a wide halo."""

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from imagechain.plug_in import (
    Context,
    Magnitude,
    MtfModule,
    MtfOutputs,
    NodeContext,
    Param,
    ParameterError,
    radial,
    readout,
)


def glare_mtf(
    *, rho: ArrayLike, scattered_share: float, halo_sigma_mrad: float
) -> NDArray[np.float64]:
    """MTF of a sharp image under a Gaussian halo.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad.
    scattered_share : float
        Share of the light that is scattered, 0 to 1.
    halo_sigma_mrad : float
        Standard deviation of the halo, mrad.

    Returns
    -------
    ndarray
        1 − g + g·exp(−2π²s²ρ²).

    Raises
    ------
    ParameterError
        For a share outside of 0 to 1.

    Notes
    -----
    The specular and the scattered light add: Harvey 1976, Light-Scattering Characteristics of
    Optical Surfaces.
    """
    if not 0.0 <= scattered_share <= 1.0:
        raise ParameterError("scattered_share", scattered_share, "0 to 1")
    halo = np.exp(-2.0 * (np.pi * halo_sigma_mrad * np.asarray(rho)) ** 2)
    return np.asarray(1.0 - scattered_share * (1.0 - halo))


class GlareMTF(MtfModule, key="imagechain_glare.glare_mtf", title="Glare MTF", group="Optics"):
    """Lower the contrast by light that surfaces and dust scatter into a wide halo.

    1 − g + g·exp(−2π²s²ρ²). Source: Harvey 1976, Light-Scattering Characteristics of Optical
    Surfaces.
    """

    scattered_share: Annotated[
        float, Param("share of the light that is scattered", low=0, high=1, slider=(0, 0.3))
    ] = 0.05
    halo_sigma_mrad: Annotated[
        float, Param("standard deviation of the halo", unit="mrad", low=0, slider=(0, 50))
    ] = 10.0

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        """Plan the blur."""
        if not (self.scattered_share and self.halo_sigma_mrad):
            return self.mtf_outputs(magnitude)
        factors = radial(
            glare_mtf,
            scattered_share=self.scattered_share,
            halo_sigma_mrad=self.halo_sigma_mrad,
            label=self.title,
            node=here.node,
        )
        return self.mtf_outputs(magnitude, *factors)

    @readout("%")
    def contrast_left(self) -> float:
        """Contrast that is left of details much finer than the halo."""
        return 100.0 * (1.0 - self.scattered_share)
