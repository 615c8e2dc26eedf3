"""Noise added to a picture: of photons, periodic, from a file, and by its seven components."""

import math
from math import hypot
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.arrays import Array
from core.chain import random_fields
from core.chain.engine import PlannedNode
from core.chain.noise_power import NoisePower
from core.chain.step_lineage import AtStep, Noise, picture_step
from core.chain.wires import Image, TableData
from core.errors import DataError, ParameterError
from core.evaluation.recipes import (
    Recipe,
    Region,
    Seen,
    Step,
    by_region,
    ends_lineage,
    in_blocks,
    pointwise,
)
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.modules.preview import Axis, Curve, Plot, Preview, brief
from core.physics.noise import flicker_noise
from core.physics.noise.noise_components import COMPONENTS
from core.transfer.factors import Grid
from nodes.files.stored_bytes import checked_band
from nodes.input_output.sample_unit import statistics
from nodes.input_output.source_file import picture_source, read_step
from nodes.shared.context_defaults import is_temperature, unit_caution
from nodes.shared.deviates import SEED_SECTIONS, SeededModule
from nodes.shared.module_ports import LongestPeriod, NoiseOutputs, PicturePreview, TableFigures
from nodes.shared.steps import difference, even


@in_blocks()
def _moments(work: Work, noise: Array) -> TableData:
    found = statistics(noise, for_each=work.for_each)
    return TableData.of(("noise_mean", found.mean), ("noise_sigma", found.sigma))


class PoissonNoise(
    SeededModule, key="poisson_noise", title="Poisson Noise", group="Electronics & Noise"
):
    """Add photon noise to the picture, with the 1996 model or by counting photons.

    `published` adds a Poisson deviate whose mean is a percentage of the Gaussian-weighted local
    mean. `photon` converts radiance to a number of photons and replaces that number with a Poisson
    deviate. The 1996 model has no photon scale, so its relative noise changes with the radiance
    unit. The 1996 model also adds the noise before the optics have collected the light. For the
    shot noise of a detector, use Focal Plane. Source: Tantalo 1996, section 4.3.4, after Frieden
    1991.
    """

    formulas = (
        Formula(
            r"L'=L+n,\quad n\sim\mathrm{Poisson}\left(\frac{q}{100}\,\overline{L}\right)",
            where=(
                "q: percent; L̄: Gaussian-weighted mean of the surrounding samples, with a "
                "standard deviation of width_px"
            ),
            when="published",
        ),
        Formula(
            r"L'=\frac{n}{\kappa},\quad n\sim\mathrm{Poisson}(\kappa L)",
            where="κ: photons_per_unit",
            when="photon",
        ),
    )

    width_px: float = param(
        5.0, "standard deviation of the Gaussian that weights the local mean", low=0, slider=(0, 50)
    )
    percent: float = param(
        1.0,
        "mean of the Poisson deviate, as a fraction of the local mean",
        low=0,
        unit="%",
        slider=(0, 100),
    )
    photons_per_unit: float | None = param(
        None, "photons per unit of radiance; needed if mode is photon", low=0
    )
    mode: Literal["published", "photon"] = param(
        "published",
        "published: add a Poisson deviate to each sample; photon: replace each sample with a "
        "Poisson deviate",
    )

    panel = (
        Section("", "mode"),
        Section("", "width_px percent", shown_when=("mode", ("published",))),
        Section("", "photons_per_unit", shown_when=("mode", ("photon",))),
        *SEED_SECTIONS,
    )

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        stream = self.stream(here, "photons")
        if self.mode == "published":
            if self.percent == 0:
                noise: Recipe = Step.of(even, shape=image.shape, value=0.0)
                return NoiseOutputs(image, image.with_recipe(noise))
            how: Any = {"sigma_px": self.width_px, "percent": self.percent}
            noise = here.step(published_noise, image.recipe, stream=stream, **how)
            noisy = here.step(added, image.recipe, noise)
        else:
            if self.photons_per_unit is None:
                raise ParameterError(
                    "photons_per_unit", None, "give a number, because mode is photon"
                )
            noisy = here.step(
                photon_counts, image.recipe, photons_per_unit=self.photons_per_unit, stream=stream
            )
            noise = here.step(difference, noisy, image.recipe)
        return NoiseOutputs(image.with_recipe(noisy), image.with_recipe(noise))

    @warning
    def unit(self, image: Image) -> Caution | None:
        """The picture is in units of temperature, which is not proportional to photon numbers."""
        if self.mode != "photon" or not is_temperature(image.unit):
            return None
        return unit_caution(image.unit, meant="photons_per_unit")

    @warning
    def scale(self, image: Image) -> Caution | None:
        """The amount of noise in the 1996 model changes with the unit of radiance."""
        if self.mode != "published" or self.percent == 0:
            return None
        unit = image.unit.strip()
        named = f", {unit!r:.40}," if unit else ""
        return Caution(
            f"the amount of noise depends on the picture's unit{named} because the 1996 model "
            "draws Poisson deviates in that unit; the noise is added before the optics",
            "keep this node to compare with Tantalo's thesis; for a camera's shot noise, delete "
            "this node and use Focal Plane, which counts electrons at the detector",
        )

    moments = TableFigures(
        ("noise_mean", None, "Mean of the noise."),
        ("noise_sigma", None, "Standard deviation of the noise."),
        unit_of="image",
        table=lambda outputs: Step.of(_moments, outputs.noise.recipe),
    )


