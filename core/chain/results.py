"""Computed values that are not plain arrays: curves, tables, sampled transfer functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.physics.detector.focal_plane_array import Irradiance
from core.physics.sampling.orbit import OrbitView


@dataclass(frozen=True)
class Series:
    """One curve: abscissa and ordinate of equal length."""

    label: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True)
class CurveMark:
    """An abscissa that is marked, such as the Nyquist frequency."""

    text: str
    x: float


@dataclass(frozen=True)
class CurveData:
    """Curves that share their axes, or bars that share their names.

    `bars` names the bars in order; each series then holds one height for each of them, at
    x = 0, 1, 2 and so on. With `log_y` the ordinate is shown by its logarithm, with `log_x` the
    abscissa; values that are infinite or not above 0 leave a gap. `marks` are abscissae to be
    marked.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    bars: tuple[str, ...] = ()
    log_y: bool = False
    log_x: bool = False
    marks: tuple[CurveMark, ...] = ()


@dataclass(frozen=True)
class TableRow:
    """A named figure; `reason` is why it has no value, where that is known."""

    name: str
    value: float | int | str | None
    unit: str = ""
    meaning: str = ""
    reason: str = ""


@dataclass(frozen=True)
class TableData:
    """Named figures in order."""

    rows: tuple[TableRow, ...]

    @classmethod
    def of(cls, *rows: tuple[Any, ...]) -> TableData:
        return cls(tuple(TableRow(*row) for row in rows))

    def as_dict(self) -> dict[str, float | int | str | None]:
        return {row.name: row.value for row in self.rows}


@dataclass(frozen=True)
class SampledTransfer:
    """A transfer function at frequencies of its own, in FFT order."""

    values: NDArray[Any]
    interval_x: float
    interval_y: float


# A camera's data as its sheet gives them: entered once, and carried by the image.


@dataclass(frozen=True)
class CameraSheet:
    """What is known of the camera that takes an image; empty fields are None.

    A pitch is from one pixel to the next; `fill_x` and `fill_y` are its sensitive share. `f_number`
    is as the radiometry takes it, `aperture_mm` the diameter of the entrance pupil, as diffraction
    takes it. `obscuration_ratio` is the inner over the outer diameter of the aperture, `t_number`
    the F-number of a clear, lossless lens that gives the same light, `irradiance` how the light
    goes with either. `range_m` is the distance to the scene.
    """

    pixels_x: int | None = None
    pixels_y: int | None = None
    pitch_x_um: float | None = None
    pitch_y_um: float | None = None
    focal_length_mm: float | None = None
    f_number: float | None = None
    aperture_mm: float | None = None
    obscuration_ratio: float = 0.0
    t_number: float | None = None
    irradiance: Irradiance = "disc"
    fill_x: float | None = None
    fill_y: float | None = None
    range_m: float | None = None
    orbit: OrbitView | None = None

    @property
    def pitch_x_mrad(self) -> float | None:
        return _angle(self.pitch_x_um, self.focal_length_mm)

    @property
    def pitch_y_mrad(self) -> float | None:
        return _angle(self.pitch_y_um, self.focal_length_mm)


def _angle(pitch_um: float | None, focal_length_mm: float | None) -> float | None:
    return pitch_um / focal_length_mm if pitch_um and focal_length_mm else None
