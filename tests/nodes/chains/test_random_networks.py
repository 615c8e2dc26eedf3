"""Networks of random modules in random order against direct sums that share no code with them.

Left out by rule, not by a wider tolerance: pictures that hang on rounding, made with the phase of
(nearly) nothing or with a pattern of too many turns, and those on whose way a quantizer stood
within the tolerance of the turn between two levels. Where a quantizer comes last, either level
beside such a turn is right.
"""

from __future__ import annotations

from collections import Counter
from random import Random

import numpy as np
import pytest

from drawn_networks import LARGE, ON_PICTURE, ON_SPECTRUM, SMALL, Drawn, drawn
from slow_comparison import TOLERANCE, Comparison, UndecidedError, error, reduced
from slow_reference.network import IllConditionedError

NETWORKS, CHUNKS = 2000, 8
LARGEST_SHARE = 0.05  # of networks left out


def check(comparison: Comparison, networks: list[Drawn]) -> None:
    """Every network in both precisions; the first one at fault is reduced."""
    left_out: Counter[str] = Counter()
    for number, network in enumerate(networks):
        document = network.document()
        try:
            expected = comparison.expected(document)
        except IllConditionedError:
            left_out.update(TOLERANCE)
            continue
        try:
            found = comparison.found(document, *TOLERANCE)
        except Exception:
            pytest.fail(f"network {number}: {reduced(comparison, network)}")
        for precision, one in zip(TOLERANCE, found, strict=True):
            try:
                right = error(one, expected, precision) <= 1
            except UndecidedError:
                left_out[precision] += 1
                continue
            assert right, f"network {number}: {reduced(comparison, network)}"
    assert max(left_out.values(), default=0) <= LARGEST_SHARE * len(networks) + 5, left_out


@pytest.mark.thorough(but=2)
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_small_frames_are_as_the_direct_sums_say(tmp_path, chunk):
    comparison = Comparison(tmp_path, SMALL, threads=1)
    random = Random(f"small frames {chunk}")
    networks = [drawn(random, comparison.names) for _ in range(NETWORKS // CHUNKS)]
    keys = {item.key for network in networks for item in network.items}
    assert keys == {*ON_SPECTRUM, *ON_PICTURE}
    check(comparison, networks)


@pytest.mark.parametrize("size", LARGE, ids=str)
def test_frames_of_several_blocks_are_as_the_direct_sums_say(tmp_path, size, request):
    """The sums in double precision; their own rounding is a hundredth of the tolerance."""
    comparison = Comparison(tmp_path, [size], kind=np.float64, threads=2)
    random = Random(f"large frames {size}")
    count = 10 if request.config.option.thorough else 4
    check(comparison, [drawn(random, comparison.names, most=5) for _ in range(count)])
