"""The noises that single steps add: their power where they arise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft

from core.chain.back_transformed import block_combine
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.filtering.local_mean import local_mean
from core.noise.noise_power import NoisePower
from core.noise.random_fields import Stream
from core.physics.electronics.rounding_noise import rounding_variances
from nodes.electronics.noise_steps import (
    Array,
    quantized,
    read_out,
    with_amplifier_noise,
    with_detector_noise,
)
from nodes.electronics.periodic_noise import drawn, summed
from nodes.optics.poisson_noise import added, photon_counts, published_noise


@dataclass(frozen=True, slots=True)
class Pattern:
    """The step that adds a known pattern."""

    step: Step


@dataclass(frozen=True)
class Noise:
    """A noise on its way: who added it, whether it changes in time, and its power now.

    What becomes of a `pattern` that is known to the last sample is seen by making the picture with
    it alone.
    """

    node: str
    name: str
    temporal: bool
    power: NoisePower
    pattern: Pattern | None = None


STILL = 1e-4  # of a step; rounding errors of a picture with less noise stay what they are
Arising = Callable[..., list[Noise]]


def arising(
    work: Work, step: Step, rows: int, columns: int, before: list[Noise], uniform: bool = False
) -> list[Noise]:
    """What a step adds to a picture of this size; `before` is what its picture has already.

    `uniform`: gain errors as on a uniform field of the picture's mean.
    """
    if step.function is read_out:
        return _read_out(work, step, rows, columns, uniform)
    return _ARISING[step.function](work, step, rows, columns, before)


def is_noisy(recipe: Recipe) -> bool:
    """Whether anything a recipe is made of is drawn at random."""
    seen, waiting = {recipe.key}, [recipe]
    while waiting:
        each = waiting.pop()
        if isinstance(each, Step) and any(isinstance(v, Stream) for _, v in each.parameters):
            return True
        fresh = [one for one in each.inputs if one.key not in seen]
        seen.update(one.key for one in fresh)
        waiting += fresh
    return False


def asked_by(step: Step) -> list[Recipe]:
    """What `arising` and its callers look at to know the noise that a step adds."""
    return [
        step.inputs[place] for place in _ASKED.get(step.function, ()) if place < len(step.inputs)
    ]


def mean_of(work: Work, recipe: Recipe) -> float:
    """Mean of a picture."""
    return float(np.mean(work.value(recipe), dtype=np.float64))


def _photons_added(
    work: Work, step: Step, rows: int, columns: int, before: list[Noise]
) -> list[Noise]:
    """Poisson deviates of a share of the local mean: that is their variance too."""
    noise = step.inputs[1]
    if not isinstance(noise, Step) or noise.function is not published_noise:
        return []
    how = dict(noise.parameters)
    local = local_mean(work, work.value(step.inputs[0]), sigma_px=how["sigma_px"])
    return [_white(step, "photons", rows, columns, how["percent"] / 100.0 * local)]


def _photon_counts(
    work: Work, step: Step, rows: int, columns: int, before: list[Noise]
) -> list[Noise]:
    picture = work.value(step.inputs[0])
    return [
        _white(step, "photons", rows, columns, picture / dict(step.parameters)["photons_per_unit"])
    ]


def _pattern_added(
    work: Work, step: Step, rows: int, columns: int, before: list[Noise]
) -> list[Noise]:
    """A known pattern, the same in every frame."""
    pattern = step.inputs[1]
    name = "periodic" if isinstance(pattern, Step) and pattern.function is drawn else "file"
    return [_known(step, name, rows, columns)]


def _detector(work: Work, step: Step, rows: int, columns: int, before: list[Noise]) -> list[Noise]:
    figures = step.inputs[4 if step.function is read_out else 1]
    spread = dict(step.parameters)["variability_percent"] / 100.0
    variance = work.value(figures).ner ** 2 * (1.0 + spread**2)
    return [_white(step, "detector", rows, columns, variance)]


def _read_out(work: Work, step: Step, rows: int, columns: int, uniform: bool) -> list[Noise]:
    """Errors of gain and bias, constant along the direction of collection, and detector noise."""
    picture, seen, gain_pattern, bias_pattern = step.inputs[:4]
    values, node = dict(step.parameters), step.node or ""
    mean = work.value(seen).mean
    gain, bias = values["gain_percent"] / 100.0, values["bias_percent"] / 100.0
    found = []
    if gain and values["model"] != "literal":
        seen_by_each = values["model"] == "per_pixel" and not uniform
        weight = work.value(picture) if seen_by_each else None
        power = _pattern_power(gain_pattern, rows, columns, gain, mean, weight)
        found.append(Noise(node, "gain", False, power))
    if bias and values["model"] != "literal":
        power = _pattern_power(bias_pattern, rows, columns, bias, mean, None)
        found.append(Noise(node, "bias", False, power))
    return [*found, *_detector(work, step, rows, columns, [])]


def _pattern_power(
    pattern: Recipe, rows: int, columns: int, spread: float, mean: float, weight: Array | None
) -> NoisePower:
    """Power of unit deviates times the spread, times what each sample weighs or the mean."""
    shape = dict(_deviates(pattern).parameters)["shape"]
    seen = np.full((1, 1), mean) if weight is None else np.asarray(weight, np.float64)
    if shape == (rows, columns):
        variances = spread**2 * np.broadcast_to(seen**2, (rows, columns))
        return NoisePower.white(rows, columns, variances)
    whole = np.broadcast_to(seen, (rows, columns))
    if shape == (1, columns):
        # Each column is multiplied by a deviate of its own: along it stays what it has seen.
        waves = scipy.fft.dct(whole, type=2, axis=0, norm="ortho")
        return NoisePower(rows, columns, spread**2 * np.mean(waves**2, axis=1, keepdims=True))
    waves = scipy.fft.dctn(whole, type=2, norm="ortho")
    return NoisePower(rows, columns, spread**2 * waves**2)


def _deviates(pattern: Recipe) -> Step:
    assert isinstance(pattern, Step)
    return pattern if not pattern.inputs else _deviates(pattern.inputs[0])


def _amplifier(work: Work, step: Step, rows: int, columns: int, before: list[Noise]) -> list[Noise]:
    sigma = work.value(step.inputs[1]).as_dict()["amplifier_noise"]
    return [_white(step, "amplifier", rows, columns, sigma**2)]


def _quantization(
    work: Work, step: Step, rows: int, columns: int, before: list[Noise]
) -> list[Noise]:
    """Rounding errors: what temporal noise stirs changes with it, the rest stays."""
    values = dict(step.parameters)
    low, high = values["limits"] if "limits" in values else work.value(step.inputs[1])
    if not high > low:
        return []
    width = (high - low) / (2.0 ** values["bits"] - 1.0)
    stirring = sum(each.power.moments().sample for each in before if each.temporal)
    if stirring < (STILL * width) ** 2:
        return [_known(step, "quantization", rows, columns)]
    temporal, fixed = rounding_variances(step=width, noise_variance=stirring)
    node = step.node or ""
    return [
        Noise(node, "quantization", True, NoisePower.white(rows, columns, temporal)),
        Noise(node, "quantization", False, NoisePower.white(rows, columns, fixed)),
    ]


def _known(step: Step, name: str, rows: int, columns: int) -> Noise:
    return Noise(step.node or "", name, False, NoisePower.white(rows, columns, 0.0), Pattern(step))


def _white(step: Step, name: str, rows: int, columns: int, variance: float | Array) -> Noise:
    return Noise(step.node or "", name, True, NoisePower.white(rows, columns, variance))


# Places of the inputs that are looked at: the picture where noise depends on it, and figures.
_ASKED: dict[Any, tuple[int, ...]] = {
    added: (0,),
    photon_counts: (0,),
    with_detector_noise: (1,),
    read_out: (0, 1, 4),
    with_amplifier_noise: (1,),
    quantized: (1,),
    block_combine: (0,),
}

_ARISING: dict[Any, Arising] = {
    added: _photons_added,
    photon_counts: _photon_counts,
    summed: _pattern_added,
    with_detector_noise: _detector,
    with_amplifier_noise: _amplifier,
    quantized: _quantization,
}
