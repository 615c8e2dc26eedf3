"""Anti-alias Filter: a low-pass before samples are dropped."""

import math
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.back_transformed import back_transform
from core.chain.wires import Image, Magnitude, Phase
from core.modules.declaration import Formula, Module, NodeContext, param, readout
from core.physics.optics.blur import gaussian_mtf
from core.physics.sampling.detector_sampling import block_mean_mtf
from core.transfer.factors import Grid
from nodes.shared.module_ports import ImageOutput, separable

Kernel = Literal["box", "gaussian", "lanczos"]
_LOBES = 3
# Half contrast at the new Nyquist frequency, 1/(2·factor) cycles/sample.
_SIGMA_SAMPLES = math.sqrt(2.0 * math.log(2.0)) / math.pi


class AntiAlias(Module, key="anti_alias", title="Anti-alias Filter", group="Transform"):
    """Filter out frequencies that would alias in a picture decimated by `factor`.

    No sample is dropped. Use this filter before Interpolate decimates with order 0, if there is no
    Detector MTF. `box` is the mean of `factor` samples, centred for even factors too. `gaussian`
    halves the contrast at the new Nyquist frequency.
    `lanczos` is a sinc with its cutoff at the new Nyquist frequency and a three-lobe window. The
    frame is mirrored at its edges. A factor of 1 changes nothing. Sources: Tantalo 1996, section
    4.1; Duchon 1979 (Lanczos).
    """

    formulas = (
        Formula(
            r"H(f)=\frac{\sin(\pi nf)}{n\,\sin(\pi f)}",
            where="f: cycles per sample; n: factor",
            when="box, n odd",
        ),
        Formula(
            r"H(f)=2^{-(2nf)^2}",
            where="H is one half at the new Nyquist frequency, 1/(2n)",
            when="gaussian",
        ),
        Formula(
            r"h(x)\propto\mathrm{sinc}\left(\frac{x}{n}\right)\mathrm{sinc}\left(\frac{x}{3n}"
            r"\right),\quad|x|<3n",
            where="h: weight of the sample at distance x",
            when="lanczos",
        ),
    )

    kernel: Kernel = param("box", "shape of the low-pass filter")
    factor: int = param(
        1, "factor of the later decimation", (1, 1024), unit="samples", slider=(1, 8)
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.factor == 1:
            return ImageOutput(image)
        grid = Grid(image.rows, image.columns, 1.0, 1.0)  # frequencies in cycles/sample
        law, bound = self._law()
        factors = separable(law, x=bound, y=bound, label=self.title, node=here.node)
        magnitude = Magnitude(image, grid).times(*factors)
        filtered = back_transform(magnitude, Phase(image, grid), node=here.node)
        return ImageOutput(image.with_recipe(filtered.recipe))

    def _law(self) -> tuple[Callable[..., Any], dict[str, Any]]:
        if self.kernel == "box":
            return block_mean_mtf, {"interval_mrad": 1.0, "samples": self.factor}
        if self.kernel == "lanczos":
            return lanczos_mtf, {"factor": self.factor}
        return gaussian_mtf, {"sigma_mrad": self.factor * _SIGMA_SAMPLES}  # samples

    @readout("cyc/mrad")
    def new_nyquist_x(self, axis: str, image: Image) -> float | None:
        """Horizontal Nyquist frequency after the later decimation."""
        interval = image.interval_x_mrad if axis == "x" else image.interval_y_mrad
        return None if interval is None else 0.5 / interval / self.factor


def lanczos_mtf(*, frequency: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Transfer function of sinc(k/n)·sinc(k/(3n)), |k| < 3n, of sum 1; f in cycles/sample.

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