@in_blocks()
@ends_lineage
def published_noise(
    work: Work, image: Array, *, sigma_px: float, percent: float, stream: random_fields.Stream
) -> Array:
    """The added deviates, by their events where these are few."""
    share = percent / 100.0
    if random_fields.events_are_few(image, share=share, sigma_px=sigma_px):
        return random_fields.displaced_events(
            image, stream, share=share, sigma_px=sigma_px, for_each=work.for_each, empty=work.empty
        )
    # One array serves as local mean, means and counts in turn.
    local = random_fields.local_mean(work, image, sigma_px=sigma_px)
    means = flicker_noise.published_means(local, percent=percent, out=local)
    return random_fields.poisson_field(means, stream, for_each=work.for_each, in_place=True)


@in_blocks()
@picture_step(
    noise=lambda at, image, photons_per_unit, **_: [
        at.white("photons", at.work.value(image) / photons_per_unit)
    ],
    looks_at=("image",),
)
def photon_counts(
    work: Work, image: Array, *, photons_per_unit: float, stream: random_fields.Stream
) -> Array:
    means = work.empty(image.shape, image.dtype)
    flicker_noise.photon_means(image, photons_per_unit=photons_per_unit, out=means)
    counts = random_fields.poisson_field(means, stream, for_each=work.for_each, in_place=True)
    return flicker_noise.radiance_of_photons(counts, photons_per_unit=photons_per_unit, out=counts)


def _photons_added(at: AtStep, image: Recipe, noise: Recipe) -> list[Noise]:
    """Poisson deviates of a share of the local mean: that is their variance too."""
    how = _share_of(noise)
    local = random_fields.local_mean(at.work, at.work.value(image), sigma_px=how["sigma_px"])
    return [at.white("photons", how["percent"] / 100.0 * local)]


def _mean_added(image: Recipe, noise: Recipe) -> Step:
    """Photons added as a share of the picture have a mean, which is no noise."""
    return Step.of(expected, image, **_share_of(noise))


def _share_of(noise: Recipe) -> dict[str, Any]:
    assert isinstance(noise, Step)
    how = dict(noise.parameters)
    return {name: how[name] for name in ("sigma_px", "percent")}


@in_blocks()
@ends_lineage
def expected(work: Work, image: Array, *, sigma_px: float, percent: float) -> Array:
    local = random_fields.local_mean(work, image, sigma_px=sigma_px)
    means = flicker_noise.published_means(local, percent=percent, out=local)
    return np.add(image, means, dtype=work.policy.dtype, out=means)


@picture_step(noise=_photons_added, looks_at=("image",), noise_free=_mean_added)
@pointwise
def added(work: Work, image: Array, noise: Array) -> Array:
    return np.asarray(image + noise)


_BLOCK_SAMPLES = 1 << 16
_POINTS = 801  # of the preview
_PERIODS, _ENVELOPES = 6.0, 1.5
_MOST_PERIODS = 60.0  # more would be a grey area
_NO_NOISE = "no noise is added, because the amplitude is 0"


