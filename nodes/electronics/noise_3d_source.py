"""3-D Noise Source: the seven components of noise by their sizes, and 1/f noise."""

from math import hypot

import numpy as np

from core.chain.noise_power import NoisePower
from core.chain.random_fields import FrameNumber
from core.chain.step_lineage import Array, AtStep, Noise, picture_step
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Region, Seen, by_region, ends_lineage, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.physics.noise.flicker_noise import FlickerBand, flicker_band, flicker_sigma
from core.physics.noise.noise_components import COMPONENTS
from nodes.shared.deviates import SEED_SECTIONS, SeededModule, flicker_deviates
from nodes.shared.module_ports import LongestPeriod, NoiseOutputs, PicturePreview

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
        names: list[str] = []
        sizes: list[float] = []
        fields: list[Recipe] = []
        for name in COMPONENTS:
            size = getattr(self, f"sigma_{name}")
            if not size:
                continue
            shape = (rows if "v" in name else 1, columns if "h" in name else 1)
            fields.append(self.deviates(here, f"sigma_{name}", shape, fixed=name in _FIXED))
            names.append(name)
            sizes.append(size)
        if self.corner_Hz:
            fields.append(
                here.step(
                    flicker_deviates,
                    stream=self.stream(here, "1/f", fixed=True),
                    number=FrameNumber(),
                    shape=image.shape,
                    band=self._band(),
                    frame_s=1.0 / self.frame_rate_Hz,
                )
            )
            names.append(_FLICKER)
            sizes.append(self._flicker_sigma())
        sigmas = tuple(sizes)
        noise = here.step(summed, *fields, sigmas=sigmas, shape=image.shape)
        if not names:
            return NoiseOutputs(image, image.with_recipe(noise))
        how = {"names": tuple(names), "sigmas": sigmas}
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

    def _band(self) -> FlickerBand:
        return flicker_band(
            frame_rate_Hz=self.frame_rate_Hz, longest_period_s=self.longest_period_s
        )

    def _flicker_sigma(self) -> float:
        if not self.corner_Hz:
            return 0.0
        return flicker_sigma(
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
