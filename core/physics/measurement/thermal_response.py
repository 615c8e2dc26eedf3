"""Signal transfer (SiTF) and NETD of a camera from frames of black bodies at known temperatures.

SiTF is the change of the camera's numbers with the temperature of a field that fills many pixels;
NETD is noise over SiTF: the change of temperature that is as large as the noise.

Source: Holst, Testing and Evaluation of Infrared Imaging Systems, chapters on SiTF and on noise;
D'Agostino and Webb 1991 for the components of the noise; Sakuma and Hattori 1983 for a radiometer's
response as Planck's law at one wavelength.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.arrays import Mask, Vector
from core.errors import DataError
from core.physics.measurement.photon_transfer import FlatField
from core.physics.noise.noise_components import COMPONENTS, MeasuredNoise
from core.physics.radiometry.planck import SECOND_RADIATION_CONSTANT_UM_K
from core.records import dataclass

_OF_TIME = ("tvh", "tv", "th", "t")
_LEAST_RISE = 5.0  # standard errors of the slope
_CURVED = 3  # temperatures, from which on the curve is known
_WIDTHS = (3e-3, 100.0)  # c₂/λ over temperature: at 300 K from a straight line to 0.5 µm
_GRID = 120
_WIDTH_KNOWN = 1e-9  # of it
_BAND = 3e-6  # of SiTF, by K² of the span: a band's response is not that of one wavelength
_CHORD = 3e-5  # the same of two temperatures, midway; by K
_CHORD_END = 0.02  # and at the two: a response that grows by 4 % of itself with a kelvin


@dataclass(frozen=True)
class ThermalField:
    """A uniform field of known temperature."""

    temperature_K: float  # of the black body, less what it emits short of one
    field: FlatField  # mean and patterns of the frames
    noise: MeasuredNoise  # its seven components, without bad pixels


@dataclass(frozen=True)
class NoiseTemperature:
    """Response and noise at one temperature."""

    temperature_K: float
    # numbers of a kelvin there, and the standard error
    sitf: float
    sitf_error: float
    # noise that is random in time, row and column (σ_tvh) over SiTF, and the standard error
    netd_K: float
    netd_error_K: float
    temporal_K: float  # all that changes from frame to frame, over SiTF
    # each of the seven components over SiTF; below 0 for a variance estimated below 0
    components_K: dict[str, float]


@dataclass(frozen=True)
class ThermalResponse:
    """What fields of several temperatures give."""

    middle: NoiseTemperature  # midway between the lowest and the highest temperature
    levels: tuple[NoiseTemperature, ...]  # at each field's temperature
    # of Planck's law that the means follow, and the standard error; None of two temperatures, or
    # where the means are on a straight line
    wavelength_um: float | None
    wavelength_error_um: float | None
    # largest departure of a mean from that law, of the means' span; None where it goes through all,
    # as through three
    departure_percent: float | None


def thermal_response(fields: Sequence[ThermalField]) -> ThermalResponse:
    """SiTF and NETD.

    Parameters
    ----------
    fields
        In any order, of two temperatures or more.

    Raises
    ------
    DataError
        There is one temperature only, or the mean does not change with it.

    The means are taken as O + R/(exp(B/T) − 1), Planck's law at a wavelength c₂/B, whose three
    numbers follow by least squares; SiTF is its slope. Of bands of 1.5–5, 3–5 and 7.5–13.5 µm it is
    within 3e-6 (ΔT/K)² of the truth (0.03 % over 10 K, where a parabola errs by 0.3 to 0.7 % at 3–5
    µm). Of two temperatures the slope is that of a straight line: midway within 3e-5 (ΔT/K)² of the
    truth (0.3 % over 10 K), at the two themselves off by up to a fifth over 10 K. Standard errors
    hold these, and the noise of the means; temperatures are taken as exact. Noise midway is that
    between the neighbouring levels' variances.
    """
    ordered = sorted(fields, key=lambda one: one.temperature_K)
    kelvin = np.array([one.temperature_K for one in ordered])
    many = len(set(kelvin.tolist()))
    if many < 2:
        raise DataError(f"SiTF needs frames at two or more temperatures, not {many}")
    means = np.array([one.field.mean_dn for one in ordered])
    variance = np.array([_variance_of_mean(one.noise) for one in ordered])
    middle = float(kelvin[0] + kelvin[-1]) / 2.0
    span = float(np.ptp(kelvin))
    chord = _Law.fitted(kelvin, means)
    rise, of_rise = chord.slopes(np.array([middle]), variance)
    law = chord if many < _CURVED else _Law.of_planck(kelvin, means)
    slope, error = law.slopes(np.append(kelvin, middle), variance)
    later = np.diff(kelvin) > 0.0
    falls = np.diff(means)[later] * rise[0] <= 0.0
    if not abs(rise[0]) > _LEAST_RISE * of_rise[0] or falls.any() or (slope * rise[0] <= 0.0).any():
        raise DataError(
            "the mean signal must rise or fall steadily with temperature, by more than its noise; "
            "the means are "
            + ", ".join(f"{mean:.6g} at {at:.6g} K" for mean, at in zip(means, kelvin, strict=True))
        )
    allowed = np.full(len(slope), _BAND * span**2)
    if many < _CURVED:
        allowed[:-1] = _CHORD_END * span
        allowed[-1] = _CHORD * span**2
    error = np.hypot(error, allowed * slope)
    levels = [{name: one.noise.variances.variance(name) for name in COMPONENTS} for one in ordered]
    errors = [one.noise.errors.tvh for one in ordered]
    levels.append({name: float(np.interp(middle, kelvin, [one[name] for one in levels]))
                   for name in COMPONENTS})  # fmt: skip
    errors.append(float(np.interp(middle, kelvin, errors)))
    figures = [
        _figures(*one)
        for one in zip(
            [*kelvin.tolist(), middle], slope.tolist(), error.tolist(), levels, errors, strict=True
        )
    ]
    wavelength, of_wavelength = law.wavelength(variance)
    departure = None
    if many > _CURVED:
        departure = 100.0 * float(np.max(np.abs(means - law.at(kelvin))) / np.ptp(means))
    return ThermalResponse(figures[-1], tuple(figures[:-1]), wavelength, of_wavelength, departure)


def filled(frame: NDArray[np.floating], good: Mask) -> Vector:
    """The frame with the sample of the good pixel nearest along the rows in place of a bad one."""
    if good.all():
        return np.asarray(frame, np.float64)
    if not good.any():
        raise DataError("every pixel responds differently: these are not frames of uniform fields")
    samples = np.array(frame, np.float64)
    known, wanted = np.flatnonzero(good), np.flatnonzero(~good)
    after = np.searchsorted(known, wanted).clip(1, max(known.size - 1, 1)) if known.size > 1 else 0
    later, earlier = known[after], known[after - 1]
    nearest = np.where(later - wanted < wanted - earlier, later, earlier)
    samples.flat[wanted] = samples.flat[nearest]
    return samples


def _variance_of_mean(noise: MeasuredNoise) -> float:
    shares = {
        "t": noise.frames,
        "tv": noise.frames * noise.rows,
        "th": noise.frames * noise.columns,
        "tvh": noise.frames * noise.rows * noise.columns,
    }
    return math.fsum(
        max(noise.variances.variance(name), 0.0) / count for name, count in shares.items()
    )


@dataclass(frozen=True)
class _Law:
    """Means over temperature: level + rise · shape, and what the means do to its numbers.

    `width_K` is B; None for a straight line.
    """

    kelvin: Vector
    level: float
    rise: float
    width_K: float | None
    effect: NDArray[np.float64]

    @classmethod
    def of_planck(cls, kelvin: Vector, means: Vector) -> "_Law":
        grid = np.geomspace(_WIDTHS[0] * kelvin.max(), _WIDTHS[1] * kelvin.min(), _GRID)
        best = int(np.argmin([_left(kelvin, means, width) for width in grid]))
        if best in (0, _GRID - 1):
            return cls.fitted(kelvin, means)
        while grid[-1] - grid[0] > _WIDTH_KNOWN * grid[0]:
            grid = np.geomspace(grid[max(best - 1, 0)], grid[min(best + 1, _GRID - 1)], _GRID)
            best = int(np.argmin([_left(kelvin, means, width) for width in grid]))
        return cls.fitted(kelvin, means, float(grid[best]))

    @classmethod
    def fitted(cls, kelvin: Vector, means: Vector, width: float | None = None) -> "_Law":
        columns = [np.ones_like(kelvin), _shape(kelvin, width, kelvin)[0]]
        level, rise = np.linalg.pinv(np.stack(columns, axis=1)) @ means
        if width is not None:
            columns.append(rise * _by_width(kelvin, width, kelvin)[0])
        effect = np.linalg.pinv(np.stack(columns, axis=1))
        return cls(kelvin, float(level), float(rise), width, effect)

    def at(self, kelvin: Vector) -> Vector:
        return self.level + self.rise * _shape(kelvin, self.width_K, self.kelvin)[0]

    def slopes(self, at: Vector, variance: Vector) -> tuple[Vector, Vector]:
        steep = _shape(at, self.width_K, self.kelvin)[1]
        columns = [np.zeros_like(at), steep]
        if self.width_K is not None:
            columns.append(self.rise * _by_width(at, self.width_K, self.kelvin)[1])
        by_mean = np.stack(columns, axis=1) @ self.effect
        return self.rise * steep, np.sqrt(by_mean**2 @ variance)

    def wavelength(self, variance: Vector) -> tuple[float | None, float | None]:
        if self.width_K is None:
            return None, None
        wavelength = SECOND_RADIATION_CONSTANT_UM_K / self.width_K
        return wavelength, wavelength * math.sqrt(float(self.effect[2] ** 2 @ variance))


def _shape(kelvin: Vector, width: float | None, about: Vector) -> tuple[Vector, Vector]:
    """Rises by about 1 over the temperatures: (T − T₀)/ΔT, or Planck's law with 0 at T₀.

    With its slope.
    """
    centre, span = float(about.mean()), float(np.ptp(about))
    if width is None:
        return (kelvin - centre) / span, np.full_like(kelvin, 1.0 / span)
    risen = np.expm1(width / centre) / np.expm1(width / kelvin)
    scale = _planck_slope(np.array(centre), width) * span
    slope = risen * _planck_slope(kelvin, width) / scale
    return np.asarray((risen - 1.0) / scale), np.asarray(slope)


def _planck_slope(kelvin: Vector, width: float) -> Vector:
    """Derivative of 1/(exp(B/T) − 1) over itself, 1/K."""
    return np.asarray(width / kelvin**2 / -np.expm1(-width / kelvin))


def _by_width(kelvin: Vector, width: float, about: Vector) -> NDArray[np.float64]:
    """What both change by with the logarithm of the width."""
    step = 1e-4
    up, down = (np.stack(_shape(kelvin, width * math.exp(sign * step), about)) for sign in (1, -1))
    return np.asarray((up - down) / (2.0 * step))


def _left(kelvin: Vector, means: Vector, width: float) -> float:
    design = np.stack([np.ones_like(kelvin), _shape(kelvin, width, kelvin)[0]], axis=1)
    return float(np.sum((means - design @ (np.linalg.pinv(design) @ means)) ** 2))


def _figures(
    at: float, rise: float, of_rise: float, variances: dict[str, float], of_noise: float
) -> NoiseTemperature:
    steep = abs(rise)
    random = max(variances["tvh"], 0.0)
    netd = math.sqrt(random) / steep
    own = of_noise / (2.0 * random) if random > 0.0 else 0.0
    temporal = math.sqrt(math.fsum(max(variances[name], 0.0) for name in _OF_TIME))
    return NoiseTemperature(
        at,
        rise,
        of_rise,
        netd,
        netd * math.hypot(own, of_rise / steep),
        temporal / steep,
        {
            name: math.copysign(math.sqrt(abs(value)), value) / steep
            for name, value in variances.items()
        },
    )
