"""Which stage contributes how much of the final picture's noise and blur, as in Noise Budget.

Noise is predicted from the chain, for all sensors of the kind; beside it stands what this picture
has, less the same picture without noise. Blur is taken at half the Nyquist frequency of the
picture's pixels, before a frame grabber interpolates them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from app.run.evaluation import Evaluation
from core.chain.wires import Image
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work
from nodes.analysis.budget_shares import (
    BlurShares,
    NoiseShares,
    blur_shares,
    noise_shares,
    unknown_before,
)
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.input_output.sample_unit import statistics

Found = TypeVar("Found")
_NO_PICTURE = "the network has no final picture"
_IN_BLOCKS = "the pictures are made in blocks, and noises followed through whole ones"


@dataclass(frozen=True)
class Measured:
    """All noise of this one picture: what it adds to the mean, and its deviation."""

    mean: float
    sigma: float


@dataclass(frozen=True)
class NoiseBudget:
    """Every source as predicted; `measured` is a reason where this picture cannot be compared."""

    port: str
    unit: str
    predicted: NoiseShares
    measured: Measured | str


def noise_budget(evaluation: Evaluation) -> NoiseBudget | str:
    """Every noise's share, or the reason why there is none."""
    port = evaluation.chain.final
    if port is None:
        return _NO_PICTURE
    if evaluation.work.blocks is not None:
        return _IN_BLOCKS
    image: Image = evaluation.plan.output(port)
    work = evaluation.engine.work(evaluation.work.policy)
    predicted = _tried(lambda: noise_shares(work, work.value(NoiseOf(image)), kind="all"))
    if isinstance(predicted, str):
        return predicted
    if not predicted.shares:
        return f"no noise is added on the way to {port}"
    return NoiseBudget(port, image.unit, predicted, _tried(lambda: _measured(work, image)))


def _measured(work: Work, image: Image) -> Measured:
    clean = work.value(noise_free(image.recipe))
    noise = statistics(np.subtract(work.value(image.recipe), clean), for_each=work.for_each)
    return Measured(noise.mean, noise.sigma)


def blur_budget(evaluation: Evaluation) -> BlurShares | str:
    """Every stage's share, or the reason why there is none."""
    port = evaluation.chain.final
    if port is None:
        return _NO_PICTURE
    image: Image = evaluation.plan.output(port)
    work = evaluation.engine.work(evaluation.work.policy)
    shares = _tried(lambda: _blur(evaluation, work, image))
    if isinstance(shares, str) or shares.shares:
        return shares
    if shares.before is not None:
        return f"what {shares.before} does is not known as transfer functions"
    return f"no transfer function other than 1 leads to {port}"


def _blur(evaluation: Evaluation, work: Work, image: Image) -> BlurShares:
    passed = transfer_of(image)
    grid = evaluation.chain.combined or evaluation.chain.grid or image.grid()
    return blur_shares(
        work,
        stages=passed.part("mtf"),
        frequency=(0.5 * grid.nyquist_x, 0.5 * grid.nyquist_y),
        before=unknown_before(passed),
    )


def _tried(make: Callable[[], Found]) -> Found | str:
    """What is made, or why it cannot be: the run itself has not failed."""
    try:
        return make()
    except Cancelled:
        raise
    except ImagechainError as error:
        return str(error)
