"""Standard normal deviates as values of their own: an edit of a noise's size draws none again."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from core.evaluation.recipes import ends_lineage, in_parts
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.noise.random_fields import BLOCK, Stream, normal_field, normal_part

Array = NDArray[Any]


def _deviates_part(work: Work, region: Region, *, stream: Stream, shape: tuple[int, int]) -> Array:
    wanted = region.broadcast(shape)
    return normal_part(stream, shape, wanted, dtype=work.policy.dtype, for_each=work.for_each)


def _deviates_share(region: Region, shape: tuple[int, int]) -> float:
    return len(region.blocks(shape[1], BLOCK)) / -(-shape[0] * shape[1] // BLOCK)


@ends_lineage
@in_parts(_deviates_part, _deviates_share)
def unit_deviates(work: Work, *, stream: Stream, shape: tuple[int, int]) -> Array:
    """Standard normal deviates."""
    return normal_field(stream, shape, dtype=work.policy.dtype, for_each=work.for_each)
