"""Making arrays of what is on a wire, as a viewer or a file wants them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arithmetic import require_finite
from core.data import SampledTransfer
from core.errors import ParameterError
from core.fourier import fourier
from core.recipes import Recipe, Step
from core.region import Region
from core.values import Curve, Image, Magnitude, Phase, SpectrumWire, Table, Transfer
from core.work import Work

Array = NDArray[Any]


def realize(value: Any, work: Work, region: Region | None = None) -> Any:
    """The computed form of a port's value, or a region of it if it is an image.

    Image: pixels. Transfer, magnitude and phase: full 2-D arrays in FFT order, MTF and magnitude
    real and signed, PTF and phase in radians. Curve: `CurveData`. Table: `TableData`. Context:
    itself. A pupil gives its samples.

    Raises
    ------
    ParameterError
        For a region of what is no image, or beyond the image.
    """
    if region is not None:
        if not isinstance(value, Image):
            kind = getattr(value, "port_type", type(value).__name__)
            raise ParameterError("region", str(region), f"only an image has one, and no {kind}")
        if region.within(value.shape).shape != value.shape:
            return work.part(value.recipe, region)
    if isinstance(value, Image | Curve | Table):
        return work.value(value.recipe)
    if isinstance(value, Transfer | SpectrumWire):
        work.tally.looked_at.add(value.key)
    if isinstance(value, Transfer):
        if value.own is not None:
            sampled: SampledTransfer = work.value(value.own)
            return sampled.values
        return transfer_plane(work, value).astype(work.policy.dtype)
    if isinstance(value, Magnitude):
        return _magnitude(work, value)
    if isinstance(value, Phase):
        return _phase(work, value)
    samples = getattr(value, "samples", None)
    if isinstance(samples, Recipe):
        return work.value(samples)
    return value


def transfer_plane(
    work: Work, value: Transfer | SpectrumWire, xi: Array | None = None, eta: Array | None = None
) -> Array:
    """Product of the MTFs, or sum of the PTFs, at xi × eta (default: the plain FFT's)."""
    xi = value.grid.xi() if xi is None else xi
    eta = value.grid.eta() if eta is None else eta
    phase = value.part == "ptf" if isinstance(value, Transfer) else isinstance(value, Phase)
    plane = np.zeros((len(eta), len(xi))) if phase else np.ones((len(eta), len(xi)))
    for factor in value.factors:
        part = factor.plane(work, xi, eta)
        plane = plane + part if phase else plane * part
    return plane


def spectrum(work: Work, image: Array) -> Array:
    """Unnormalised plain FFT of the frame, its mean exact to double precision."""
    mean = float(np.mean(image, dtype=np.float64))
    centred = np.subtract(image, mean, dtype=work.policy.dtype)
    values = fourier().fft2(centred, workers=work.policy.workers)
    require_finite(values)
    values[0, 0] = mean * image.size
    return np.asarray(values)


def _magnitude(work: Work, value: Magnitude) -> Array:
    plane = transfer_plane(work, value)
    if value.image is not None:
        plane = plane * np.abs(work.value(Step.of(spectrum, value.image.recipe)))
    return plane.astype(work.policy.dtype)


def _phase(work: Work, value: Phase) -> Array:
    plane = transfer_plane(work, value)
    if value.image is not None:
        plane = plane + np.angle(work.value(Step.of(spectrum, value.image.recipe)))
    return plane.astype(work.policy.dtype)
