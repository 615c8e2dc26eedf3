"""The budget of noise and blur as plain data."""

from __future__ import annotations

from typing import Any

from app.assessment.noise_and_blur_budget import NoiseBudget, blur_budget, noise_budget
from app.run.evaluation import Evaluation
from nodes.analysis.noise.budget_shares import BlurShares, NoiseShare

Fact = dict[str, Any]


def budget_facts(evaluation: Evaluation) -> Fact:
    """Noise and blur by stage; of what there is none, the reason."""
    noise, blur = noise_budget(evaluation), blur_budget(evaluation)
    return {
        "noise_reason": noise if isinstance(noise, str) else None,
        "noise": None if isinstance(noise, str) else _noise(evaluation, noise),
        "blur_reason": blur if isinstance(blur, str) else None,
        "blur": None if isinstance(blur, str) else _blur(blur),
    }


def _noise(evaluation: Evaluation, noise: NoiseBudget) -> Fact:
    predicted, measured = noise.predicted, noise.measured
    return {
        "port": noise.port,
        "unit": noise.unit,
        "summed": predicted.sigma,
        "temporal": predicted.temporal,
        "fixed": predicted.fixed,
        "together": None if isinstance(measured, str) else measured.sigma,
        "together_mean": None if isinstance(measured, str) else measured.mean,
        "together_reason": measured if isinstance(measured, str) else None,
        "sources": [_source(evaluation, share) for share in predicted.shares],
    }


def _source(evaluation: Evaluation, share: NoiseShare) -> Fact:
    planned = evaluation.plan.nodes.get(share.node)
    return {
        "node": share.node,
        "title": planned.declaration.title if planned else share.node,
        "name": share.name,
        "temporal": share.temporal,
        "fixed": share.fixed,
        "sigma": share.sigma,
        "share_temporal": share.share_temporal,
        "share_fixed": share.share_fixed,
        "share": share.share_temporal + share.share_fixed,
    }


def _blur(blur: BlurShares) -> Fact:
    return {
        "xi_cyc_per_mrad": blur.frequency[0],
        "eta_cyc_per_mrad": blur.frequency[1],
        "behind": blur.before,
        "mtf_x": blur.mtf[0],
        "mtf_y": blur.mtf[1],
        "stages": [
            {
                "node": share.node,
                "title": share.label,
                "mtf_x": share.mtf[0],
                "share_x": share.share[0],
                "mtf_y": share.mtf[1],
                "share_y": share.share[1],
            }
            for share in blur.shares
        ],
    }
