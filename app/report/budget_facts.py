"""The budget of noise and blur as plain data."""

from __future__ import annotations

from typing import Any

from app.budget import blur_budget, noise_budget
from app.evaluation import Evaluation


def budget_facts(found: Evaluation) -> dict[str, Any]:
    """Noise and blur by stage; None for what there is none of."""
    noise, blur = noise_budget(found), blur_budget(found)
    return {
        "noise": noise
        and {
            "port": noise.port,
            "unit": noise.unit,
            "together": noise.together,
            "summed": noise.summed,
            "sources": [
                {
                    "node": each.source.node,
                    "title": each.source.title,
                    "name": each.source.name,
                    "mean": each.mean,
                    "sigma": each.sigma,
                    "share": each.share,
                }
                for each in noise.shares
            ],
        },
        "blur": blur
        and {
            "xi_cyc_per_mrad": blur.frequency[0],
            "eta_cyc_per_mrad": blur.frequency[1],
            "stages": [
                {
                    "node": each.node,
                    "title": each.title,
                    "mtf_x": each.mtf[0],
                    "share_x": each.share[0],
                    "mtf_y": each.mtf[1],
                    "share_y": each.share[1],
                }
                for each in blur.shares
            ],
        },
    }
