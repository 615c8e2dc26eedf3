"""Sampling of a frame in angle and the frequencies that belong to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.physics.sampling.detector_sampling import (
    frequency_interval_cyc_per_mrad,
    nyquist_cyc_per_mrad,
)

Vector = NDArray[np.float64]
Edges = Literal["reflect", "periodic"]
"""How a frame goes on beyond its edges."""


@dataclass(frozen=True)
class Grid:
    """Samples of a frame: `rows` × `columns` at the given angular intervals (mrad)."""

    rows: int
    columns: int
    interval_x_mrad: float
    interval_y_mrad: float

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def nyquist_x(self) -> float:
        """Nyquist frequency across, cycles/mrad (Tantalo 1996, eq. 4.2)."""
        return nyquist_cyc_per_mrad(interval_mrad=self.interval_x_mrad)

    @property
    def nyquist_y(self) -> float:
        """Nyquist frequency along, cycles/mrad."""
        return nyquist_cyc_per_mrad(interval_mrad=self.interval_y_mrad)

    @property
    def frequency_interval_x(self) -> float:
        """Spacing of the plain FFT's frequencies across, cycles/mrad (eq. 4.3)."""
        return frequency_interval_cyc_per_mrad(
            interval_mrad=self.interval_x_mrad, samples=self.columns
        )

    @property
    def frequency_interval_y(self) -> float:
        """Spacing of the plain FFT's frequencies along, cycles/mrad."""
        return frequency_interval_cyc_per_mrad(
            interval_mrad=self.interval_y_mrad, samples=self.rows
        )

    def xi(self) -> Vector:
        """Frequencies across in FFT order (an even size has −Nyquist), shape (columns,)."""
        return np.asarray(scipy.fft.fftfreq(self.columns, self.interval_x_mrad), np.float64)

    def eta(self) -> Vector:
        """Frequencies along in FFT order, shape (rows,)."""
        return np.asarray(scipy.fft.fftfreq(self.rows, self.interval_y_mrad), np.float64)

    def xi_half(self) -> Vector:
        """Frequencies of the half spectrum, 0 … +Nyquist, shape (columns // 2 + 1,)."""
        return np.asarray(scipy.fft.rfftfreq(self.columns, self.interval_x_mrad), np.float64)

    def xi_mirrored(self) -> Vector:
        """Frequencies k/(2·columns·interval) of the mirrored frame, k = 0 … columns − 1."""
        return np.arange(self.columns) / (2.0 * self.columns * self.interval_x_mrad)

    def eta_mirrored(self) -> Vector:
        """Frequencies k/(2·rows·interval) of the mirrored frame, k = 0 … rows − 1."""
        return np.arange(self.rows) / (2.0 * self.rows * self.interval_y_mrad)
