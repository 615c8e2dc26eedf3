"""Poisson Noise: photon noise of the scene."""

from typing import Any, Literal

import numpy as np

from core.chain import random_fields
from core.chain.step_lineage import Array, AtStep, Noise, picture_step
from core.chain.wires import Image, TableData
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, warning
from core.physics.noise.flicker_noise import photon_means, published_means, radiance_of_photons
from nodes.input_output.sample_unit import statistics
from nodes.shared.context_defaults import is_temperature, unit_caution
from nodes.shared.deviates import SEED_SECTIONS, SeededModule
from nodes.shared.module_ports import NoiseOutputs, TableFigures
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
        ("noise_mean", "W/m²/sr", "Mean of the noise."),
        ("noise_sigma", "W/m²/sr", "Standard deviation of the noise."),
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
    means = published_means(local, percent=percent, out=local)
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
    photon_means(image, photons_per_unit=photons_per_unit, out=means)
    counts = random_fields.poisson_field(means, stream, for_each=work.for_each, in_place=True)
    return radiance_of_photons(counts, photons_per_unit=photons_per_unit, out=counts)


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
    means = published_means(local, percent=percent, out=local)
    return np.add(image, means, dtype=work.policy.dtype, out=means)


@picture_step(noise=_photons_added, looks_at=("image",), noise_free=_mean_added)
@pointwise
def added(work: Work, image: Array, noise: Array) -> Array:
    return np.asarray(image + noise)
