"""Which stage contributes how much of the final picture's noise and blur.

Noise: a source is silenced and the picture made again; all other noises are drawn as before, so
the difference is that source's own noise as it arrives in the final picture, filtered and combined
on the way. Noises of independent sources add in variance. Blur: the MTFs of stages multiply, so
−ln of their moduli adds; it is taken at half the Nyquist frequency of the picture's pixels, where
−ln of a Gaussian is its variance up to a constant.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.chain import ancestors
from app.evaluation import Evaluation
from app.responses import Axis, response
from core.engine import PlannedNode
from core.errors import Cancelled, ImagechainError
from core.network import Network
from core.skips import is_neutral
from core.values import Image
from core.work import Work
from nodes.input_output.sample_statistics import statistics

ADDED = ("poisson_noise", "periodic_noise", "noise_file")  # a switched-off node adds nothing
ELECTRONICS = "electronics_noise"
SILENT_D_STAR = 1e25  # cm √Hz/W: noise far below the rounding of any radiance


@dataclass(frozen=True)
class Source:
    """A noise, and how to be without it: parameters to set, or None to switch its node off."""

    node: str
    title: str
    name: str
    silent: Mapping[str, Any] | None

    def silenced(self, network: Network) -> Network:
        """The network without this noise."""
        if self.silent is None:
            return network.with_node(replace(network.node(self.node), disabled=True))
        for name, value in self.silent.items():
            network = network.with_parameter(self.node, name, value)
        return network


@dataclass(frozen=True)
class NoiseShare:
    """One source's noise in the final picture, in its unit, and its share of the variances' sum."""

    source: Source
    mean: float
    sigma: float
    share: float


@dataclass(frozen=True)
class NoiseBudget:
    """Every source; `together` is the rms of all noise at once, `summed` the root of the sum."""

    port: str
    unit: str
    shares: tuple[NoiseShare, ...]
    together: float
    summed: float


@dataclass(frozen=True)
class BlurShare:
    """One stage's |MTF| across and along, and its share of the total's −ln (negative: sharpens)."""

    node: str
    title: str
    mtf: tuple[float, float]
    share: tuple[float, float]


@dataclass(frozen=True)
class BlurBudget:
    """Every stage that blurs, at one frequency across and one along, cycles/mrad."""

    frequency: tuple[float, float]
    shares: tuple[BlurShare, ...]


def noise_sources(found: Evaluation) -> list[Source]:
    """The noises there are on the way to the final picture, quantization last of its node's."""
    final = found.chain.final
    if final is None:
        return []
    last = final.rpartition(".")[0]
    upstream = ancestors(found.network, last) | {last}
    sources: list[Source] = []
    for name, planned in found.plan.nodes.items():
        if name in upstream and planned.module is not None and not planned.node.disabled:
            sources += _sources(name, planned)
    return sources


def _sources(name: str, planned: PlannedNode) -> Iterator[Source]:
    declared, module = planned.declaration, planned.module
    if declared.key in ADDED and not is_neutral(planned):
        yield Source(name, declared.title, "", None)
    if declared.key != ELECTRONICS:
        return
    assert module is not None
    values = module.values()
    kinds: tuple[tuple[str, bool, dict[str, Any]], ...] = (
        # As eq. 4.59 is printed the gain error is the picture: without it nothing would be left.
        (
            "gain",
            values["gain_percent"] > 0 and values["gain_model"] != "literal",
            {"gain_percent": 0.0},
        ),
        ("bias", values["bias_percent"] > 0, {"bias_percent": 0.0}),
        ("detector", True, {"d_star": SILENT_D_STAR}),
        ("amplifier", values["amplifier_snr"] is not None, {"amplifier_snr": None}),
        ("quantization", values["bits"] > 0, {"bits": 0}),
    )
    for kind, there, silent in kinds:
        if there:
            yield Source(name, declared.title, kind, silent)


def noise_budget(found: Evaluation) -> NoiseBudget | None:
    """Every noise's share.

    All but quantization are compared before it, since it rounds them away or up together. None
    without a final picture or without noise, or where the picture cannot be made without one.
    """
    sources, port = noise_sources(found), found.chain.final
    if not sources or port is None:
        return None
    try:
        return _noise_budget(found, sources, port)
    except Cancelled:
        raise
    except ImagechainError:  # as of a radiance that is all noise: the run itself has not failed
        return None


def _noise_budget(found: Evaluation, sources: list[Source], port: str) -> NoiseBudget:
    work = found.engine.work(found.work.policy)
    quantizers = [source for source in sources if source.name == "quantization"]
    smooth = found.network
    for source in quantizers:
        smooth = source.silenced(smooth)
    spreads: list[tuple[Source, float, float]] = []
    for source in sources:
        whole = found.network if source in quantizers else smooth
        mean, sigma = _moments(found, work, port, whole, source.silenced(whole))
        spreads.append((source, mean, sigma))
    clean = found.network
    for source in sources:
        clean = source.silenced(clean)
    together = _moments(found, work, port, found.network, clean)[1]
    summed = math.hypot(*(sigma for _, _, sigma in spreads))
    shares = (
        NoiseShare(source, mean, sigma, (sigma / summed) ** 2 if summed else 0.0)
        for source, mean, sigma in spreads
    )
    image: Image = found.plan.output(port)
    return NoiseBudget(port, image.unit, tuple(shares), together, summed)


def _moments(
    found: Evaluation, work: Work, port: str, whole: Network, without: Network
) -> tuple[float, float]:
    """Mean and standard deviation of what a picture loses from one network to another.

    A deviation within the rounding of the samples is none.
    """
    a, b = (
        found.engine.value(found.engine.plan(each, folder=found.folder), port, work)
        for each in (whole, without)
    )
    seen = statistics(np.subtract(a, b), each=work.each)
    largest = max(abs(float(a.max())), abs(float(a.min())))
    rounding = float(np.finfo(a.dtype).eps) * largest
    return seen.mean, seen.sigma if seen.sigma > rounding else 0.0


def blur_budget(found: Evaluation) -> BlurBudget | None:
    """Every stage's share; None where stages do not follow one another or none blurs."""
    chain = found.chain
    grid = chain.combined or chain.grid
    if grid is None or not chain.cascade:
        return None
    frequency = 0.5 * grid.nyquist_x, 0.5 * grid.nyquist_y
    stages = [stage for stage in (*chain.stages, *chain.later) if stage.factors]
    axes: tuple[Axis, Axis] = ("x", "y")
    moduli = []
    for axis, each in zip(axes, frequency, strict=True):
        place = np.array([each])
        found_here = [response(found.work, s.factors, place, axis) for s in stages]
        moduli.append([abs(float(value.mtf[0])) for value in found_here])
    shares = [
        BlurShare(stage.node, stage.title, mtf, share)
        for stage, mtf, share in zip(
            stages, zip(*moduli, strict=True), zip(*map(_shares, moduli), strict=True), strict=True
        )
        if mtf != (1.0, 1.0)
    ]
    return BlurBudget(frequency, tuple(shares)) if shares else None


def _shares(moduli: list[float]) -> list[float]:
    """Shares of −ln; a stage that lets nothing through has all of it."""
    if any(each == 0.0 for each in moduli):
        opaque = moduli.count(0.0)
        return [1.0 / opaque if each == 0.0 else 0.0 for each in moduli]
    losses = [-math.log(each) for each in moduli]
    total = math.fsum(losses)
    return [loss / total if loss and total else 0.0 for loss in losses]
