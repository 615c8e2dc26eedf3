"""Exit Pupil MTF: diffraction by the aperture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.chain.wires import Context, Magnitude, Phase, Pupil, SampledTransfer, Transfer
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.optics import pupil_otf, pupil_shapes
from core.physics.optics.diffraction_otf import Spectrum, band_wavelengths
from core.physics.optics.wavefront import autocorrelation, complex_pupil, wavefront_waves
from core.physics.sampling.detector_sampling import error_estimate
from core.records import dataclass, field, replace
from core.transfer.factors import Law, Planar
from nodes.optics.band_spectrum import (
    DetectorResponse,
    at_each_band,
    response_warning,
    source_temperature,
    weighting_responses,
)
from nodes.shared import module_ports
from nodes.shared.context_defaults import F_NUMBER_NEAR, alike, given_band, middle_warning
from nodes.shared.steps import number

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
class PupilLaw:
    """The OTF of a pupil at every wavelength by itself; `interpolation` None: in closed form."""

    pupil: Pupil
    scale: PupilScale
    interpolation: str | None
    node: str = field(default="", compare=False)

    def __call__(self, wavelength_um: float) -> Law:
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


Weighting = Literal["uniform", "photons", "energy"]
Row = tuple[float, ...]
EXACT_ERROR = 1e-12  # of the closed forms, as tested


class ExitPupilMTF(
    module_ports.NyquistReadouts, key="exit_pupil_mtf", title="Exit Pupil MTF", group="Optics"
):
    """Apply the incoherent OTF of an exit pupil: the pupil's normalised autocorrelation.

    The OTF of a geometric shape is exact, for one wavelength or a band. For pupils from files or
    with wavefront errors, the sampled pupil is autocorrelated. Wavelengths are weighted equally, or
    by the photons or the energy of a black body (`weighting`), and by the detector's `response`.
    The black body's temperature is `source_K`. If `source_K` is empty, the temperature is 5800 K
    (sunlight) for a band that begins below 2.5 µm, and otherwise the brightness temperature of the
    picture's mean radiance. A spectral picture is blurred band by band, each band at its own
    wavelength. With interpolation `none`, the module outputs the raw autocorrelation at the pupil's
    own frequency intervals and does not blur the picture. `size_x_cm` and `size_y_cm` are the
    sizes of the whole pupil array. Source: Tantalo 1996, eqs. 4.10 to 4.21. Erratum: the cutoff is
    aperture/λ. The 12.8 in eq. 4.21 is the array's half width over λ.
    """

    formulas = (
        Formula(
            r"\mathrm{OTF}(\xi,\eta)=\frac{\iint P(x,y)\,P^*(x-\lambda\xi,\,y-\lambda\eta)\,dx"
            r"\,dy}{\iint|P(x,y)|^2\,dx\,dy}",
            where="P: the pupil; λ: wavelength; µm times cycles/mrad is mm",
        ),
        Formula(
            r"\mathrm{OTF}=\sum_j w_j\,\mathrm{OTF}(\lambda_j),\quad f_c=\frac{D}{\lambda}",
            where="w_j: weights of the wavelengths; f_c: the cutoff; D: the aperture's diameter",
        ),
    )

    cut_on_um: module_ports.CutOn = None
    cut_off_um: module_ports.CutOff = None
    size_x_cm: float = param(25.6, "width of the whole pupil array", low=0, above=True)
    size_y_cm: float = param(25.6, "height of the whole pupil array", low=0, above=True)
    method: Literal["exact", "autocorrelation"] = param(
        "exact",
        "exact: closed-form OTF if there is one; autocorrelation: always the sampled pupil's OTF",
    )
    interpolation: Literal["none", "linear", "bilinear"] = param(
        "bilinear", "interpolation from the sampled pupil to the image's frequencies"
    )
    wavelengths: int = param(
        1, "number of wavelengths that sample the band; 1 uses the band's middle", (1, 256)
    )
    weighting: Weighting = param(
        "uniform",
        "weighting of the wavelengths: equal (as in Tantalo 1996), by photons, or by energy",
    )
    source_K: module_ports.LightingSource = None
    response: DetectorResponse = None
    apply: module_ports.Apply = "multiply"

    panel = (
        Section("Wavelengths", "cut_on_um cut_off_um wavelengths"),
        Section("Weights", "weighting"),
        Section("", "source_K", shown_when=("weighting", ("photons", "energy"))),
        Section("", "response"),
        Section("Whole pupil array", "size_x_cm size_y_cm"),
        Section("Autocorrelation", "interpolation method"),
        Section("Output", "apply"),
    )

    def run(
        self,
        context: Context,
        magnitude: Magnitude,
        pupil: Pupil,
        here: NodeContext,
        phase: Phase | None = None,
    ) -> module_ports.OtfOutputs:
        scale = self._by_light(self._scale(context, pupil), context, magnitude, here)
        if phase is None:
            phase = Phase(None, magnitude.grid, magnitude.edges)
        label, node = self.title, here.node
        grid = magnitude.grid
        if self.interpolation == "none":
            raw = [
                Transfer(grid, part, label=label, own=raw_transfer(pupil, scale, part, node))
                for part in ("mtf", "ptf")
            ]
            return module_ports.OtfOutputs(magnitude, phase, raw[0], raw[1])
        shift, exact = None, self.method == "exact"
        blur = exact_factor(pupil, scale, label, node) if exact else None
        law = PupilLaw(pupil, scale, None, node)
        if blur is None:
            pupil, scale = refined(pupil, scale, node) if exact else (pupil, scale)
            blur, shift = sampled_factors(pupil, scale, self.interpolation, label, node)
            law = PupilLaw(pupil, scale, self.interpolation, node)
        detector = weighting_responses(self.response, here.folder, None, self.weighting)
        bands = None if magnitude.image is None else magnitude.image.bands
        if bands is not None:
            how = (law, bands, self.weighting, detector)
            blur, shift = at_each_band(blur, *how), shift and at_each_band(shift, *how)
        shifts = () if shift is None else (shift,)
        return module_ports.otf_outputs(
            self.apply, magnitude, phase, blur=(blur,), shift=shifts, label=label
        )

    band = middle_warning

    @warning
    def aperture(self, context: Context, pupil: Pupil) -> Caution | None:
        """The aperture differs from focal length divided by F-number."""
        if context.f_number is None or context.focal_length_mm is None or pupil.shape is None:
            return None
        diameter_mm = 20 * pupil.shape.radius * self.size_x_cm / pupil.columns
        focal_length_mm, f_number = context.focal_length_mm, context.f_number
        if not diameter_mm or alike(focal_length_mm / diameter_mm, f_number, near=F_NUMBER_NEAR):
            return None
        return Caution(
            f"the pupil is {diameter_mm:.4g} mm wide, which at a focal length of "
            f"{focal_length_mm:.4g} mm is F/{focal_length_mm / diameter_mm:.3g}, but Init & Trans "
            f"has F/{f_number:.3g}",
            "make size_x_cm and the pupil's radius agree with f_number and focal_length_mm",
        )

    response_unused = response_warning

    def _scale(self, context: Context, pupil: Pupil) -> PupilScale:
        """Wavelengths over the band, which count alike."""
        cut_on, cut_off = given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        wavelengths, weights = band_wavelengths(
            cut_on_um=cut_on, cut_off_um=cut_off, count=self.wavelengths
        )
        mean_um = float(sum(w * q for w, q in zip(wavelengths, weights, strict=True)))
        return PupilScale(
            10 * self.size_x_cm / pupil.columns,
            10 * self.size_y_cm / pupil.rows,
            tuple(map(float, wavelengths)),
            tuple(map(float, weights)),
            mean_um,
        )

    def _by_light(
        self, scale: PupilScale, context: Context, magnitude: Magnitude, here: NodeContext
    ) -> PupilScale:
        if self.wavelengths == 1:
            return scale
        if magnitude.image is not None and magnitude.image.bands is not None:
            return scale  # each of them at its own wavelength
        responses = weighting_responses(self.response, here.folder, magnitude, self.weighting)
        if self.weighting == "uniform" and not responses:
            return scale
        band = given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        spectrum = Spectrum(*band, self.weighting, responses=responses)
        spectrum.check()
        places, shares = spectrum.places(self.wavelengths)
        kelvin: float | Recipe = 1.0
        if self.weighting != "uniform":
            kelvin = source_temperature(self.source_K, magnitude, band, here.node)
        if not isinstance(kelvin, Recipe):
            kelvin = Step.of(number, value=kelvin)
        weights = here.step(
            _weights_by_light, kelvin, spectrum=spectrum, wavelengths_um=places, weights=shares
        )
        return replace(scale, wavelengths_um=places, weights=weights)

    @readout("cyc/mrad")
    def pupil_interval_x(self, axis: str, context: Context, pupil: Pupil) -> float:
        """Horizontal frequency interval that corresponds to one pupil sample."""
        scale = self._scale(context, pupil)
        return (scale.pitch_x_mm if axis == "x" else scale.pitch_y_mm) / scale.mean_um

    @readout("cyc/mrad")
    def image_interval_x(self, axis: str, context: Context) -> float:
        """Horizontal frequency interval of the image."""
        grid = context.grid
        return grid.frequency_interval_x if axis == "x" else grid.frequency_interval_y

    @readout("cyc/mrad")
    def cutoff_x(self, axis: str, context: Context, pupil: Pupil) -> Step | float:
        """Horizontal cutoff: width of the aperture divided by the band's middle wavelength."""
        interval: float = self.pupil_interval_x(axis, context, pupil)
        along = axis == "y"
        if pupil.shape is None:
            return Step.of(_lit_extent, pupil.samples, axis=0 if along else 1, interval=interval)
        return interval * opening(pupil.shape)[along]

    @readout()
    def estimated_error(self, context: Context, pupil: Pupil) -> Step | float:
        """Estimated upper limit on the OTF's error."""
        scale = self._scale(context, pupil)
        if self.interpolation == "none":
            return sampled_error(pupil, scale, self.title)
        if self.method == "exact" and exact_factor(pupil, scale, "", "") is not None:
            return EXACT_ERROR
        if self.method == "exact":
            pupil, scale = refined(pupil, scale, self.title)
        return sampled_error(pupil, scale, self.title)


def _weights_by_light(
    work: Work, temperature_K: float, *, spectrum: Spectrum, wavelengths_um: Row, weights: Row
) -> Row:
    """Weights of wavelengths by the light that counts; the sum is 1."""
    lit = replace(spectrum, temperature_K=temperature_K)
    light = lit.weight(np.array(wavelengths_um)) * np.array(weights)
    if not light.sum() > 0.0:
        raise DataError(
            f"the response is 0 at each of the {len(weights)} wavelengths in the band: use "
            "more wavelengths"
        )
    shares = (light / light.sum()).tolist()
    return (*shares[:-1], 1.0 - sum(shares[:-1]))


def _lit_extent(work: Work, samples: NDArray[np.float64], *, axis: int, interval: float) -> float:
    lit = np.flatnonzero(samples.any(axis=1 - axis))
    return float(lit[-1] - lit[0] + 1) * interval
