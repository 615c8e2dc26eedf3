"""Combine Pixels: aggregation of oversampled pixels."""

from core.chain.back_transformed import BinMode, combine_pixels
from core.chain.wires import Image
from core.modules.declaration import Caution, Formula, Module, NodeContext, param, warning
from core.physics.sampling.detector_sampling import block_mean_mtf
from nodes.shared.module_ports import ImageOutput
from nodes.transform.sample_pixels import detector_averages, width_mrad

_DIRECTIONS = {"x": "horizontally", "y": "vertically"}
_OF_A_PIXEL = 0.35  # of a block's width; a narrower average takes 5 % off at Nyquist, or less


class CombinePixels(Module, key="combine_pixels", title="Combine Pixels", group="Transform"):
    """Combine each block of samples into one pixel.

    Rows and columns left over at the bottom and right are dropped: 512 samples in blocks of 3 give
    170 pixels. Directly after Back Transform, if the factors divide the picture's size exactly, the
    module folds the spectrum instead of combining samples. The mean of a block represents the
    pixel's averaging over its area. After Detector MTF, which already averages over the pixel, use
    Sample Pixels instead. Source: Tantalo 1996, section 4.1, fig. 4.6.
    """

    formulas = (
        Formula(
            r"L'_{j,k}=\frac{1}{nm}\sum_{a=0}^{m-1}\sum_{b=0}^{n-1}L_{jm+a,\,kn+b}",
            where="n, m: factor_x and factor_y; for `sum`, 1/(nm) is left out",
        ),
        Formula(
            r"H(\xi)=\frac{\sin(\pi n\xi\Delta)}{n\,\sin(\pi\xi\Delta)}",
            where="H: transfer function of the block mean, before aliasing; Δ: sampling interval",
        ),
    )

    factor_x: int = param(2, "samples per pixel, horizontally", (1, 65536), slider=(1, 8))
    factor_y: int = param(1, "samples per pixel, vertically", (1, 65536))
    mode: BinMode = param("mean", "mean (radiance) or sum (counts) of each block")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.factor_x == 1 and self.factor_y == 1:
            return ImageOutput(image)
        return ImageOutput(combine_pixels(image, **self.values(), node=here.node))

    @warning
    def pixel_counted_twice(self, image: Image) -> Caution | None:
        """The pixel is averaged twice: by Detector MTF and by this node."""
        averages = detector_averages(image)
        for axis, interval, factor in (
            ("x", image.interval_x_mrad, self.factor_x),
            ("y", image.interval_y_mrad, self.factor_y),
        ):
            widths = [(width_mrad(average, axis), average) for average in averages]
            width, average = max(widths, key=lambda pair: pair[0], default=(0.0, None))
            if average is not None and width > 0 and interval is not None and factor > 1:
                detector = f"{average.label} ({average.node})"
                return _twice(detector, width, interval, factor, _DIRECTIONS[axis])
        return None


def _twice(
    detector: str, width_mrad: float, interval_mrad: float, factor: int, direction: str
) -> Caution:
    block = factor * interval_mrad
    left = block_mean_mtf(frequency=0.5 / block, interval_mrad=interval_mrad, samples=factor)
    if width_mrad < _OF_A_PIXEL * block:
        return Caution(
            f"the pixels do not match the detector: blocks of {factor} samples average over "
            f"{block:.4g} mrad {direction}, but {detector} averages over {width_mrad:.4g} "
            "mrad; both averages act on the picture",
            "use Sample Pixels with the detector's pitch on a scene sampled more finely; "
            "ignore this warning if the blocks represent the pixels, as in the 1996 networks",
        )
    return Caution(
        f"the pixel is averaged twice: over {width_mrad:.4g} mrad {direction} by {detector}, then "
        f"over {block:.4g} mrad by blocks of {factor} samples; the second average multiplies the "
        f"contrast at Nyquist by {float(left):.3g}",
        "use Sample Pixels instead of this node, or leave Detector MTF out; ignore this warning if "
        "both averages are intended, as in the 1996 networks",
    )
