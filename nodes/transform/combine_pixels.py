"""Combine Pixels: aggregation of oversampled pixels."""

from __future__ import annotations

from typing import Annotated

from core.chain.back_transformed import BinMode, combine_pixels
from core.chain.wires import Image
from core.modules.declaration import Module, NodeContext
from core.modules.parameters import Param
from nodes.shared.module_ports import ImageOutput


class CombinePixels(Module, key="combine_pixels", title="Combine Pixels", group="Transform"):
    """Aggregate blocks of samples to one pixel, then keep that pixel only.

    Rows and columns left over at the bottom and right are dropped: 512 by 3 gives 170. Straight
    after Back Transform, and where the factors divide the size, the spectrum is folded instead.
    Source: Tantalo 1996, section 4.1, fig. 4.6.
    """

    factor_x: Annotated[
        int, Param("samples per pixel across", low=1, high=65536, slider=(1, 8))
    ] = 2
    factor_y: Annotated[int, Param("samples per pixel along", low=1, high=65536)] = 1
    mode: Annotated[BinMode, Param("mean (radiance) or sum (counts) of each block")] = "mean"

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        """Plan the aggregation; factors of 1 pass the image on."""
        if self.factor_x == 1 and self.factor_y == 1:
            return ImageOutput(image)
        return ImageOutput(
            combine_pixels(
                image,
                factor_x=self.factor_x,
                factor_y=self.factor_y,
                mode=self.mode,
                node=here.node,
            )
        )
