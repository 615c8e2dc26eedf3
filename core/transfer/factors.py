"""Transfer factors: functions of frequency with their parameters bound, no arrays.

Most factors separate into a vector over xi and a vector over eta; a few are planar (radial, or
fully two-dimensional). A factor is made, and a network planned, only with arguments
that its function takes. It is one of three `Part`s of H = MTF·exp(i·PTF): a signed MTF, a PTF
in radians, or a complex H of which a wire carries the modulus or the phase.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from core.errors import ImagechainError
from core.evaluation.float_guard import watched
from core.evaluation.recipes import Recipe, content_key
from core.physics.sampling.detector_sampling import (
    frequency_interval_cyc_per_mrad,
    nyquist_cyc_per_mrad,
)

if TYPE_CHECKING:
    from core.evaluation.work import Work


Part = Literal["mtf", "ptf"]
Array = NDArray[Any]


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
        """Content key."""
        return content_key(self.function, self.parameters, self.scale)

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """Recipes among the bound arguments."""
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


class WavelengthLaw(ABC):
    """A law at every wavelength by itself; frozen, as it enters the key."""

    @abstractmethod
    def at(self, wavelength_um: float) -> Law:
        """The law at one wavelength, µm."""


@dataclass(frozen=True)
class AtWavelength(WavelengthLaw):
    """A law of which the arguments `names` are the wavelength, µm."""

    law: Law
    names: tuple[str, ...] = ("wavelength_um",)

    def at(self, wavelength_um: float) -> Law:
        """The law with the wavelength bound."""
        bound = dict(self.law.parameters) | dict.fromkeys(self.names, wavelength_um)
        return replace(self.law, parameters=tuple(sorted(bound.items())))


@contextmanager
def _placed(node: str | None) -> Iterator[None]:
    """Put errors on the node a factor came from."""
    try:
        with watched(node):
            yield
    except ImagechainError as error:
        raise (error.at(node) if node else error) from error


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
        with _placed(self.node):
            for law in self.laws:
                law.check(self.argument)

    @cached_property
    def key(self) -> str:
        """Content key."""
        return content_key("separable", self.x, self.y, self.part, self.argument)

    @property
    def laws(self) -> tuple[Law, ...]:
        """The laws there are."""
        return tuple(law for law in (self.x, self.y) if law is not None)

    def rescaled(self, ratio_x: float, ratio_y: float) -> Separable:
        """The factor with its frequency axes multiplied."""
        x, y = (
            law and replace(law, scale=law.scale * ratio)
            for law, ratio in ((self.x, ratio_x), (self.y, ratio_y))
        )
        return replace(self, x=x, y=y)

    def axis(self, work: Work | None, law: Law | None, frequency: Array) -> Array | None:
        """Values of one axis' law at `frequency`, or None where there is none."""
        if law is None:
            return None
        with _placed(self.node):
            return np.asarray(law(work, **{self.argument: frequency}), np.float64)

    def plane(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """Values on the plane spanned by `xi` (columns,) and `eta` (rows,)."""
        across = self.axis(work, self.x, xi)
        along = self.axis(work, self.y, eta)
        neutral = 1.0 if self.part == "mtf" else 0.0
        row = np.full(len(xi), neutral) if across is None else across
        column = np.full(len(eta), neutral) if along is None else along
        if self.part == "mtf":
            return np.multiply.outer(column, row)
        return np.add.outer(column, row)


Take = Literal["real", "modulus", "phase", "complex"]


@dataclass(frozen=True)
class Planar:
    """A factor that does not separate: radial, or any function of xi and eta.

    Parameters
    ----------
    law : Law
        Called as ``law(xi=…, eta=…)``, or ``law(rho=…)`` when `radial`.
    symmetric : bool
        Real and even in xi and in eta separately, as for every pupil with a mirror axis.
    take : "real", "modulus", "phase" or "complex"
        Which aspect of the law's value this factor carries. A magnitude wire carries "real" or
        "modulus", a phase wire "phase"; where modulus and phase of one law meet again they become
        "complex".
    ratios : (float, float)
        What xi and eta are multiplied by first: see `rescaled`.
    cutoff : (float, float) or None
        Frequencies across and along, cycles/mrad, beyond which the law is 0, where that is known.
    by_wavelength : WavelengthLaw or None
        The law at a wavelength, of a factor that differs among those of a picture's bands; `law` is
        then its mean over them. Without bands there is none.
    """

    law: Law
    radial: bool = False
    symmetric: bool = True
    take: Take = "real"
    ratios: tuple[float, float] = (1.0, 1.0)
    cutoff: tuple[float, float] | None = field(default=None, compare=False)
    label: str = field(default="", compare=False)
    node: str | None = field(default=None, compare=False)
    by_wavelength: WavelengthLaw | None = None

    def __post_init__(self) -> None:
        with _placed(self.node):
            self.law.check(*(("rho",) if self.radial else ("xi", "eta")))

    @property
    def laws(self) -> tuple[Law, ...]:
        """The law."""
        return (self.law,)

    @property
    def part(self) -> Part:
        """Whether this is an MTF or a PTF on its wire."""
        return "ptf" if self.take == "phase" else "mtf"

    @cached_property
    def key(self) -> str:
        """Content key."""
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
        return replace(
            self, law=self.by_wavelength.at(wavelength_um), cutoff=None, by_wavelength=None
        )

    def rescaled(self, ratio_x: float, ratio_y: float) -> Planar:
        """The factor with its frequency axes multiplied."""
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
        with _placed(self.node):
            if self.radial:
                # Ten times as fast as hypot, and frequencies are far from where it overflows.
                return np.asarray(self.law(work, rho=np.sqrt(xi * xi + eta * eta)))
            return np.asarray(self.law(work, xi=xi, eta=eta))


Factor = Separable | Planar


def factor_at(work: Work | None, factor: Factor, xi: Array, eta: Array) -> NDArray[np.float64]:
    """A factor's MTF, signed, or its PTF in radians, at pairs of frequencies."""
    if isinstance(factor, Separable):
        x, y = factor.axis(work, factor.x, xi), factor.axis(work, factor.y, eta)
        neutral = 1.0 if factor.part == "mtf" else 0.0
        row, column = neutral if x is None else x, neutral if y is None else y
        combined = row * column if factor.part == "mtf" else row + column
        return np.broadcast_to(np.asarray(combined, np.float64), xi.shape)
    value = np.broadcast_to(factor.transfer(work, xi, eta), xi.shape)
    return np.asarray(np.angle(value) if factor.take == "phase" else np.real(value), np.float64)


# Sampling of a frame in angle and the frequencies that belong to it.

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
