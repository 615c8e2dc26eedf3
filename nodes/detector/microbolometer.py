"""Microbolometer: an uncooled detector by its data sheet's NETD and thermal time constant."""

from typing import Any, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.random_fields import at_frame
from core.chain.step_lineage import AtStep, Noise, picture_step
from core.chain.wires import Context, Image, Table, TableData, Transfer
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Step, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, warning
from core.physics.detector.focal_plane_array import lag_weights, netd_noise_radiance, share_kept
from core.physics.detector.readout import lowpass_mtf, lowpass_ptf
from core.physics.noise import flicker_noise
from core.physics.radiometry import planck
from core.transfer.factors import Separable
from nodes.shared import context_defaults, module_ports, steps
from nodes.shared.deviates import SEED_SECTIONS, SeededModule

Pair = tuple[float, float]
_MOST_FRAMES = 64


class BolometerOutputs(NamedTuple):
    image: Image
    noise: Image
    mtf: Transfer
    ptf: Transfer
    table: Table


class Microbolometer(SeededModule, key="microbolometer", title="Microbolometer", group="Detector"):
    """Add an uncooled detector's thermal lag, and its noise from the data sheet.

    The noise, as scene radiance, is NETD·dL/dT(reference_K)·τ₀Ω₀/(τΩ)·√(t₀/t). Ω₀ (at the F-number
    F₀), τ₀, reference_K and t₀ come from the data sheet; √(t₀/t) applies if both integration times
    are given. For the NETD of a bare detector, set τ₀ = 1. A camera's NETD already includes the
    lens, so enter the lens's F-number and transmission as reference values too. Ω is the projected
    solid angle of the optics, as in Focal Plane. A bolometer's noise does not depend on the scene,
    so the NETD at another background scales as 1/(dL/dT). After one frame, the fraction
    exp(−1/(rate·time constant)) of a change remains, so a changing scene leaves traces in later
    frames. With a scan velocity on Init & Trans, the lag is a low-pass filter along the lines, 1/(1
    + 2πi·τ·v·ξ). At `corner_Hz`, 1/f noise and white noise have the same spectral density.
    Non-uniform gain and offset are the same in every frame; Non-Uniformity Correction removes them.

    The temporal filter averages recursively: y = a·y₋₁ + (1 − a)·x, where a = (n − 1)/(n + 1) and n
    is filter_frames. The filter lowers white noise by a factor of √n and 1/f noise by less, and
    delays changes in the scene. Leave `filter_frames` at 1 if the data sheet's NETD includes the
    filter. Finally, the picture is rounded to 2^bits levels between the radiances of range_low_K
    and range_high_K, and clipped at these two radiances.

    Sources: Kruse 2001, chapters 3 and 4; Rogalski 2011, chapters 4 and 22; Oppenheim and Schafer
    2010, chapter 5 (filter).
    """

    formulas = (
        Formula(
            r"\sigma_L=\mathrm{NETD}\;\frac{\partial L}{\partial T}\;\frac{\tau_0\Omega_0}{\tau\;"
            r"\Omega}\sqrt{\frac{t_0}{t}},\quad\Omega=\frac{\pi}{4F^2+1}"
            r"\left(1-\varepsilon^2\right)",
            where="NETD: data sheet value at F₀, transmission τ₀, temperature reference_K and "
            "integration time t₀; F, ε, τ, t: values of this camera",
        ),
        Formula(
            r"s_k=(1-q)\,q^k,\quad q=e^{-1/(r\,\tau_{th})}",
            where="s_k: weight of the frame k frames ago; r: frame rate; τ_th: thermal time "
            "constant",
        ),
        Formula(
            r"H(\xi)=\frac{1}{1+2\pi i\,\tau_{th}\,v\,\xi}",
            where="v: scan velocity, mrad/s",
            when="a scan",
        ),
    )

    netd_mK: float = param(50.0, "NETD from the data sheet", (0, 1e6), slider=(0, 200))
    reference_f_number: float = param(
        1.0, "F-number at which the NETD was measured", (0.1, 1000), slider=(0.5, 4)
    )
    reference_transmission: float = param(
        1.0,
        "transmission of the optics used when the NETD was measured; 1: a bare detector",
        (0, 1),
        above=True,
    )
    reference_K: float = param(
        300.0, "background temperature at which the NETD was measured", (1, 1e4), slider=(250, 350)
    )
    reference_integration_time_s: float | None = param(
        None,
        "integration time at which the NETD was measured; leave both integration "
        "times empty if they are equal",
        (0, 1e3),
    )
    f_number: float | None = param(
        None, "F-number of the camera; empty: from Init & Trans", (0.1, 1000), slider=(0.5, 4)
    )
    optics_transmission: float = param(
        1.0, "transmission of the optics, without the obscuration", (0, 1), above=True
    )
    integration_time_s: float | None = param(
        None,
        "integration time of the camera; leave both integration times empty if they are equal",
        (0, 1e3),
    )
    cut_on_um: module_ports.CutOn = None
    cut_off_um: module_ports.CutOff = None
    time_constant_s: float = param(0.01, "thermal time constant", (0, 1e3), slider=(0, 0.03))
    frame_rate_Hz: float = param(30.0, "frame rate", (1e-6, 1e9), slider=(1, 120))
    filter_frames: float = param(
        1.0,
        "temporal filter: lowers white noise as much as averaging this many frames; 1: no filter",
        (1, 16),
    )
    bits: int = param(0, "bits of the output; 0: no rounding", (0, 24), unit="bit")
    range_low_K: float | None = param(
        None,
        "scene temperature at the lowest digital number; needed if bits is above 0",
        (0, 1e4),
        slider=(200, 300),
    )
    range_high_K: float | None = param(
        None,
        "scene temperature at the highest digital number; needed if bits is above 0",
        (0, 1e4),
        slider=(300, 500),
    )
    corner_Hz: float = param(
        0.0,
        "corner frequency, where 1/f and white noise have equal spectral density; 0: no 1/f noise",
        (0, 1e9),
        slider=(0, 10),
    )
    longest_period_s: module_ports.LongestPeriod = 60.0
    response_percent: float = param(
        0.0, "PRNU: rms spread of the response between pixels", (0, 100), slider=(0, 10)
    )
    offset_mK: float = param(
        0.0,
        "rms spread of the offset between pixels, at the data sheet's background",
        (0, 1e9),
        slider=(0, 5000),
    )

    panel = (
        Section(
            "Data sheet",
            "netd_mK reference_f_number reference_transmission reference_K "
            "reference_integration_time_s",
        ),
        Section("Camera", "f_number optics_transmission integration_time_s cut_on_um cut_off_um"),
        Section("Heat", "time_constant_s frame_rate_Hz"),
        Section("1/f noise", "corner_Hz longest_period_s"),
        Section("Non-uniformity", "response_percent offset_mK"),
        Section("Read-out", "filter_frames bits range_low_K range_high_K"),
        *SEED_SECTIONS,
    )

    def check(self) -> None:
        own, other = self.integration_time_s, self.reference_integration_time_s
        if (own is None) != (other is None):
            missing = "integration_time_s" if own is None else "reference_integration_time_s"
            allowed = "give both integration_time_s and reference_integration_time_s, or neither"
            raise ParameterError(missing, None, allowed)
        low, high = self.range_low_K, self.range_high_K
        for name, value in (("bits", self.bits), ("range_low_K", low), ("range_high_K", high)):
            if not value and (self.bits or low or high):
                allowed = (
                    "above 0, because bits, range_low_K and range_high_K must be given together"
                )
                raise ParameterError(name, value, allowed)
        if low is not None and high is not None and low >= high:
            raise ParameterError("range_high_K", high, f"above range_low_K = {low:g}")
        if self.corner_Hz:
            self._flicker_band()

    def run(self, image: Image, context: Context, here: NodeContext) -> BolometerOutputs:
        band = context_defaults.given_band(self.cut_on_um, self.cut_off_um, context.band_um)
        white = self._white(context, band)
        flicker = 0.0
        if self.corner_Hz:
            flicker = flicker_noise.flicker_sigma(
                white_sigma=white, corner_Hz=self.corner_Hz, band=self._flicker_band()
            )
        factors = self._along_the_scan(context, here)
        slow = self._scanned(image, context, factors, here)
        for kept in (self._kept(), self._filter()):
            slow = self._over_frames(slow, kept, here)
        made = self._uneven(slow, image, band, here)
        white *= self._left()[0]
        flicker *= self._left()[1]
        made = self._noisy(made, image, white, flicker, here)
        limits, step = self._limits(band), 0.0
        if limits is not None:
            made = here.step(steps.quantized, made, limits=limits, bits=self.bits)
            step = (limits[1] - limits[0]) / (2.0**self.bits - 1.0)
        table = here.step(
            figures,
            image.recipe,
            band=band,
            white=white,
            flicker=flicker,
            step=step,
            response=self.response_percent / 100.0,
            offset=self._offset(band),
            kept=self._kept(),
            vignetting=image.vignetting,
        )
        noise = here.step(steps.difference, made, slow)
        mtf, ptf = module_ports.transfers(
            factors, context_defaults.with_interval(image, context), self.title
        )
        return BolometerOutputs(
            image=image.with_recipe(made, frame_rate_Hz=self.frame_rate_Hz),
            noise=image.with_recipe(noise),
            mtf=mtf,
            ptf=ptf,
            table=Table(table),
        )

    def _white(self, context: Context, band: Pair) -> float:
        optics = context_defaults.lens(
            context, optics_transmission=self.optics_transmission, f_number=self.f_number
        )
        reference = context_defaults.Lens(self.reference_f_number, 0.0, context.irradiance, 1.0)
        noise = netd_noise_radiance(
            netd_K=self.netd_mK / 1000.0,
            reference_K=self.reference_K,
            reference_sr=self.reference_transmission * reference.solid_angle_sr,
            lens_sr=optics.transmission * optics.solid_angle_sr,
            cut_on_um=band[0],
            cut_off_um=band[1],
        )
        if self.integration_time_s is None or self.reference_integration_time_s is None:
            return noise
        return noise * float((self.reference_integration_time_s / self.integration_time_s) ** 0.5)

    def _offset(self, band: Pair) -> float:
        if not self.offset_mK:
            return 0.0
        slope = planck.band_radiance_derivative(
            cut_on_um=band[0], cut_off_um=band[1], temperature_K=self.reference_K
        )
        return self.offset_mK / 1000.0 * float(slope)

    def _flicker_band(self) -> flicker_noise.FlickerBand:
        return flicker_noise.flicker_band(
            frame_rate_Hz=self.frame_rate_Hz, longest_period_s=self.longest_period_s
        )

    def _limits(self, band: Pair) -> Pair | None:
        if not self.bits or self.range_low_K is None or self.range_high_K is None:
            return None
        ends = {"cut_on_um": band[0], "cut_off_um": band[1]}
        kelvins = (self.range_low_K, self.range_high_K)
        low, high = (float(planck.band_radiance(temperature_K=one, **ends)) for one in kelvins)
        return low, high

    def _filter(self) -> float:
        """Share of the last output that the temporal filter keeps."""
        return (self.filter_frames - 1.0) / (self.filter_frames + 1.0)

    def _left(self) -> Pair:
        """White and 1/f noise behind the temporal filter, over those before it."""
        slow = 1.0
        if self.corner_Hz and self.filter_frames > 1.0:
            slow = flicker_noise.filtered_flicker(kept=self._filter(), band=self._flicker_band())
        return self.filter_frames**-0.5, slow

    def _kept(self) -> float:
        return share_kept(time_constant_s=self.time_constant_s, frame_rate_Hz=self.frame_rate_Hz)

    def _along_the_scan(self, context: Context, here: NodeContext) -> tuple[Separable, ...]:
        velocity = context.scan_velocity_mrad_per_s
        if not velocity or not self.time_constant_s:
            return ()
        law = {"scan_velocity_mrad_per_s": velocity, "time_constant_s": self.time_constant_s}
        return (
            *module_ports.separable(lowpass_mtf, x=law, label=self.title, node=here.node),
            *module_ports.separable(
                lowpass_ptf, x=law, part="ptf", label=self.title, node=here.node
            ),
        )

    def _scanned(
        self, image: Image, context: Context, factors: tuple[Separable, ...], here: NodeContext
    ) -> Recipe:
        if not factors:
            return image.recipe
        grid = context_defaults.with_interval(image, context).grid()
        how = {"factors": factors, "grid": grid, "edges": context.edges, "label": "Thermal lag"}
        return here.step(steps.filtered_lines, image.recipe, **how)

    def _over_frames(
        self, picture: Recipe, kept: float, here: NodeContext, size: float = 1.0
    ) -> Recipe:
        """Behind a lag that keeps a share from frame to frame, over a size."""
        if not kept or at_frame(picture, -1).key == picture.key:
            return picture
        weights = lag_weights(kept=kept, most=_MOST_FRAMES)
        weights = tuple(weight / size for weight in weights)
        before = [at_frame(picture, -age) for age in range(1, len(weights))]
        return here.step(lagged_frames, picture, *before, weights=weights)

    def _uneven(self, picture: Recipe, image: Image, band: Pair, here: NodeContext) -> Recipe:
        fields = [
            self.deviates(here, name, image.shape, fixed=True)
            for name, size in (("response", self.response_percent), ("offset", self.offset_mK))
            if size
        ]
        if not fields:
            return picture
        how = {"response": self.response_percent / 100.0, "offset": self._offset(band)}
        return here.step(with_pattern_of_pixels, picture, *fields, **how)

    def _noisy(
        self, picture: Recipe, image: Image, white: float, flicker: float, here: NodeContext
    ) -> Recipe:
        fields: list[Recipe] = [self.deviates(here, "white", image.shape)] if white else []
        if flicker:
            how = (image.shape, self._flicker_band(), self.frame_rate_Hz)
            fields.append(self.flicker_field(here, *how, held=True))
        if not fields:
            return picture
        sizes = [left for left, sigma in zip(self._left(), (white, flicker), strict=True) if sigma]
        pairs = zip(fields, sizes, strict=True)
        fields = [self._over_frames(field, self._filter(), here, size) for field, size in pairs]
        return here.step(with_temporal_noise, picture, *fields, white=white, flicker=flicker)

    unit = context_defaults.unit_warning("a NETD")
    band = context_defaults.band_warning
    aperture = context_defaults.context_warning(
        "The F-number differs from the value on Init & Trans.", "f_number"
    )
    transmission = context_defaults.t_number_warning

    @warning
    def settling(self) -> Caution | None:
        """The thermal lag lasts for more frames than are computed."""
        kept = self._kept()
        left = kept ** (_MOST_FRAMES - 1)
        if left <= 1e-3:
            return None
        return Caution(
            f"slow changes are approximated: {100 * left:.2g} % of a change remains after "
            f"{_MOST_FRAMES - 1} frames, and all earlier frames are treated like the "
            "earliest frame computed",
            "lower time_constant_s or frame_rate_Hz if this approximation is not accurate enough",
        )

    @warning
    def clipped(self, outputs: BolometerOutputs) -> Recipe | None:
        """The scene exceeds the range of the output."""
        low, high = self.range_low_K, self.range_high_K
        if not self.bits or low is None or high is None:
            return None
        table: Any = outputs.table.recipe
        seen, band = Step.of(steps.picture_range, *table.inputs), dict(table.parameters)["band"]
        return Step.of(range_caution, seen, limits=self._limits(band), kelvin=(low, high))

    figures = module_ports.TableFigures(
        ("netd_K", "K", "NETD: temporal noise as a temperature difference."),
        ("white_netd_K", "K", "White noise as a temperature difference."),
        ("flicker_K", "K", "1/f noise as a temperature difference."),
        ("quantization_K", "K", "Quantization noise as a temperature difference."),
        (
            "fixed_pattern_K",
            "K",
            "Fixed-pattern noise from non-uniform gain and offset, as a temperature difference.",
        ),
        ("noise_radiance", "W/m²/sr", "Temporal noise as scene radiance."),
        ("snr", "", "SNR: mean signal over temporal noise."),
        ("scene_K", "K", "Brightness temperature of the picture's mean."),
        ("lag_percent", "%", "Lag: fraction of a change that remains after one frame."),
    )