class PeriodicNoise(
    Module, key="periodic_noise", title="Periodic Noise", group="Electronics & Noise"
):
    """Add sinusoidal noise, such as pick-up from a power supply, optionally modulated in amplitude.

    The noise is amplitude·(1 + modulation·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ). The
    coordinates x and y are 0 at the first sample. Frequencies beyond Nyquist are aliased. An
    amplitude of 0 changes nothing. Source: Tantalo 1996, chapter 3.
    """

    formulas = (
        Formula(
            r"n=A\left[1+m\,\sin\left(2\pi(\xi_mx+\eta_my)+\phi_m\right)\right]\sin\left(2\pi("
            r"\xi x+\eta y)+\phi\right)",
            where="n: noise added to the picture; A: amplitude; m: modulation; x, y: mrad from the "
            "first sample",
        ),
    )

    amplitude: float = param(0.0, "amplitude, in the picture's unit", slider=(0, 10))
    xi: float = param(0.1, "horizontal frequency", unit="cyc/mrad", slider=(-1, 1))
    eta: float = param(0.0, "vertical frequency", unit="cyc/mrad", slider=(-1, 1))
    phase_deg: float = param(0.0, "phase at the first sample", slider=(-180, 180))
    modulation: float = param(0.0, "modulation depth", (0, 1))
    modulation_xi: float = param(
        0.01, "horizontal frequency of the modulation", unit="cyc/mrad", slider=(-1, 1)
    )
    modulation_eta: float = param(
        0.0, "vertical frequency of the modulation", unit="cyc/mrad", slider=(-1, 1)
    )
    modulation_phase_deg: float = param(
        0.0, "phase of the modulation at the first sample", slider=(-180, 180)
    )

    preview_lines = 9.5
    panel = (
        Section("Sinusoid", "amplitude xi eta phase_deg"),
        Section("Modulation", "modulation modulation_xi modulation_eta modulation_phase_deg"),
    )

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        if self.amplitude == 0.0:
            # No interval is needed where there is nothing to draw.
            flat = here.step(even, shape=image.shape, value=0.0)
            return NoiseOutputs(image, image.with_recipe(flat))
        pattern = here.step(drawn, grid=image.grid(), **self._pattern())
        total = here.step(with_known, image.recipe, pattern, kind="periodic")
        return NoiseOutputs(image.with_recipe(total), image.with_recipe(pattern))

    def _pattern(self) -> dict[str, float]:
        values = self.values()
        for name in ("phase", "modulation_phase"):
            values[f"{name}_rad"] = math.radians(values.pop(f"{name}_deg"))
        return values

    def preview(self, _planned: PlannedNode, _work: Work, _here: NodeContext) -> Preview:
        if self.amplitude == 0:
            return Preview(_NO_NOISE, (_NO_NOISE,))
        end = self._end_mrad()
        places, start = np.linspace(0.0, end, _POINTS), np.zeros(1)
        size = 1.1 * abs(self.amplitude) * (1 + self.modulation)
        values = self._pattern()
        x = flicker_noise.periodic_pattern(x_mrad=places, y_mrad=start, **values)
        y = flicker_noise.periodic_pattern(x_mrad=start, y_mrad=places, **values)
        curves = Curve(places, x, name="x"), Curve(places, y, 1, "dashed", name="y")
        across = Axis(0.0, end, "distance from the first sample (mrad)")
        words = (
            f"sinusoid of amplitude {brief(self.amplitude)} at {brief(self.xi)} cyc/mrad "
            f"horizontally and {brief(self.eta)} vertically"
        )
        if self.modulation > 0:
            words += f", modulated by {brief(100 * self.modulation)} %"
        return Preview(words, (Plot(across, Axis(-size, size, "noise"), curves),))

    def _end_mrad(self) -> float:
        """How far it is drawn: some periods, or enough to see the modulation."""
        highest = max(abs(self.xi), abs(self.eta))
        end = _PERIODS / highest if highest > 0 else 100.0
        slow = [f for f in (abs(self.modulation_xi), abs(self.modulation_eta)) if f > 0]
        if self.modulation > 0 and slow:
            end = max(end, _ENVELOPES / max(slow))
        return min(end, _MOST_PERIODS / highest) if highest > 0 else end


