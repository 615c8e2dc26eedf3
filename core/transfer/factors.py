"""Transfer factors: functions of frequency with their parameters bound, no arrays.

Most factors separate into a vector over xi and a vector over eta; a few are planar (radial, or
fully two-dimensional). A factor is made, and a network planned, only with arguments
that its function takes. It is one of three `Part`s of H = MTF·exp(i·PTF): a signed MTF, a PTF
in radians, or a complex H of which a wire carries the modulus or the phase.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np

from core.arrays import Array, Vector
from core.errors import watched
from core.evaluation.recipes import Recipe, content_key
from core.evaluation.work import Work
from core.physics.sampling.detector_sampling import (
    frequency_interval_cyc_per_mrad,
    nyquist_cyc_per_mrad,
)
from core.records import dataclass, field, replace

Part = Literal["mtf", "ptf"]


@dataclass(frozen=True)
class Law:
    """A pure function of frequency with its other arguments bound.

    A bound argument may be a `Recipe`; its value is put in its place when the law is evaluated.
    Frequencies are multiplied by `scale` first.
    """

    function: Callable[..., Array]
    parameters: tuple[tuple[str, Any], ...] = ()
    scale: float = 1.0

    @classmethod
    def of(cls, function: Callable[..., Array], *, scale: float = 1.0, **parameters: Any) -> Law:
        """Write ``Law.of(gaussian_mtf, sigma_mrad=0.5)``."""
        return cls(function, tuple(sorted(parameters.items())), scale)

    @cached_property
    def key(self) -> str:
        return content_key(self.function, self.parameters, self.scale)

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        return tuple(value for _, value in self.parameters if isinstance(value, Recipe))

    def check(self, *frequencies: str) -> None:
        """Have the function check its bound arguments, once, at frequency zero (`ParameterError`).

        Of a law with a recipe bound nothing is known before its value is made.
        """
        known = vars(self)
        if "checked" not in known and not self.inputs:
            self.function(**{name: np.zeros(1) for name in frequencies}, **dict(self.parameters))
            known["checked"] = True

    def __call__(self, work: Work | None, **frequencies: Array) -> Array:
        """Evaluate at the given frequencies; `work` is needed when a recipe is bound."""
        bound: dict[str, Any] = {}
        for name, value in self.parameters:
            if isinstance(value, Recipe):
                assert work is not None, "a law bound to a recipe can be evaluated only with `work`"
                bound[name] = work.value(value)
            else:
                bound[name] = value
        if self.scale != 1.0:
            frequencies = {name: self.scale * array for name, array in frequencies.items()}
        return self.function(**frequencies, **bound)


WavelengthLaw = Callable[[float], Law]
"""The law at one wavelength, µm; a frozen dataclass, as it enters the key."""


@dataclass(frozen=True)
class AtWavelength:
    """A law of which the arguments `names` are the wavelength, µm."""

    law: Law
    names: tuple[str, ...] = ("wavelength_um",)

    def __call__(self, wavelength_um: float) -> Law:
        bound = dict(self.law.parameters) | dict.fromkeys(self.names, wavelength_um)
        return replace(self.law, parameters=tuple(sorted(bound.items())))


@dataclass(frozen=True)
class Separable:
    """fx(xi)·fy(eta) for an MTF, fx(xi) + fy(eta) for a PTF; a missing law is 1 or 0.

    `argument` is the name of the laws' frequency argument; `label` and `node` are for people.
    """

    x: Law | None
    y: Law | None
    part: Part = "mtf"
    argument: str = "frequency"
    label: str = field(default="", compare=False)
    node: str | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        with watched(self.node):
            for law in self.laws:
                law.check(self.argument)

    @cached_property
    def key(self) -> str:
        return content_key("separable", self.x, self.y, self.part, self.argument)

    @property
    def laws(self) -> tuple[Law, ...]:
        return tuple(law for law in (self.x, self.y) if law is not None)

    def rescaled(self, ratio_x: float, ratio_y: float) -> Separable:
        x, y = (
            law and replace(law, scale=law.scale * ratio)
            for law, ratio in ((self.x, ratio_x), (self.y, ratio_y))
        )
        return replace(self, x=x, y=y)

    def axis(self, work: Work | None, law: Law | None, frequency: Array) -> Array | None:
        """Values of one axis' law at `frequency`, or None where there is none."""
        if law is None:
            return None
        with watched(self.node):
            return np.asarray(law(work, **{self.argument: frequency}), np.float64)

    def plane(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """Values on the plane spanned by `xi` (columns,) and `eta` (rows,)."""
        along = self.axis(work, self.y, eta)
        column = None if along is None else along[:, np.newaxis]
        return self.joined(self.axis(work, self.x, xi), column, (len(eta), len(xi)))

    def joined(self, x: Array | None, y: Array | None, shape: tuple[int, ...]) -> Array:
        neutral = 1.0 if self.part == "mtf" else 0.0
        row, column = neutral if x is None else x, neutral if y is None else y
        both = column * row if self.part == "mtf" else column + row
        return np.broadcast_to(np.asarray(both, np.float64), shape)


Take = Literal["real", "modulus", "phase", "complex"]


@dataclass(frozen=True)
class Planar:
    """A factor that does not separate: radial, or any function of xi and eta."""

    law: Law  # called as ``law(xi=…, eta=…)``, or ``law(rho=…)`` when `radial`
    radial: bool = False
    # Real and even in xi and in eta separately, as for every pupil with a mirror axis.
    symmetric: bool = True
    # Which aspect of the law's value this factor carries. A magnitude wire carries "real" or
    # "modulus", a phase wire "phase"; where modulus and phase of one law meet again they become
    # "complex".
    take: Take = "real"
    # What xi and eta are multiplied by first: see `rescaled`.
    ratios: tuple[float, float] = (1.0, 1.0)
    # Frequencies across and along, cycles/mrad, beyond which the law is 0, where that is known.
    cutoff: tuple[float, float] | None = field(default=None, compare=False)
    label: str = field(default="", compare=False)
    node: str | None = field(default=None, compare=False)
    # The law at a wavelength, of a factor that differs among those of a picture's bands; `law` is
    # then its mean over them. Without bands there is none.
    by_wavelength: WavelengthLaw | None = None

    def __post_init__(self) -> None:
        with watched(self.node):
            self.law.check(*(("rho",) if self.radial else ("xi", "eta")))

    @property
    def laws(self) -> tuple[Law, ...]:
        return (self.law,)

    @property
    def part(self) -> Part:
        return "ptf" if self.take == "phase" else "mtf"

    @cached_property
    def key(self) -> str:
        return content_key(
            "planar",
            self.law,
            (self.radial, self.symmetric, self.take),
            self.ratios,
            *(() if self.by_wavelength is None else (self.by_wavelength,)),
        )

    def at(self, wavelength_um: float) -> Planar:
        """The factor at one wavelength, µm; as it is where it does not depend on that."""
        if self.by_wavelength is None:
            return self
        return replace(self, law=self.by_wavelength(wavelength_um), cutoff=None, by_wavelength=None)

    def rescaled(self, ratio_x: float, ratio_y: float) -> Planar:
        cutoff = self.cutoff and (self.cutoff[0] / ratio_x, self.cutoff[1] / ratio_y)
        ratios = (self.ratios[0] * ratio_x, self.ratios[1] * ratio_y)
        return replace(self, ratios=ratios, cutoff=cutoff)

    def transfer(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """What multiplies the spectrum, real or complex: a phase φ gives exp(iφ).

        `xi` and `eta` broadcast against each other.
        """
        value = self._evaluate(work, xi, eta)
        if self.take in ("real", "complex"):
            return value
        if self.take == "modulus":
            return np.abs(value)
        modulus = np.abs(value)
        # A zero of the OTF has no phase: 1 keeps what an MTF from elsewhere passes there.
        return np.where(modulus > 0, value / np.where(modulus > 0, modulus, 1.0), 1.0)

    def plane(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """Values as the wire shows them (MTF, or PTF in radians) on the plane of `xi` × `eta`."""
        value = self._evaluate(work, xi[np.newaxis, :], eta[:, np.newaxis])
        shape = (len(eta), len(xi))
        if self.take == "phase":
            return np.broadcast_to(np.angle(value), shape)
        shown = np.real(value) if self.take == "real" else np.abs(value)
        return np.broadcast_to(shown, shape)

    def _evaluate(self, work: Work | None, xi: Array, eta: Array) -> Array:
        if self.ratios != (1.0, 1.0):
            xi, eta = xi * self.ratios[0], eta * self.ratios[1]
        with watched(self.node):
            if self.radial:
                # Ten times as fast as hypot, and frequencies are far from where it overflows.
                return np.asarray(self.law(work, rho=np.sqrt(xi * xi + eta * eta)))
            return np.asarray(self.law(work, xi=xi, eta=eta))


Factor = Separable | Planar


def factor_at(work: Work | None, factor: Factor, xi: Array, eta: Array) -> Vector:
    """A factor's MTF, signed, or its PTF in radians, at pairs of frequencies."""
    if isinstance(factor, Separable):
        x, y = factor.axis(work, factor.x, xi), factor.axis(work, factor.y, eta)
        return factor.joined(x, y, xi.shape)
    value = np.broadcast_to(factor.transfer(work, xi, eta), xi.shape)
    return np.asarray(np.angle(value) if factor.take == "phase" else np.real(value), np.float64)


# Sampling of a frame in angle and the frequencies that belong to it.

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
        return self.rows, self.columns

    @property
    def nyquist_x(self) -> float:
        """Nyquist frequency across, cycles/mrad (Tantalo 1996, eq. 4.2)."""
        return nyquist_cyc_per_mrad(interval_mrad=self.interval_x_mrad)

    @property
    def nyquist_y(self) -> float:
        return nyquist_cyc_per_mrad(interval_mrad=self.interval_y_mrad)

    @property
    def frequency_interval_x(self) -> float:
        """Spacing of the plain FFT's frequencies across, cycles/mrad (eq. 4.3)."""
        return frequency_interval_cyc_per_mrad(
            interval_mrad=self.interval_x_mrad, samples=self.columns
        )

    @property
    def frequency_interval_y(self) -> float:
        return frequency_interval_cyc_per_mrad(
            interval_mrad=self.interval_y_mrad, samples=self.rows
        )

    def xi(self) -> Vector:
        """Frequencies across in FFT order (an even size has −Nyquist), shape (columns,)."""
        return np.asarray(np.fft.fftfreq(self.columns, self.interval_x_mrad), np.float64)

    def eta(self) -> Vector:
        return np.asarray(np.fft.fftfreq(self.rows, self.interval_y_mrad), np.float64)

    def axes(self, edges: Edges) -> tuple[Vector, Vector]:
        """Frequencies across and along of the spectrum of a frame with these edges.

        Mirrored: k/(2·n·interval), k = 0 … n − 1. Periodic: 0 … +Nyquist of the half spectrum,
        shape (columns // 2 + 1,), and `eta`.
        """
        if edges == "periodic":
            xi = np.fft.rfftfreq(self.columns, self.interval_x_mrad)
            return np.asarray(xi, np.float64), self.eta()
        return (
            np.arange(self.columns) / (2.0 * self.columns * self.interval_x_mrad),
            np.arange(self.rows) / (2.0 * self.rows * self.interval_y_mrad),
        )


# The product of a chain's factors, kept as two axis vectors and a few planar factors.


class Product:
    """H(xi, eta) = Hx(xi)·Hy(eta)·Π planar factors, evaluated only where needed.

    It is made of the factors of the magnitude and of the phase wire together; modulus and phase of
    one law become that complex law again.
    """

    def __init__(self, factors: Sequence[Factor]) -> None:
        self.separable = tuple(f for f in factors if isinstance(f, Separable))
        self.planar = _rejoin([f for f in factors if isinstance(f, Planar)])

    @property
    def symmetric(self) -> bool:
        """Whether every planar factor is real and even in xi and in eta."""
        return all(f.symmetric and f.take == "real" for f in self.planar)

    @property
    def has_phase_x(self) -> bool:
        """Whether some factor shifts phases across."""
        return any(f.part == "ptf" and f.x is not None for f in self.separable)

    @property
    def has_phase_y(self) -> bool:
        return any(f.part == "ptf" and f.y is not None for f in self.separable)

    def across(self, work: Work | None, xi: Array) -> Array:
        """Hx at `xi`: real unless `has_phase_x`."""
        return self._axis(work, xi, "x")

    def along(self, work: Work | None, eta: Array) -> Array:
        """Hy at `eta`: real unless `has_phase_y`."""
        return self._axis(work, eta, "y")

    def plane(self, work: Work | None, xi: Array, eta: Array) -> Array | None:
        """Product of the planar factors for xi (columns,) × eta (rows,); None without any."""
        if not self.planar:
            return None
        value: Array | None = None
        for factor in self.planar:
            values = factor.transfer(work, xi[np.newaxis, :], eta[:, np.newaxis])
            value = values if value is None else value * values
        return value

    def total(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """H on the plane of xi (columns,) × eta (rows,)."""
        value = np.multiply.outer(self.along(work, eta), self.across(work, xi))
        plane = self.plane(work, xi, eta)
        return value if plane is None else value * plane

    def at_zero(self, work: Work | None, axes: complex | None = None) -> float:
        """H(0, 0), real, 1 for every passive chain; `axes` is Hx(0)·Hy(0), where that is known."""
        zero = np.zeros(1)
        if axes is None:
            axes = (self.along(work, zero) * self.across(work, zero))[0]
        plane = self.plane(work, zero, zero)
        return float(np.real(axes if plane is None else axes * plane[0, 0]))

    def _axis(self, work: Work | None, frequency: Array, axis: str) -> Array:
        modulus = np.ones(len(frequency))
        phase: Array | None = None
        for factor in self.separable:
            value = factor.axis(work, factor.x if axis == "x" else factor.y, frequency)
            if value is None:
                continue
            if factor.part == "mtf":
                modulus = modulus * value
            else:
                phase = value if phase is None else phase + value
        return modulus if phase is None else modulus * np.exp(1j * phase)


def _rejoin(planar: list[Planar]) -> tuple[Planar, ...]:
    """Put modulus and phase of one law together, so that neither is ever computed."""
    joined: list[Planar] = []
    for factor in planar:
        other = {"modulus": "phase", "phase": "modulus"}.get(factor.take)
        for index, earlier in enumerate(joined) if other else ():
            same = earlier.law.key == factor.law.key and earlier.ratios == factor.ratios
            if earlier.take == other and same:
                joined[index] = replace(earlier, take="complex")
                break
        else:
            joined.append(factor)
    return tuple(joined)


# What acts at the Nyquist row and column of an even frame: the Hermitian part of H.
#
# There +Nyquist and −Nyquist are one frequency of the samples, whose spectrum must stay that of a
# real picture: the mean of H at both acts (Oppenheim and Schafer 1989, Discrete-Time Signal
# Processing, on the symmetries of the transform of a real sequence).

OnPlane = Callable[[Array, Array], Array]
Lines = tuple[slice | int, slice | int]


def nyquist_lines(function: OnPlane, xi: Array, eta: Array) -> Iterator[tuple[Lines, Array]]:
    """Means over both signs of Nyquist's frequencies, on the lines where there are two.

    The function of xi (columns,) and eta (rows,), which are in the order of a plain FFT, gives
    values of shape (rows, columns). Yields the index of a row, or a column, and the mean there.
    """
    across, along = _turned(xi), _turned(eta)
    for axis, signs in ((0, along), (1, across)):
        if signs is None:
            continue
        place = len(signs) // 2
        on_line = slice(place, place + 1)
        whole: Lines = (place, slice(None)) if axis == 0 else (slice(None), place)
        total: Array | None = None
        for x in (xi, xi if across is None else across):
            for y in (eta, eta if along is None else along):
                value = function(x, y[on_line]) if axis == 0 else function(x[on_line], y)
                total = value if total is None else total + value
        assert total is not None
        yield whole, 0.25 * total.ravel()


def _turned(frequency: Array) -> Array | None:
    """The same frequencies with Nyquist's of the other sign; None of an odd size."""
    size = len(frequency)
    if size % 2:
        return None
    turned = np.array(frequency, np.float64)
    turned[size // 2] *= -1.0
    return turned


# Leaving out stages that change the picture by less than the error budget.
#
# A stage's bound is the largest |1 − H| over the band. Stages are left out in the order of their
# bounds while the sum stays within the tolerance t. What remains is passive, so by Parseval's
# theorem the picture changes by at most t times the rms of its contrast.

RADII = 513  # places along the radius on which a radial factor is bounded


Skipped = tuple[Factor, float]
"""A stage left out, and how much it could have changed."""


def spend(
    work: Work, factors: Sequence[Factor], xi: Array, eta: Array, *, spent: float = 0.0
) -> tuple[tuple[Factor, ...], tuple[Skipped, ...]]:
    """Factors to keep, in their order, and what is left out on the band xi × eta.

    The policy has the tolerance, of which something else may have `spent` a part; at 0 everything
    is kept.
    """
    left = work.policy.budget - spent
    if left <= 0.0:
        return tuple(factors), ()
    corner = _farthest(xi), _farthest(eta)
    bounds = []
    for factor in factors:
        # Most stages exceed the budget at the band's corner alone, by the same bound.
        bound = stage_bound(work, factor, *corner, radii=1)
        bounds.append(bound if bound > left else stage_bound(work, factor, xi, eta))
    skipped = {}
    for index in sorted(range(len(factors)), key=lambda i: bounds[i]):
        if bounds[index] > left:
            break
        left -= bounds[index]
        skipped[index] = factors[index], bounds[index]
    needed = tuple(f for index, f in enumerate(factors) if index not in skipped)
    return needed, tuple(skipped.values())


def _farthest(frequency: Array) -> Array:
    place = int(np.argmax(np.abs(frequency)))
    return frequency[place : place + 1]


def stage_bound(work: Work, factor: Factor, xi: Array, eta: Array, *, radii: int = RADII) -> float:
    """Upper bound of |1 − H| over the band; infinite where it is not cheap to find."""
    if isinstance(factor, Separable):
        across = _axis_change(work, factor, factor.x, xi)
        along = _axis_change(work, factor, factor.y, eta)
        # |1 − ab| ≤ |1 − a| + |a|·|1 − b| and |a| ≤ 1 + |1 − a|
        return across + (1.0 + across) * along
    if factor.radial and factor.ratios[0] == factor.ratios[1]:
        corner = float(np.hypot(np.abs(xi).max(), np.abs(eta).max()))
        line = factor.transfer(work, corner * np.linspace(1.0, 0.0, radii), np.zeros(1))
        return float(np.abs(1.0 - line).max())
    return float("inf")


def _axis_change(work: Work, factor: Separable, law: Any, frequency: Array) -> float:
    value = factor.axis(work, law, frequency)
    if value is None:
        return 0.0
    # |1 − exp(iφ)| = 2|sin(φ/2)|
    change = 1.0 - value if factor.part == "mtf" else 2.0 * np.sin(0.5 * value)
    return float(np.abs(change).max())
