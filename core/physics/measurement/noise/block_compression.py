"""Whether a picture was compressed in blocks of 8 × 8 samples, as JPEG does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.noise.picture_blocks import FINE, MIDDLE, SIDE, picture_blocks

Matrix = NDArray[np.float64]

_MOST_SIDE = 512  # samples along a side that are looked at
_LEAST_BLOCKS = 60
_DIFFERS = 0.1  # logarithm of what the blocks' waves and those of shifted blocks differ by
_CHANCES = 5.0  # standard errors of that


def compressed_in_blocks(*, picture: Matrix) -> bool:
    """Whether waves of the blocks from the first sample on are rounded, and of others not.

    Parameters
    ----------
    picture : ndarray, shape (rows, columns)
        Samples; the blocks start at its first one, as they do in a file that was not cut since.

    Notes
    -----
    The compression rounds the waves of its blocks, many to zero. The spread of a wave, and the
    shape of its distribution, by quartiles of its modulus, are then others than in blocks that lie
    half a block further, where nothing else makes them differ.
    """
    first = [max(0, (size - _MOST_SIDE) // 2) // SIDE * SIDE for size in picture.shape]
    part = picture[first[0] : first[0] + _MOST_SIDE, first[1] : first[1] + _MOST_SIDE]
    half = SIDE // 2
    own, shifted = picture_blocks(picture=part), picture_blocks(picture=part[half:, half:])
    if min(len(own.level), len(shifted.level)) < _LEAST_BLOCKS:
        return False
    waves = FINE | MIDDLE
    least = (1e-6 * max(float(np.abs(own.level).max()), 1e-300)) ** 2
    quartiles = []
    for blocks in (own, shifted):
        power = np.maximum(blocks.power[:, waves], least)
        quartiles.append(0.5 * np.log(np.quantile(power, (0.25, 0.75), axis=0)))
    differences = quartiles[0] - quartiles[1]
    for difference in (differences[1], differences[1] - differences[0]):
        mean = abs(float(difference.mean()))
        error = float(difference.std()) / np.sqrt(len(difference))
        if mean > _DIFFERS + _CHANCES * error * (mean < 3.0 * _DIFFERS):
            return True
    return False