@ends_lineage
@by_region(lambda *, grid, **_: grid.shape)
def drawn(work: Work, region: Region, *, grid: Grid, **values: float) -> Array:
    pattern = np.empty(region.shape, work.policy.dtype)
    rows, columns = region.slices
    x_mrad = np.arange(columns.start, columns.stop) * grid.interval_x_mrad
    y_mrad = np.arange(rows.start, rows.stop)[:, np.newaxis] * grid.interval_y_mrad

    def block(lines: slice) -> None:
        pattern[lines] = flicker_noise.periodic_pattern(
            x_mrad=x_mrad, y_mrad=y_mrad[lines], **values
        )

    step = max(1, _BLOCK_SAMPLES // region.columns)
    work.for_each(block, [slice(start, start + step) for start in range(0, region.rows, step)])
    return pattern


@picture_step(noise=lambda at, *_, kind: [at.known(kind)])
@pointwise
def with_known(work: Work, image: Array, noise: Array, *, kind: str) -> Array:
    return np.add(image, noise, dtype=work.policy.dtype)


class NoiseFile(Module, key="noise_file", title="Noise File", group="Electronics & Noise"):
    """Add noise from a file, times `scale`, to a picture of the same size.

    The file may have any format that Read Image reads. The mean of the noise is added too. A scale
    of 0 changes nothing. Source: Tantalo 1996, chapter 3.
    """

    formulas = (Formula(r"L'=L+s\,n", where="n: samples of the file; s: scale"),)

    path: Path | None = param(None, "noise file, relative to the network file's folder")
    band: int = param(0, "band or channel to read, counted from 0", low=0)
    scale: float = param(1.0, "factor that converts the file to the picture's unit", slider=(0, 10))

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        source = picture_source(self.path, here)
        info = source.info
        checked_band(self.band, info.bands, info.path)
        if (info.rows, info.columns) != image.shape:
            raise DataError(
                f"the noise in {info.path.name} has {info.columns} × {info.rows} samples and the "
                f"picture has {image.columns} × {image.rows}: give a noise file of the same size"
            )
        noise = read_step(source, band=self.band, scale=self.scale, node=here.node)
        if self.scale == 0.0:
            return NoiseOutputs(image, image.with_recipe(noise))
        total = here.step(with_known, image.recipe, noise, kind="file")
        return NoiseOutputs(image.with_recipe(total), image.with_recipe(noise))


_FIXED = ("vh", "v", "h")
_FLICKER = "1/f"


class Noise3DSource(
    SeededModule,
    PicturePreview,
    key="noise_3d_source",
    title="3-D Noise Source",
    group="Electronics & Noise",
):
    """Add 3-D noise from its components: time (t), rows (v), columns (h) and their combinations.

    Each component is Gaussian with its own standard deviation, in the unit of the picture. In a
    sequence, v, h and vh are the same in every frame, and the other components are new in each
    frame. `corner_Hz` adds 1/f noise to each sample; at this frequency, 1/f noise and sigma_tvh
    have the same spectral density. The 1/f noise extends from 1/`longest_period_s` to half the
    frame rate, and any frame can be computed independently. All variance of the 1/f noise is
    temporal. 3-D Noise analyses a limited number of frames, so it counts changes over longer times
    as fixed pattern (vh). Without any component, the picture does not change. Sources: D'Agostino
    and Webb 1991; for 1/f, Shinozuka and Deodatis 1991 (spectral representation).
    """

    formulas = (
        Formula(
            r"L'=L+n_t+n_v+n_h+n_{tv}+n_{th}+n_{vh}+n_{tvh}+n_{1/f}",
            where="each component is normally distributed with its own standard deviation and "
            "varies with its indices: frame (t), row (v), column (h)",
        ),
        Formula(
            r"S(f)=\frac{2\,\sigma_{tvh}^2}{f_R}\;\frac{f_k}{f}",
            where="S: power spectral density of a sample's 1/f noise, which equals the density of "
            "σ_tvh at f_k = corner_Hz; f_R: frame rate",
        ),
    )

    sigma_tvh: float = param(
        0.0, "rms random noise, from pixel to pixel and frame to frame", (0, 1e15), slider=(0, 1)
    )
    sigma_tv: float = param(
        0.0, "rms row noise that changes from frame to frame", (0, 1e15), slider=(0, 1)
    )
    sigma_th: float = param(
        0.0, "rms column noise that changes from frame to frame", (0, 1e15), slider=(0, 1)
    )
    sigma_t: float = param(0.0, "rms flicker of the whole frame", (0, 1e15), slider=(0, 1))
    sigma_vh: float = param(0.0, "rms fixed pattern, pixel by pixel", (0, 1e15), slider=(0, 1))
    sigma_v: float = param(0.0, "rms row noise, the same in every frame", (0, 1e15), slider=(0, 1))
    sigma_h: float = param(
        0.0, "rms column noise, the same in every frame", (0, 1e15), slider=(0, 1)
    )
    corner_Hz: float = param(
        0.0,
        "corner frequency, where 1/f noise and sigma_tvh have equal spectral density; 0: no 1/f "
        "noise",
        (0, 1e9),
        slider=(0, 10),
    )
    frame_rate_Hz: float = param(30.0, "frame rate, for 1/f noise", (1e-6, 1e9), slider=(1, 120))
    longest_period_s: LongestPeriod = 60.0

    panel = (
        Section("Temporal", "sigma_tvh sigma_tv sigma_th sigma_t"),
        Section("Fixed", "sigma_vh sigma_v sigma_h"),
        Section("1/f", "corner_Hz frame_rate_Hz longest_period_s"),
        *SEED_SECTIONS,
    )

    def check(self) -> None:
        if not self.corner_Hz:
            return
        if not self.sigma_tvh:
            allowed = (
                "above 0 if corner_Hz is above 0, because sigma_tvh sets the level of the 1/f noise"
            )
            raise ParameterError("sigma_tvh", 0.0, allowed)
        self._band()

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        """Plan the components and their sum; one that is 0 is not drawn."""
        rows, columns = image.shape
        parts: list[tuple[str, float, Recipe]] = []
        for name in COMPONENTS:
            if size := getattr(self, f"sigma_{name}"):
                shape = (rows if "v" in name else 1, columns if "h" in name else 1)
                field = self.deviates(here, f"sigma_{name}", shape, fixed=name in _FIXED)
                parts.append((name, size, field))
        if self.corner_Hz:
            field = self.flicker_field(here, image.shape, self._band(), self.frame_rate_Hz)
            parts.append((_FLICKER, self._flicker_sigma(), field))
        sigmas = tuple(size for _, size, _ in parts)
        fields = (field for _, _, field in parts)
        noise = here.step(summed, *fields, sigmas=sigmas, shape=image.shape)
        if not parts:
            return NoiseOutputs(image, image.with_recipe(noise))
        how = {"names": tuple(name for name, _, _ in parts), "sigmas": sigmas}
        total = here.step(with_components, image.recipe, noise, **how)
        return NoiseOutputs(image.with_recipe(total), image.with_recipe(noise))

    @warning
    def few_lines(self, image: Image) -> Caution | None:
        """Row or column noise is set, but the picture has a single row or column."""
        for name, count, what in (("v", image.rows, "row"), ("h", image.columns, "column")):
            used = [n for n in COMPONENTS if name in n and getattr(self, f"sigma_{n}")]
            if count == 1 and used:
                return Caution(
                    f"sigma_{used[0]} has no meaning here: the picture has a single {what}",
                    f"set sigma_{used[0]} to 0, or use a picture with more {what}s",
                )
        return None

    @readout()
    def temporal(self) -> float:
        """Total rms temporal noise of a sample, including 1/f noise, in the picture's unit."""
        temporal = (self.sigma_tvh, self.sigma_tv, self.sigma_th, self.sigma_t)
        return hypot(*temporal, self._flicker_sigma())

    @readout()
    def fixed(self) -> float:
        """Total rms fixed-pattern noise of a sample, in the picture's unit."""
        return hypot(self.sigma_vh, self.sigma_v, self.sigma_h)

    @readout()
    def flicker(self) -> float:
        """Rms 1/f noise alone, in the picture's unit."""
        return self._flicker_sigma()

    def _band(self) -> flicker_noise.FlickerBand:
        return flicker_noise.flicker_band(
            frame_rate_Hz=self.frame_rate_Hz, longest_period_s=self.longest_period_s
        )

    def _flicker_sigma(self) -> float:
        if not self.corner_Hz:
            return 0.0
        return flicker_noise.flicker_sigma(
            white_sigma=self.sigma_tvh, corner_Hz=self.corner_Hz, band=self._band()
        )


@ends_lineage
@by_region(lambda *_, shape, **__: shape)
def summed(
    work: Work, region: Region, *fields: Seen, sigmas: tuple[float, ...], shape: tuple[int, int]
) -> Array:
    total = np.zeros(region.shape, work.policy.dtype)
    for field, sigma in zip(fields, sigmas, strict=True):
        total += field(region) * total.dtype.type(sigma)
    return total


def _components(
    at: AtStep, image: Recipe, noise: Recipe, *, names: tuple[str, ...], sigmas: tuple[float, ...]
) -> list[Noise]:
    """Of rows and columns all power lies in the waves that do not vary along them."""
    noises = []
    for name, sigma in zip(names, sigmas, strict=True):
        if name == _FLICKER:
            noises.append(at.white(name, sigma**2))
            continue
        rows = 1 if "v" in name else at.rows
        columns = 1 if "h" in name else at.columns
        power = np.zeros((rows, columns))
        power[0, 0] = sigma**2 * rows * columns
        coloured = NoisePower(at.rows, at.columns, power)
        noises.append(at.coloured(name, coloured, temporal=name not in _FIXED))
    return noises


@picture_step(noise=_components)
@pointwise
def with_components(
    work: Work, image: Array, noise: Array, *, names: tuple[str, ...], sigmas: tuple[float, ...]
) -> Array:
    return np.add(image, noise, dtype=work.policy.dtype)