def _lag(*_: Recipe, weights: tuple[float, ...]) -> steps.Carried:
    """Temporal noise by the root of the sum of squares of the weights."""
    return steps.Carried(temporal=float(np.linalg.norm(weights)))


@picture_step(linear=_lag)
@pointwise
def lagged_frames(work: Work, picture: Array, *before: Array, weights: tuple[float, ...]) -> Array:
    total = np.multiply(picture, picture.dtype.type(weights[0]))
    for frame, weight in zip(before, weights[1:], strict=True):
        total += frame * frame.dtype.type(weight)
    return np.asarray(total)


def _patterns(
    at: AtStep, picture: Recipe, *_: Recipe, response: float, offset: float
) -> list[Noise]:
    noises = []
    if response:
        seen = np.asarray(at.work.value(picture), np.float64)
        level = np.float64(seen.mean()) if at.uniform else seen
        noises.append(at.white("response", (response * level) ** 2, temporal=False))
    if offset:
        noises.append(at.white("offset", offset**2, temporal=False))
    return noises


@picture_step(noise=_patterns, looks_at=("picture",))
@pointwise
def with_pattern_of_pixels(
    work: Work, picture: Array, *deviates: Array, response: float, offset: float
) -> Array:
    number, made = picture.dtype.type, picture.copy()
    if response:
        made *= deviates[0] * number(response) + number(1.0)
    if offset:
        made += deviates[-1] * number(offset)
    return made


