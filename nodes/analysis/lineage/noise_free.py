"""The picture without noise: what its noise is measured against."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.chain.frame_sequence import Remaking
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.filtering.local_mean import local_mean
from core.physics.noise.poisson_deviates import published_means
from nodes.analysis.lineage.transfer_lineage import PASSING
from nodes.electronics.noise_steps import Array, read_out
from nodes.optics.poisson_noise import added, published_noise


def noise_free(recipe: Recipe, *, but: Recipe | None = None) -> Recipe:
    """The same picture with every noise at its expected value, and nothing rounded.

    Parameters
    ----------
    recipe : Recipe
        Makes the picture.
    but : Recipe, optional
        A step on the way that keeps what it adds.

    Raises
    ------
    DataError
        Where a gain error as printed scales the whole picture.
    """

    def change(each: Recipe) -> Recipe | None:
        if not isinstance(each, Step) or each.function not in PASSING:
            return None
        values = dict(each.parameters)
        if each.function is read_out and values["model"] == "literal":
            raise DataError(
                "gain_model literal scales the picture by the gain error: without it nothing is "
                "left; take per_pixel or published"
            )
        picture = made.of(each.inputs[0])
        if but is not None and each.key == but.key:
            return replace(each, inputs=(picture, *each.inputs[1:]))
        noise = each.inputs[1] if each.function is added else None
        if isinstance(noise, Step) and noise.function is published_noise:
            # Photons added as a share of the picture have a mean, which is no noise.
            how = dict(noise.parameters)
            sigma_px, percent = how["sigma_px"], how["percent"]
            return Step.of(expected, picture, node=each.node, sigma_px=sigma_px, percent=percent)
        return picture

    made = Remaking(change)
    return made.of(recipe)


def expected(work: Work, image: Array, *, sigma_px: float, percent: float) -> Array:
    """Picture and mean of the photons that are added to it."""
    means = published_means(local_mean(work, image, sigma_px=sigma_px), percent=percent)
    return np.add(image, means, dtype=work.policy.dtype)
