"""Anti-alias Filter: a low-pass before samples are dropped."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.back_transformed import back_transform
from core.chain.wires import Image, Magnitude, Phase
from core.modules.declaration import Module, NodeContext, readout
from core.modules.parameters import Formula, Param
from core.physics.optics.gaussian import gaussian_mtf
from core.transfer.factors import Grid
from nodes.shared.factors import separable
from nodes.shared.module_ports import ImageOutput

Kernel = Literal["box", "gaussian", "lanczos"]
_LOBES = 3
# Half contrast at the new Nyquist frequency, 1/(2·factor) cycles/sample.
_SIGMA_SAMPLES = math.sqrt(2.0 * math.log(2.0)) / math.pi


class AntiAlias(Module, key="anti_alias", title="Anti-alias Filter", group="Transform"):
    """Filter out frequencies that would alias if only every factor-th sample were kept.

    No sample is dropped. Use it for pictures that Interpolate then decimates with order 0, without
    a detector MTF. `box` is the centred mean of `factor` samples (for an even number, interpolated
    by its transfer function). `gaussian` has half contrast at the new Nyquist frequency. `lanczos`
    is a sinc with its cutoff there, in a window of three lobes. The frame is mirrored at its edges.
    A factor of 1 changes nothing. Sources: Tantalo 1996, section 4.1; Duchon 1979 (Lanczos).
    """

    formulas = (
        Formula(
            r"H(f)=\frac{\sin(\pi nf)}{n\,\sin(\pi f)}",
            where="f: cycles per sample; n: factor",
            when="box, n odd",
        ),
        Formula(
            r"H(f)=2^{-(2nf)^2}",
            where="one half at the new Nyquist frequency, 1/(2n)",
            when="gaussian",
        ),
        Formula(
            r"h(x)\propto\mathrm{sinc}\left(\frac{x}{n}\right)\mathrm{sinc}\left(\frac{x}{3n}"
            r"\right),\quad|x|<3n",
            where="h: weight of the sample at distance x",
            when="lanczos",
        ),
    )

    kernel: Annotated[Kernel, Param("shape of the low-pass")] = "box"
    factor: Annotated[
        int, Param("samples combined into one", unit="samples", low=1, high=1024, slider=(1, 8))
    ] = 1

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.factor == 1:
            return ImageOutput(image)
        grid = Grid(image.rows, image.columns, 1.0, 1.0)  # frequencies in cycles/sample
        if self.kernel == "gaussian":
            bound = {"sigma_mrad": self.factor * _SIGMA_SAMPLES}  # per sample, as the frequencies
            factors = separable(gaussian_mtf, x=bound, y=bound, label=self.title, node=here.node)
        else:
            law = box_mtf if self.kernel == "box" else lanczos_mtf
            width = {"factor": self.factor}
            factors = separable(law, x=width, y=width, label=self.title, node=here.node)
        magnitude = Magnitude(image, grid).times(*factors)
        filtered = back_transform(magnitude, Phase(image, grid), node=here.node)
        return ImageOutput(image.with_recipe(filtered.recipe))

    @readout("cyc/mrad")
    def new_nyquist_x(self, image: Image) -> float | None:
        """Horizontal Nyquist frequency after the samples are dropped."""
        return None if image.interval_x_mrad is None else 0.5 / image.interval_x_mrad / self.factor

    @readout("cyc/mrad")
    def new_nyquist_y(self, image: Image) -> float | None:
        """Vertical Nyquist frequency after the samples are dropped."""
        return None if image.interval_y_mrad is None else 0.5 / image.interval_y_mrad / self.factor


def box_mtf(*, frequency: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Transfer function of the mean of `factor` adjacent samples, centred.

    Parameters
    ----------
    frequency : ndarray
        Cycles/sample, |frequency| ≤ 1/2.
    factor : int
        Number of samples, 1 or more.

    Returns
    -------
    ndarray of float64
        sin(πnf)/(n·sin(πf)), 1 at f = 0.

    Notes
    -----
    Source: Bracewell 1986, the transform of a row of n impulses.
    """
    one = np.sin(np.pi * frequency)
    zero = one == 0.0
    return np.where(zero, 1.0, np.sin(np.pi * factor * frequency) / np.where(zero, 1, factor * one))


def lanczos_mtf(*, frequency: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Transfer function of sinc(k/n)·sinc(k/(3n)), |k| < 3n, of sum 1; arguments as `box_mtf`.

    Notes
    -----
    Source: Duchon 1979, Lanczos filtering in one and two dimensions.
    """
    k = np.arange(1, _LOBES * factor)
    weights = np.sinc(k / factor) * np.sinc(k / (_LOBES * factor))
    total, at_zero = np.ones(np.shape(frequency)), 1.0
    for lag, weight in zip(k, weights, strict=True):
        total += 2.0 * weight * np.cos(2.0 * np.pi * lag * frequency)
        at_zero += 2.0 * weight  # in the same order, so that the ratio at zero is 1 exactly
    return total / at_zero