def _temporal(at: AtStep, picture: Recipe, *_: Recipe, white: float, flicker: float) -> list[Noise]:
    noises = [at.white("NETD", white**2)] if white else []
    return [*noises, at.white("1/f", flicker**2)] if flicker else noises


@picture_step(noise=_temporal)
@pointwise
def with_temporal_noise(
    work: Work, picture: Array, *deviates: Array, white: float, flicker: float
) -> Array:
    number, made = picture.dtype.type, picture.copy()
    if white:
        made += deviates[0] * number(white)
    if flicker:
        made += deviates[-1] * number(flicker)
    return made


def range_caution(
    work: Work, seen: steps.PictureRange, *, limits: Pair, kelvin: Pair
) -> Caution | None:
    if seen.low >= limits[0] and seen.high <= limits[1]:
        return None
    return Caution(
        f"the scene has pixels outside {kelvin[0]:g} to {kelvin[1]:g} K, which are clipped; NETD "
        "and SNR ignore the clipping",
        "lower range_low_K or raise range_high_K",
    )


@in_blocks()
def figures(
    work: Work,
    picture: Array,
    *,
    band: Pair,
    white: float,
    flicker: float,
    step: float,
    response: float,
    offset: float,
    kept: float,
    vignetting: float,
) -> TableData:
    mean = float(np.mean(picture, dtype=np.float64))
    kelvin = slope = None
    if mean * vignetting > 0.0:
        ends = {"cut_on_um": band[0], "cut_off_um": band[1]}
        kelvin = float(planck.brightness_temperature(radiance=mean / vignetting, **ends))
        slope = vignetting * float(planck.band_radiance_derivative(temperature_K=kelvin, **ends))
    rounding, pattern = step / 12.0**0.5, float(np.hypot(response * mean, offset))
    temporal = float(np.hypot(np.hypot(white, flicker), rounding))

    def in_kelvin(noise: float) -> float | None:
        return noise / slope if slope else None

    return Microbolometer.figures.table(
        ("netd_K", in_kelvin(temporal)),
        ("white_netd_K", in_kelvin(white)),
        ("flicker_K", in_kelvin(flicker)),
        ("quantization_K", in_kelvin(rounding)),
        ("fixed_pattern_K", in_kelvin(pattern)),
        ("noise_radiance", temporal),
        ("snr", mean / temporal if temporal else None),
        ("scene_K", kelvin),
        ("lag_percent", 100.0 * kept),
    )
