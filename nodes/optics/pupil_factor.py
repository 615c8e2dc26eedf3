"""The transfer factors of a pupil: exact for geometry, by autocorrelation for samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from core.chain.wires import Pupil, SampledTransfer
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.physics.optics import pupil_otf, pupil_shapes
from core.physics.optics.wavefront import autocorrelation, complex_pupil, wavefront_waves
from core.physics.sampling.detector_sampling import error_estimate
from core.records import dataclass, field, replace
from core.transfer.factors import Array, Law, Planar, WavelengthLaw

SAME_WAVELENGTH = 1e-6  # share by which two may differ, as bands are typed in
LARGEST_REFINED = 1024  # samples across beyond which finer ones cost more than they gain


@dataclass(frozen=True)
class PupilScale:
    """Size of a pupil sample and the wavelengths of a band with their weights.

    Waves of defocus and of Zernike terms are those of the band's mean wavelength. The weights may
    be a recipe, of the light that counts.
    """

    pitch_x_mm: float
    pitch_y_mm: float
    wavelengths_um: tuple[float, ...]
    weights: tuple[float, ...] | Recipe
    mean_um: float

    @property
    def pitches(self) -> dict[str, float]:
        return {"pitch_x_mm": self.pitch_x_mm, "pitch_y_mm": self.pitch_y_mm}

    @property
    def band(self) -> dict[str, Any]:
        return {"wavelengths_um": self.wavelengths_um, "weights": self.weights}

    def at(self, wavelength_um: float) -> PupilScale:
        return replace(self, wavelengths_um=(wavelength_um,), weights=(1.0,))


@dataclass(frozen=True)
class PupilLaw(WavelengthLaw):
    """The OTF of a pupil at every wavelength by itself, on a scale of one.

    `interpolation` is that of the sampled pupil's autocorrelation, None for the closed form.
    """

    pupil: Pupil
    scale: PupilScale
    interpolation: str | None
    node: str = field(default="", compare=False)

    def at(self, wavelength_um: float) -> Law:
        scale = self.scale.at(wavelength_um)
        if self.interpolation is not None:
            return sampled_factors(self.pupil, scale, self.interpolation, "", self.node)[0].law
        factor = exact_factor(self.pupil, scale, "", self.node)
        assert factor is not None
        return factor.law


def refined(pupil: Pupil, scale: PupilScale, node: str) -> tuple[Pupil, PupilScale]:
    """A geometric pupil sampled twice as finely.

    Plain samples at 512 across err by 0.6e-4 to 2e-4 where edges follow the samples, and more
    elsewhere; twice as fine ones by 3e-5 to 5e-5.
    """
    if pupil.shape is None or max(pupil.rows, pupil.columns) > LARGEST_REFINED:
        return pupil, scale
    size: Any = {"rows": pupil.rows, "columns": pupil.columns}
    samples = Step.of(sampled, node=node, shape=pupil.shape, oversampling=2, **size)
    doubled: Any = {name: 2 * side for name, side in size.items()}
    finer = replace(pupil, samples=samples, radius=2 * pupil.shape.radius, **doubled)
    return finer, replace(scale, pitch_x_mm=scale.pitch_x_mm / 2, pitch_y_mm=scale.pitch_y_mm / 2)


def opening(shape: pupil_shapes.PupilShape) -> tuple[float, float]:
    diameter = 2 * shape.radius
    return (shape.radius if shape.shape == "half_moon" else diameter), diameter


def exact_factor(pupil: Pupil, scale: PupilScale, label: str, node: str) -> Planar | None:
    """The factor in closed form, or None where only samples will do."""
    if pupil.shape is None or any(pupil.zernike_waves):
        return None
    factor = _exact_factor(pupil, pupil.shape, scale)
    if factor is None:
        return None
    width, height = opening(pupil.shape)
    shortest = min(scale.wavelengths_um)
    cutoff = (width * scale.pitch_x_mm / shortest, height * scale.pitch_y_mm / shortest)
    return replace(factor, cutoff=cutoff, label=label, node=node)


def _exact_factor(pupil: Pupil, shape: pupil_shapes.PupilShape, scale: PupilScale) -> Planar | None:
    if not pupil.defocus_waves and shape.shape in ("clear", "cassegrain"):
        obscured = shape.shape == "cassegrain"
        disc = Law.of(
            pupil_otf.circular_pupil_otf,
            diameter_mm=2 * shape.radius * scale.pitch_x_mm,
            obscuration_ratio=shape.obscuration_radius / shape.radius if obscured else 0.0,
            **scale.band,
        )
        # Unequal sizes of a sample make an ellipse of a disc, and of its OTF.
        return Planar(disc, radial=True, ratios=(1.0, scale.pitch_x_mm / scale.pitch_y_mm))
    if not pupil.defocus_waves:
        how = {**scale.pitches, **scale.band}
        return Planar(Law.of(pupil_otf.geometric_pupil_otf, shape=shape, **how))
    if shape.shape != "clear" or scale.pitch_x_mm != scale.pitch_y_mm:
        return None
    defocused = Law.of(
        pupil_otf.defocused_disc_otf,
        diameter_mm=2 * shape.radius * scale.pitch_x_mm,
        w20_waves=pupil.defocus_waves,
        reference_um=scale.mean_um,
        **scale.band,
    )
    return Planar(defocused, radial=True)


def sampled_factors(
    pupil: Pupil, scale: PupilScale, interpolation: str, label: str, node: str
) -> tuple[Planar, Planar | None]:
    """The MTF factor, and the PTF factor where a wavefront error makes the OTF complex."""
    real = not pupil.aberrated
    law = Law.of(
        pupil_otf.sampled_pupil_otf,
        correlations=correlations(pupil, scale, node),
        interpolation=interpolation,
        real=real,
        **scale.pitches,
        **scale.band,
    )
    how: dict[str, Any] = {"symmetric": False, "label": label, "node": node}
    if real:
        return Planar(law, **how), None
    return Planar(law, take="modulus", **how), Planar(law, take="phase", **how)


def correlations(pupil: Pupil, scale: PupilScale, node: str) -> Step:
    """Recipe of the autocorrelations: one for the band, or one a wavelength with a wavefront."""
    ratios: tuple[float, ...] = (1.0,)
    if pupil.aberrated:
        ratios = tuple(scale.mean_um / wavelength for wavelength in scale.wavelengths_um)
    map_ratio = _map_ratio(pupil, scale, ratios)
    return _of_samples(_correlations, pupil, node, map_ratio=map_ratio, ratios=ratios)


def raw_transfer(pupil: Pupil, scale: PupilScale, part: str, node: str) -> Recipe:
    intervals = scale.pitch_x_mm / scale.mean_um, scale.pitch_y_mm / scale.mean_um
    how: Any = {"intervals": intervals, "part": part, "real": not pupil.aberrated}
    return Step.of(_raw, correlations(pupil, scale, node), node=node, **how)


def _of_samples(function: Callable[..., Any], pupil: Pupil, node: str, **how: Any) -> Step:
    given = (pupil.samples,) if pupil.wavefront is None else (pupil.samples, pupil.wavefront)
    how |= {name: getattr(pupil, name) for name in ("radius", "defocus_waves", "zernike_waves")}
    return Step.of(function, *given, node=node, **how)


def _map_ratio(pupil: Pupil, scale: PupilScale, ratios: tuple[float, ...] = (1.0,)) -> float:
    """Waves of the map at the band's mean wavelength, over those of its own."""
    ratio = 1.0 if pupil.wavefront_um is None else pupil.wavefront_um / scale.mean_um
    if pupil.wrapped and any(abs(ratio * one - 1.0) > SAME_WAVELENGTH for one in ratios):
        raise DataError(
            "a complex pupil, whose wavefront is known modulo one wave, is valid only at its own "
            "wavelength: set wavelengths to 1, and centre the band on this wavelength"
        )
    return ratio


