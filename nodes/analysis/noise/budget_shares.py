"""What each noise and each stage contributes to a picture, predicted from its chain."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.noise.loss_shares import loss, shares_of_losses
from nodes.analysis.lineage import ImageNoise, ImageTransfer
from nodes.analysis.lineage.line_transfer import Line, Stage, stage_along

Kind = Literal["all", "temporal", "fixed"]
_NOTHING = 1e-20  # of the variance: what a source of two kinds has so little of, it has not
_ROUNDING = 1e-12
_LINES = (Line.at(0.0), Line.at(90.0))


@dataclass(frozen=True)
class NoiseShare:
    """One source's noise in the picture, and its shares of the variance of all that count.

    Parameters
    ----------
    node, name : str
        The node that adds it, and what it is there.
    temporal, fixed : float or None
        Its deviation from frame to frame and of its fixed pattern, in the picture's unit; None of
        a kind that it has not.
    share_temporal, share_fixed : float
        Shares, 0 to 1, that these have of the variance.
    """

    node: str
    name: str
    temporal: float | None
    fixed: float | None
    share_temporal: float
    share_fixed: float

    @property
    def sigma(self) -> float:
        """Deviation of both kinds together."""
        return math.hypot(self.temporal or 0.0, self.fixed or 0.0)


@dataclass(frozen=True)
class NoiseShares:
    """Every noise in the picture; the deviations `temporal` and `fixed` are those of all."""

    shares: tuple[NoiseShare, ...]
    temporal: float
    fixed: float
    mean: float

    @property
    def sigma(self) -> float:
        """Deviation of all noise together."""
        return math.hypot(self.temporal, self.fixed)


@dataclass(frozen=True)
class BlurShare:
    """One stage's |MTF| across and along, and its share of what is lost (negative: sharpens)."""

    node: str
    label: str
    mtf: tuple[float, float]
    share: tuple[float, float]

    @property
    def losses(self) -> tuple[float, float]:
        """−ln |MTF| across and along."""
        return loss(mtf=self.mtf[0]), loss(mtf=self.mtf[1])


@dataclass(frozen=True)
class BlurShares:
    """Every stage that blurs, at one frequency across and one along, cycles/mrad.

    `before` is the node before which no transfer function is known, None if all are.
    """

    frequency: tuple[float, float]
    shares: tuple[BlurShare, ...]
    before: str | None = None

    @property
    def mtf(self) -> tuple[float, float]:
        """|MTF| of all stages together, across and along."""
        x, y = (math.prod((share.mtf[axis] for share in self.shares), start=1.0) for axis in (0, 1))
        return x, y


@ends_lineage
def noise_shares(work: Work, noise: ImageNoise, *, kind: Kind) -> NoiseShares:
    """Sources of the noises of a kind, one entry for each, and their shares.

    Raises
    ------
    DataError
        If noise cannot be followed to the picture.
    """
    noise.require_known()
    variances: dict[tuple[str, str], dict[bool, float]] = {}
    for term in noise.terms:
        by_time = variances.setdefault((term.node, term.name), {})
        by_time[term.temporal] = by_time.get(term.temporal, 0.0) + max(term.variances.total, 0.0)
    whole = {
        temporal: math.fsum(by_time.get(temporal, 0.0) for by_time in variances.values())
        for temporal in (True, False)
    }
    counted = [temporal for temporal in (True, False) if kind in ("all", _kind(temporal))]
    total = math.fsum(whole[temporal] for temporal in counted)
    for by_time in variances.values():
        for temporal in [key for key in by_time if by_time[key] < _NOTHING * sum(whole.values())]:
            if len(by_time) > 1:
                del by_time[temporal]

    def sigma(by_time: dict[bool, float], temporal: bool) -> float | None:
        there = temporal in by_time and temporal in counted
        return math.sqrt(by_time[temporal]) if there else None

    def share(by_time: dict[bool, float], temporal: bool) -> float:
        return by_time.get(temporal, 0.0) / total if total and temporal in counted else 0.0

    shares = (
        NoiseShare(
            node,
            name,
            sigma(by_time, True),
            sigma(by_time, False),
            share(by_time, True),
            share(by_time, False),
        )
        for (node, name), by_time in variances.items()
        if any(temporal in by_time for temporal in counted)
    )
    return NoiseShares(tuple(shares), math.sqrt(whole[True]), math.sqrt(whole[False]), noise.mean)


def _kind(temporal: bool) -> Kind:
    return "temporal" if temporal else "fixed"


@ends_lineage
def blur_shares(
    work: Work, *, stages: tuple[Stage, ...], frequency: tuple[float, float], before: str | None
) -> BlurShares:
    """Shares of the stages at a frequency across and one along; those that do nothing left out."""
    moduli = []
    for line, cyc_per_mrad in zip(_LINES, frequency, strict=True):
        work.check()
        place = np.array([cyc_per_mrad])
        values = (float(stage_along(work, stage, "mtf", line, place)[0]) for stage in stages)
        moduli.append([_modulus(value) for value in values])
    shared = [shares_of_losses(losses=[loss(mtf=mtf) for mtf in along]) for along in moduli]
    shares = (
        BlurShare(_node_of(stage), stage.label, mtf, share)
        for stage, mtf, share in zip(
            stages, zip(*moduli, strict=True), zip(*shared, strict=True), strict=True
        )
        if mtf != (1.0, 1.0)
    )
    return BlurShares(frequency, tuple(shares), before)


def _modulus(value: float) -> float:
    """What is 1 but for rounding is 1."""
    return 1.0 if abs(abs(value) - 1.0) < _ROUNDING else abs(value)


def _node_of(stage: Stage) -> str:
    return next((factor.node for factor in stage.factors if factor.node), stage.label)


def unknown_before(transfer: ImageTransfer) -> str | None:
    """The node whose transfer function is not known, so that nothing before it counts."""
    source = transfer.source
    if transfer.area_means or not source.inputs:
        return None
    return source.node or "a node"
