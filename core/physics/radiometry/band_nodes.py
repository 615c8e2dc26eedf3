"""Wavelengths at which a band is integrated, in pieces on which Planck's law is smooth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.errors import ParameterError
from core.physics.numerics.quadrature import gauss_legendre
from core.physics.numerics.scalar_checks import positive

FloatArray = NDArray[np.float64]
_WIDEST_RATIO = 1.06  # of the ends of a piece: Planck's law is a polynomial of low degree on it
_NODES, _FEW_NODES, _MANY_PIECES = 24, 8, 100


def band_nodes(low: float, high: float, places: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    """Wavelengths and widths of a quadrature over a band, which breaks at the places in it."""
    positive("cut_on_um", low, unit="µm")
    if not low < high < math.inf:
        raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}", unit="µm")
    inner = [place for place in places if low < place < high]
    pieces = [low]
    for left, right in pairwise([low, *inner, high]):
        count = math.ceil(math.log(right / left) / math.log(_WIDEST_RATIO))
        pieces += np.geomspace(left, right, max(count, 1) + 1)[1:].tolist()
    ends = np.array(pieces)
    nodes, weights = gauss_legendre(_NODES if len(ends) < _MANY_PIECES else _FEW_NODES)
    half, middle = np.diff(ends) / 2.0, (ends[1:] + ends[:-1]) / 2.0
    wavelength = middle[:, np.newaxis] + half[:, np.newaxis] * nodes
    return wavelength.ravel(), (half[:, np.newaxis] * weights).ravel()