def sampled_error(pupil: Pupil, scale: PupilScale, node: str) -> Step:
    """Recipe of the estimate that covers the sampled OTF's error."""
    map_ratio = _map_ratio(pupil, scale)
    return _of_samples(_error, pupil, node, map_ratio=map_ratio, shape=pupil.shape)


def _complex_samples(
    samples: Array,
    maps: tuple[Array, ...],
    ratio: float,
    map_ratio: float,
    radius: float | None,
    defocus_waves: float,
    zernike_waves: tuple[float, ...],
) -> Array:
    measured = (ratio * map_ratio) * maps[0] if maps else 0.0
    if not (defocus_waves or zernike_waves):
        if not maps:
            return samples
        return complex_pupil(transmission=samples, wavefront_waves=measured)
    rows, columns = samples.shape
    if radius is None:
        x, y, radius = pupil_shapes.support_circle(samples)
    else:
        x, y = (columns - 1) / 2, (rows - 1) / 2
    wavefront = ratio * wavefront_waves(
        x=(np.arange(columns) - x)[np.newaxis, :] / radius,
        y=(np.arange(rows) - y)[:, np.newaxis] / radius,
        coefficients_waves=zernike_waves,
        defocus_waves=defocus_waves,
    )
    return complex_pupil(transmission=samples, wavefront_waves=wavefront + measured)


def _correlations(
    work: Work, samples: Array, *maps: Array, ratios: tuple[float, ...], **wavefront: Any
) -> tuple[Array, ...]:
    autocorrelations = []
    for ratio in ratios:
        work.check()
        pupil = _complex_samples(samples, maps, ratio, **wavefront)
        autocorrelations.append(autocorrelation(pupil, workers=work.policy.workers))
    return tuple(autocorrelations)


def _raw(
    work: Work, found: tuple[Array, ...], *, intervals: tuple[float, float], part: str, real: bool
) -> SampledTransfer:
    otf = np.fft.ifftshift(found[len(found) // 2])
    if part == "ptf":
        values = np.zeros(otf.shape) if real else np.angle(otf)
    else:
        values = np.real(otf) if real else np.abs(otf)
    return SampledTransfer(values.astype(work.policy.dtype), *intervals)


def sampled(work: Work, *, shape: pupil_shapes.PupilShape, **how: int) -> Array:
    return pupil_shapes.sample_pupil(shape, **how)


def _error(
    work: Work,
    samples: Array,
    *maps: Array,
    shape: pupil_shapes.PupilShape | None,
    **wavefront: Any,
) -> float:
    pupil = _complex_samples(samples, maps, 1.0, **wavefront)
    correlation = autocorrelation(pupil, workers=work.policy.workers)
    uncertainty = 0.5  # samples of unknown edges may be off by half their size
    if shape is not None:
        fineness = max(1, round(wavefront["radius"] / shape.radius))
        rows, columns = samples.shape[0] // fineness, samples.shape[1] // fineness
        uncertainty = pupil_shapes.edge_offset_samples(
            shape, rows=rows, columns=columns, oversampling=fineness
        )
    return float(
        error_estimate(pupil, correlation=correlation, edge_uncertainty_samples=uncertainty)
    )
