"""How a detector or a filter responds over wavelength: points, a rectangle, or a Gaussian."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.numerics.scalar_checks import positive, within
from core.physics.radiometry.band_nodes import band_nodes
from core.physics.radiometry.planck import spectral_radiance

FloatArray = NDArray[np.float64]
Shape = Literal["file", "rectangle", "gaussian"]
_NEAR = 1e-12  # by which a form may end before a band
_REACH = 6.0  # standard deviations, beyond which a Gaussian is below 2e-8
_PIECES = 48  # of a Gaussian on which a quadrature of 24 nodes or 8 is exact


@dataclass(frozen=True)
class ResponseCurve:
    """Response over wavelength.

    Parameters
    ----------
    shape : "file", "rectangle" or "gaussian"
        Points joined by straight lines, or one of the two forms.
    centre_um, width_um : float
        Of a form: its middle, and its whole width or its full width at half maximum; above 0.
    peak : float
        Of a form, 0 to 1.
    points : tuple of (float, float)
        Wavelength in µm, rising, and response; beyond the first and last it is 0.

    Raises
    ------
    ParameterError
        For a value out of range.
    """

    shape: Shape
    centre_um: float = 1.0
    width_um: float = 1.0
    peak: float = 1.0
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if self.shape == "file":
            if len(self.points) < 2:
                raise ParameterError("path", len(self.points), "two points of a response or more")
            return
        positive("centre_um", self.centre_um, unit="µm")
        positive("width_um", self.width_um, unit="µm")
        within("peak", self.peak, 0.0, 1.0)

    @property
    def _sigma_um(self) -> float:
        return self.width_um / (2.0 * math.sqrt(2.0 * math.log(2.0)))

    @property
    def ends_um(self) -> tuple[float, float]:
        """Between which it is not 0, or next to it."""
        if self.shape == "file":
            return self.points[0][0], self.points[-1][0]
        half = self.width_um / 2.0 if self.shape == "rectangle" else _REACH * self._sigma_um
        return max(self.centre_um - half, 0.0), self.centre_um + half

    @property
    def bends_um(self) -> tuple[float, ...]:
        """Wavelengths between which it is smooth."""
        if self.shape == "file":
            return tuple(place for place, _ in self.points)
        if self.shape == "rectangle":
            return self.ends_um
        return tuple(np.linspace(*self.ends_um, _PIECES + 1).tolist())

    def at(self, wavelength_um: ArrayLike) -> FloatArray:
        """Response at wavelengths, µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.shape == "file":
            known, values = np.array(self.points).T
            return np.asarray(np.interp(wavelength, known, values, left=0.0, right=0.0))
        if self.shape == "rectangle":
            low, high = self.ends_um
            return np.where((wavelength >= low) & (wavelength <= high), self.peak, 0.0)
        away = (wavelength - self.centre_um) / self._sigma_um
        return np.asarray(self.peak * np.exp(-0.5 * away * away))

    def integral(self, low_um: float, high_um: float) -> float:
        """∫ R dλ, µm; exact."""
        if not low_um < high_um:
            return 0.0
        if self.shape == "gaussian":
            root = self._sigma_um * math.sqrt(2.0)
            ends = [math.erf((end - self.centre_um) / root) for end in (low_um, high_um)]
            return self.peak * self._sigma_um * math.sqrt(math.pi / 2.0) * (ends[1] - ends[0])
        first, last = self.ends_um
        low, high = max(low_um, first), min(high_um, last)
        if not low < high:
            return 0.0
        if self.shape == "rectangle":
            return self.peak * (high - low)
        known = np.array([place for place, _ in self.points])
        ends_of = np.array([low, *known[(known > low) & (known < high)], high])
        values = self.at(ends_of)
        return float(np.sum((values[1:] + values[:-1]) / 2.0 * np.diff(ends_of)))

    def is_one_over(self, low_um: float, high_um: float) -> bool:
        """Whether it is 1 all over a band."""
        first, last = self.ends_um
        if first > low_um * (1.0 + _NEAR) or last < high_um * (1.0 - _NEAR):
            return False
        if self.shape == "file":
            # Between two points both count, also where neither lies in the band.
            ends = self.at(np.clip([low_um, high_um], first, last))
            inside = (value for place, value in self.points if low_um <= place <= high_um)
            return bool(np.all(ends == 1.0)) and all(value == 1.0 for value in inside)
        return self.shape == "rectangle" and self.peak == 1.0

    def mean(self, low_um: float, high_um: float) -> float:
        """Mean over a band whose spectrum is flat."""
        return self.integral(low_um, high_um) / (high_um - low_um)

    def mean_of_body(self, cut_on_um: float, cut_off_um: float, *, source_K: float) -> float:
        """Mean over a band by the radiance of a black body.

        Raises
        ------
        DataError
            For a source that emits nothing in the band.
        """
        inside = tuple(place for place in self.bends_um if cut_on_um < place < cut_off_um)
        wavelength, width = band_nodes(cut_on_um, cut_off_um, inside)
        weight = width * spectral_radiance(wavelength, source_K)
        total = float(weight.sum())
        if not total > 0.0:
            raise DataError(
                f"a black body of {source_K:g} K emits nothing from {cut_on_um:g} to "
                f"{cut_off_um:g} µm, and cannot weight the response there"
            )
        return float(weight @ self.at(wavelength)) / total
