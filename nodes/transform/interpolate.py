"""Interpolate: other numbers of samples over the same field, as a frame grabber takes them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.declaration import Here, Module
from core.parameters import Param
from core.recipes import Step
from core.values import Image
from core.work import Work
from nodes.ports import ImageOutput

Array = NDArray[Any]
Taps = tuple[NDArray[np.intp], list[tuple[NDArray[np.intp], NDArray[np.float64]]]]
_BLOCK_SAMPLES = 1 << 16


class Interpolate(Module, key="interpolate", title="Interpolate", group="Transform"):
    """Resample the picture to another size over the same field of view.

    Sample centres lie half an interval from the frame's edges, beyond which the outermost samples
    go on. Nothing is filtered: making a picture smaller aliases, as in a frame grabber. Order 0
    takes the nearest sample, 1 is bilinear, 3 cubic convolution. Equal sizes pass the picture on.
    Sources: Tantalo 1996, sections 5.1 and 5.2 (bilinear); Keys 1981 (cubic, a = −1/2).
    """

    width: Annotated[
        int | None, Param("samples across; empty: as before", low=1, high=65536, slider=(16, 2048))
    ] = None
    height: Annotated[
        int | None, Param("samples along; empty: as before", low=1, high=65536, slider=(16, 2048))
    ] = None
    order: Annotated[Literal[0, 1, 3], Param("0 nearest, 1 bilinear, 3 cubic")] = 1

    def run(self, image: Image, here: Here) -> ImageOutput:
        """Plan the resampling."""
        width, height = self.width or image.columns, self.height or image.rows
        if (height, width) == image.shape:
            return ImageOutput(image)
        recipe = Step.of(
            resampled, image.recipe, node=here.node, width=width, height=height, order=self.order
        )
        x, y = image.interval_x_mrad, image.interval_y_mrad
        return ImageOutput(
            image.with_recipe(
                recipe,
                rows=height,
                columns=width,
                interval_x_mrad=None if x is None else x * image.columns / width,
                interval_y_mrad=None if y is None else y * image.rows / height,
            )
        )


def resampled(work: Work, image: Array, *, width: int, height: int, order: int) -> Array:
    """The image at `height` × `width` samples; along first, then across, by blocks of rows."""
    base_y, further_y = taps(image.shape[0], height, order)
    base_x, further_x = taps(image.shape[1], width, order)
    result = np.empty((height, width), work.policy.dtype)

    def block(rows: slice) -> None:
        wanted = [(index[rows], weight[rows, np.newaxis]) for index, weight in further_y]
        lines = _combined(image, base_y[rows], wanted, axis=0)
        if width != image.shape[1]:
            lines = _combined(lines, base_x, further_x, axis=1)
        result[rows] = lines

    step = max(1, _BLOCK_SAMPLES // max(width, image.shape[1]))
    work.each(block, [slice(start, start + step) for start in range(0, height, step)])
    return result


def _combined(
    image: Array,
    base: NDArray[np.intp],
    further: list[tuple[NDArray[np.intp], NDArray[np.float64]]],
    axis: int,
) -> Array:
    """Samples at `base` and their weighted differences to those at the further indices."""
    near = np.take(image, base, axis=axis)
    total = near
    for index, weight in further:
        part = np.take(image, index, axis=axis)
        part -= near
        part *= weight.astype(image.dtype)
        total = np.add(total, part, out=part)
    return total


def taps(old: int, new: int, order: int) -> Taps:
    """Where each new sample is taken from along one axis.

    Parameters
    ----------
    old, new : int
        Samples before and after, which span the same field.
    order : 0, 1 or 3
        Nearest, linear or cubic.

    Returns
    -------
    base : ndarray of int, shape (new,)
        Index of the sample at or before each new one (order 0: the nearest).
    further : list of (index, weight)
        What is added: weight·(sample at index − sample at base). Written as differences, a
        constant image stays constant to the last bit.
    """
    number = np.arange(new, dtype=np.int64)
    # Whole numbers of 1/(2·new) of a sample: exact, so that ties fall alike everywhere.
    doubled = (2 * number + 1) * old
    if order == 0:
        return (doubled // (2 * new)).astype(np.intp), []
    whole, rest = np.divmod(doubled - new, 2 * new)
    t = rest / (2 * new)

    def clamped(offset: int) -> NDArray[np.intp]:
        return np.asarray(np.clip(whole + offset, 0, old - 1), np.intp)

    if order == 1:
        return clamped(0), [(clamped(1), t)]
    return clamped(0), [
        (clamped(-1), t * (-0.5 + t * (1.0 - 0.5 * t))),
        (clamped(1), t * (0.5 + t * (2.0 - 1.5 * t))),
        (clamped(2), t * t * (-0.5 + 0.5 * t)),
    ]
