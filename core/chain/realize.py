"""Making arrays of what is on a wire, in the form that a viewer or a file needs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.results import SampledTransfer
from core.chain.wires import Curve, Image, Phase, SpectrumWire, Table, Transfer
from core.errors import ParameterError
from core.evaluation.float_guard import require_finite
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.transfer.factors import Factor, Separable
from core.transfer.periodic import fourier
from core.transfer.product import nyquist_lines

Array = NDArray[Any]


def realize(value: Any, work: Work, region: Region | None = None) -> Any:
    """The computed form of a port's value, or a region of it if it is an image.

    Image: pixels. Transfer, magnitude and phase: full 2-D arrays in FFT order, MTF and magnitude
    real and signed, PTF and phase in radians, at Nyquist as they act. Curve:
    `CurveData`. Table: `TableData`. Context: itself. A pupil gives its samples.

    Raises `ParameterError` for a region of what is no image, or beyond the image.
    """
    if region is not None:
        if not isinstance(value, Image):
            kind = getattr(value, "port_type", type(value).__name__)
            raise ParameterError("region", str(region), f"a region needs an image, not a {kind}")
        if region.within(value.shape).shape != value.shape:
            return work.part(value.recipe, region)
    if isinstance(value, Image | Curve | Table):
        return work.value(value.recipe)
    if isinstance(value, Transfer | SpectrumWire):
        work.log.looked_at.add(value.key)
    if isinstance(value, Transfer):
        if value.own is not None:
            sampled: SampledTransfer = work.value(value.own)
            return sampled.values
        return transfer_plane(work, value).astype(work.policy.dtype)
    if isinstance(value, SpectrumWire):
        plane = transfer_plane(work, value)
        if value.image is not None:
            own = work.value(_spectrum_of(value.image))
            plane = plane + np.angle(own) if isinstance(value, Phase) else plane * np.abs(own)
        return plane.astype(work.policy.dtype)
    samples = getattr(value, "samples", None)
    if isinstance(samples, Recipe):
        return work.value(samples)
    return value


def asked_for(value: Any) -> tuple[Recipe, ...]:
    """The recipes whose values `realize` takes, to hold them before."""
    if isinstance(value, Image | Curve | Table):
        return (value.recipe,)
    if isinstance(value, Transfer):
        return value.recipes if value.own is None else (value.own,)
    if isinstance(value, SpectrumWire):
        bound = value.recipes if value.image is None else value.recipes[1:]
        return (*bound, *([_spectrum_of(value.image)] if value.image is not None else []))
    samples = getattr(value, "samples", None)
    return (samples,) if isinstance(samples, Recipe) else ()


def _spectrum_of(image: Image) -> Recipe:
    return Step.of(spectrum, image.recipe)


def transfer_plane(
    work: Work, value: Transfer | SpectrumWire, xi: Array | None = None, eta: Array | None = None
) -> Array:
    """Product of the MTFs, or sum of the PTFs, at xi × eta (default: the plain FFT's).

    On the plain FFT's own frequencies it is what acts on a periodic frame: at the Nyquist row and
    column of an even size, the Hermitian part.
    """
    phase = value.part == "ptf" if isinstance(value, Transfer) else isinstance(value, Phase)
    if xi is not None and eta is not None:
        return _plane(work, value.factors, phase, xi, eta)
    xi, eta = value.grid.xi(), value.grid.eta()
    plane = np.array(_plane(work, value.factors, phase, xi, eta))

    def shown(x: Array, y: Array) -> Array:
        return _plane(work, value.factors, phase, x, y)

    def acting(x: Array, y: Array) -> Array:
        return _acting(work, value.factors, x, y)

    lines = zip(nyquist_lines(shown, xi, eta), nyquist_lines(acting, xi, eta), strict=True)
    for (place, mean), (_, acts) in lines:
        if phase:
            # Near the mean of the phases, which may be many turns.
            plane[place] = mean + np.angle(acts * np.exp(-1j * mean))
        elif np.iscomplexobj(acts):
            plane[place] = np.copysign(np.abs(acts), mean)
        else:
            plane[place] = acts
    return plane


def _plane(work: Work, factors: tuple[Factor, ...], phase: bool, xi: Array, eta: Array) -> Array:
    """The factors as wires show them: MTFs signed or as moduli, PTFs in radians."""
    plane = np.zeros((len(eta), len(xi))) if phase else np.ones((len(eta), len(xi)))
    for factor in factors:
        part = factor.plane(work, xi, eta)
        plane = plane + part if phase else plane * part
    return plane


def _acting(work: Work, factors: tuple[Factor, ...], xi: Array, eta: Array) -> Array:
    """The factors as they multiply a spectrum; of a modulus or a phase, the law it belongs to."""
    plane: Array = np.ones((len(eta), len(xi)))
    for factor in factors:
        if isinstance(factor, Separable):
            part = factor.plane(work, xi, eta)
            plane = plane * (part if factor.part == "mtf" else np.exp(1j * part))
        else:
            whole = factor if factor.take == "real" else replace(factor, take="complex")
            plane = plane * whole.transfer(work, xi[np.newaxis, :], eta[:, np.newaxis])
    return plane


@ends_lineage
def spectrum(work: Work, image: Array) -> Array:
    """Unnormalised plain FFT of the frame, its mean exact to double precision."""
    mean = float(np.mean(image, dtype=np.float64))
    centred = np.subtract(image, mean, dtype=work.policy.dtype)
    values = fourier().fft2(centred, workers=work.policy.workers)
    require_finite(values)
    values[0, 0] = mean * image.size
    return np.asarray(values)
