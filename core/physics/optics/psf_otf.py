"""OTF of a sampled point spread function: its own Fourier sum at any frequencies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError
from core.physics.checks import positive

Array = NDArray[Any]
_SLACK = 1e-12  # of the samples' Nyquist frequency, which counts as within
_PAIRS = 1 << 20  # complex numbers held at a time where frequencies come in pairs


@dataclass(frozen=True)
class PointSpread:
    """A point spread function whose samples sum up to 1, shape (rows, columns), row 0 at the top.

    `column`, `row` are where the point is, counted from the first sample and between samples if
    need be; the centroid is its centre of gravity, likewise. `total` is the sum of the samples as
    they were.
    """

    weights: NDArray[np.float64]
    column: float
    row: float
    centroid_column: float
    centroid_row: float
    total: float

    @classmethod
    def of(
        cls, samples: ArrayLike, *, background: float = 0.0, keep_centroid: bool = True
    ) -> PointSpread:
        """Normalise samples, less a background; noise may make some negative.

        `keep_centroid`: whether the point is at the middle of the array, so that a centroid beside
        it shifts a picture; else it is at the centroid, and nothing is shifted.
        """
        values = np.asarray(samples, np.float64) - background
        if values.ndim != 2 or values.size == 0:
            raise DataError(
                f"a point spread function has shape {values.shape}; it must be two-dimensional "
                "(rows, columns) and not empty"
            )
        total = float(values.sum())
        # Of noise about 0 the sum is rounding and chance, by which nothing can be divided.
        if not total > 1e-6 * float(np.abs(values).sum()):
            raise DataError(
                f"the samples of a point spread function, minus a background of {background:g}, "
                f"sum to {total:g}; allowed: above 0"
            )
        weights = values / total
        rows, columns = weights.shape
        column = float(weights.sum(axis=0) @ np.arange(columns))
        row = float(weights.sum(axis=1) @ np.arange(rows))
        x, y = ((columns - 1) / 2, (rows - 1) / 2) if keep_centroid else (column, row)
        return cls(weights, x, y, column, row, total)


def sampled_psf_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    psf: PointSpread,
    pitch_x_mrad: float,
    pitch_y_mrad: float,
) -> Array:
    """OTF of a sampled point spread function, by its exact sum.

    Parameters
    ----------
    xi, eta : array_like
        Angular frequencies across and along, cycles/mrad; they broadcast, soonest as one row and
        one column.
    pitch_x_mrad, pitch_y_mrad : float
        From one sample to the next.

    Returns
    -------
    ndarray of complex128
        Σ w·exp(−2πi(xi·x + eta·y)), x to the right and y downwards from the point: a tail to the
        right makes tails to the right. Exactly 1 at frequency 0. Beyond the Nyquist frequency of
        the samples, where the sum only repeats itself, 0: a function sampled finely enough has
        nothing there.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-26 (OTF as the normalised transform
    of the point spread function); Shannon's theorem.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    x_mrad = positive("pitch_x_mrad", pitch_x_mrad, unit="mrad")
    y_mrad = positive("pitch_y_mrad", pitch_y_mrad, unit="mrad")
    rows, columns = psf.weights.shape
    x = x_mrad * (np.arange(columns) - psf.column)
    y = y_mrad * (np.arange(rows) - psf.row)
    if xi.ndim == eta.ndim == 2 and xi.shape[0] == eta.shape[1] == 1:
        # Rows first: they come in blocks, and the columns' waves are then few.
        otf = (_waves(eta[:, 0], y) @ psf.weights) @ _waves(x, xi[0])
    else:
        shape = np.broadcast_shapes(xi.shape, eta.shape)
        across, along = (np.broadcast_to(one, shape).ravel() for one in (xi, eta))
        otf = np.empty(across.size, np.complex128)
        step = max(1, _PAIRS // (rows + columns))
        for start in range(0, across.size, step):
            part = slice(start, start + step)
            sums = _waves(along[part], y) @ psf.weights
            otf[part] = np.sum(sums * _waves(across[part], x), axis=1)
        otf = otf.reshape(shape)
    known = (np.abs(xi) <= (0.5 + _SLACK) / x_mrad) & (np.abs(eta) <= (0.5 + _SLACK) / y_mrad)
    otf = np.where(known, otf, 0.0)
    return np.asarray(np.where((xi == 0.0) & (eta == 0.0), 1.0, otf), np.complex128)


def edge_share(psf: PointSpread) -> float:
    """Energy that a pedestal as high as the border's mean would have, a share of the whole.

    Of an aperture's diffraction pattern it is about the energy beyond the border: both fall with
    its distance.
    """
    weights = psf.weights
    border = np.concatenate([weights[0], weights[-1], weights[1:-1, 0], weights[1:-1, -1]])
    return float(abs(border.mean()) * weights.size)


def coarseness(psf: PointSpread) -> float:
    """Largest modulus of the OTF at the samples' Nyquist frequencies across and along.

    Above 0 the function has finer detail than its samples, which alias.
    """
    rows, columns = psf.weights.shape
    across = psf.weights.sum(axis=0) @ (-1.0) ** np.arange(columns)
    along = psf.weights.sum(axis=1) @ (-1.0) ** np.arange(rows)
    return float(max(abs(across), abs(along)))


def _waves(one: Array, other: Array) -> Array:
    return np.asarray(np.exp(-2j * np.pi * np.multiply.outer(one, other)), np.complex128)
