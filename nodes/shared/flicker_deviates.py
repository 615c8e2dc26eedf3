"""1/f noise of the samples of a frame, made of the frame's number alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.noise.frame_number import FrameNumber
from core.noise.random_fields import Stream, uniform_field
from core.physics.noise.flicker_noise import FlickerBand, flicker_wave

Array = NDArray[Any]

_AT_ONCE = 1 << 15  # samples, whose steps of a wave stay in the processor's cache


@ends_lineage
def flicker_deviates(
    work: Work,
    *,
    stream: Stream,
    number: FrameNumber,
    shape: tuple[int, int],
    band: FlickerBand,
    frame_s: float,
) -> Array:
    """1/f noise of variance 1 in a frame; waves are drawn anew, so that none has to be held."""

    def uniform(field: str) -> Array:
        named = Stream(stream.seed, stream.node, f"{stream.field} {field}", fixed=True)
        return uniform_field(named, shape, for_each=work.for_each)

    place, total = uniform("place").ravel(), np.zeros(shape[0] * shape[1])
    for stratum in range(band.strata):
        work.check()
        level, phase = (uniform(f"{stratum} {what}").ravel() for what in ("level", "phase"))

        def add(
            start: int, stratum: int = stratum, level: Array = level, phase: Array = phase
        ) -> None:
            part = slice(start, start + _AT_ONCE)
            total[part] += flicker_wave(
                band=band,
                stratum=stratum,
                time_s=number.frame * frame_s,
                place=place[part],
                level=level[part],
                phase=phase[part],
            )

        work.for_each(add, range(0, total.size, _AT_ONCE))
    total /= band.strata**0.5
    return total.reshape(shape).astype(work.policy.dtype)
