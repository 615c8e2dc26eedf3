"""Random chains and networks."""

from collections import Counter
from random import Random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from chain_runs import picture_of, run
from drawn_chains import chains, ordinary
from drawn_networks import LARGE, ON_PICTURE, ON_SPECTRUM, SMALL, Drawn, drawn
from slow_comparison import TOLERANCE, Comparison, UndecidedError, error, reduced
from slow_reference.network import IllConditionedError
from thorough import examples

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


KINDS = ("scene", "constant", "zero", "huge", "tiny", "wide", "negative", "below zero", "point",
         "edge of single", "edge of double", "least")  # fmt: skip

SETTINGS = settings(
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much,
                           HealthCheck.data_too_large],
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
@settings(SETTINGS, max_examples=examples(25))
@given(drawn=chains(ordinary), precision=st.sampled_from(["double", "single"]))
def test_extreme_pictures(folder, kind, drawn, precision):
    size, chain = drawn
    run(chain, picture_of(kind, size), folder, precision)
