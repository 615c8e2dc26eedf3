"""Deviates of the noise modules: white ones, 1/f noise, and their seeds."""

from typing import Any, Literal

import numpy as np

from core.arrays import Array
from core.chain.random_fields import (
    BLOCK,
    FrameNumber,
    Stream,
    normal_field,
    normal_part,
    uniform_field,
)
from core.evaluation.recipes import Region, Step, ends_lineage, in_parts
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, Section, param
from core.physics.noise import flicker_noise

HELD_BYTES = 1 << 28
"""Waves of larger frames are drawn anew for each frame, in place of being held for all."""
_AT_ONCE = 1 << 15  # samples, whose steps of a wave stay in the processor's cache


@ends_lineage
def flicker_waves(
    work: Work, *, stream: Stream, shape: tuple[int, int], band: flicker_noise.FlickerBand
) -> Array:
    """Frequency, amplitude and phase of the waves of every stratum, a sample after the other."""
    place = _uniform(work, stream, shape, "place")
    waves = np.empty((band.strata, 3, place.size))
    for stratum in range(band.strata):
        work.check()
        level, waves[stratum, 2] = _level_and_phase(work, stream, shape, stratum)

        def make(start: int, stratum: int = stratum, level: Array = level) -> None:
            part = slice(start, start + _AT_ONCE)
            waves[stratum, :2, part] = flicker_noise.flicker_waves(
                band=band, stratum=stratum, place=place[part], level=level[part]
            )

        work.for_each(make, range(0, place.size, _AT_ONCE))
    return waves


@ends_lineage
def flicker_deviates(
    work: Work,
    *held: Array,
    stream: Stream,
    number: FrameNumber,
    shape: tuple[int, int],
    band: flicker_noise.FlickerBand,
    frame_s: float,
) -> Array:
    """1/f noise of variance 1 in a frame, of held waves or of the same ones drawn anew."""
    time_s, total = number.frame * frame_s, np.zeros(shape[0] * shape[1])
    place = () if held else (_uniform(work, stream, shape, "place"),)
    for stratum in range(band.strata):
        work.check()
        drawn = () if held else (*place, *_level_and_phase(work, stream, shape, stratum))

        def add(start: int, stratum: int = stratum, drawn: tuple[Array, ...] = drawn) -> None:
            part = slice(start, start + _AT_ONCE)
            if held:
                frequency, amplitude, phase = held[0][stratum][:, part]
            else:
                own, level, phase = (field[part] for field in drawn)
                frequency, amplitude = flicker_noise.flicker_waves(
                    band=band, stratum=stratum, place=own, level=level
                )
            total[part] += flicker_noise.wave_at(
                time_s=time_s, frequency_hz=frequency, amplitude=amplitude, phase=phase
            )

        work.for_each(add, range(0, total.size, _AT_ONCE))
    total /= band.strata**0.5
    return total.reshape(shape).astype(work.policy.dtype)


def _uniform(work: Work, stream: Stream, shape: tuple[int, int], field: str) -> Array:
    named = Stream(stream.seed, stream.node, f"{stream.field} {field}", fixed=True)
    return uniform_field(named, shape, for_each=work.for_each).ravel()


def _level_and_phase(
    work: Work, stream: Stream, shape: tuple[int, int], stratum: int
) -> tuple[Array, Array]:
    level, phase = (
        _uniform(work, stream, shape, f"{stratum} {what}") for what in ("level", "phase")
    )
    return level, phase


# Standard normal deviates as values of their own: an edit of a noise's size draws none again.


def _deviates_part(work: Work, region: Region, *, stream: Stream, shape: tuple[int, int]) -> Array:
    wanted = region.broadcast(shape)
    return normal_part(stream, shape, wanted, dtype=work.policy.dtype, for_each=work.for_each)


@ends_lineage
@in_parts(
    _deviates_part,
    lambda region, shape: len(region.blocks(shape[1], BLOCK)) / -(-shape[0] * shape[1] // BLOCK),
)
def unit_deviates(work: Work, *, stream: Stream, shape: tuple[int, int]) -> Array:
    return normal_field(stream, shape, dtype=work.policy.dtype, for_each=work.for_each)


SEED_SECTIONS = (
    Section("Seed", "seed_mode"),
    Section("", "seed", shown_when=("seed_mode", ("typed",))),
)


class SeededModule(Module):
    """Base class of noise sources, whose seed is derived from network and node, or entered."""

    draws_noise = True

    seed_mode: Literal["automatic", "typed"] = param(
        "automatic",
        "derive the seed from the network's seed and this node's name, or enter it in seed",
    )
    seed: int = param(0, "seed, used when seed_mode is typed", (0, 2**63 - 1))

    def stream(self, here: NodeContext, field: str, *, fixed: bool = False) -> Stream:
        """The stream of a noise field, perhaps `fixed`; a typed seed holds under any name."""
        if self.seed_mode == "typed":
            return Stream(seed=self.seed, node="", field=field, fixed=fixed)
        return Stream(seed=here.seed, node=here.noise or here.node, field=field, fixed=fixed)

    def deviates(
        self, here: NodeContext, field: str, shape: tuple[int, int], *, fixed: bool = False
    ) -> Step:
        """Standard normal deviates of one noise field: an edit of its size draws none again."""
        stream = self.stream(here, field, fixed=fixed)
        return here.step(unit_deviates, stream=stream, shape=shape)

    def flicker_field(
        self,
        here: NodeContext,
        shape: tuple[int, int],
        band: flicker_noise.FlickerBand,
        frame_rate_Hz: float,
        *,
        held: bool = False,
    ) -> Step:
        """1/f noise of variance 1; its waves are `held` for all frames unless too large."""
        stream = self.stream(here, "1/f", fixed=True)
        how: Any = {"stream": stream, "shape": shape, "band": band}
        held = held and 3 * 8 * band.strata * shape[0] * shape[1] <= HELD_BYTES
        waves = (here.step(flicker_waves, **how),) if held else ()
        number, frame_s = FrameNumber(), 1.0 / frame_rate_Hz
        return here.step(flicker_deviates, *waves, number=number, frame_s=frame_s, **how)
