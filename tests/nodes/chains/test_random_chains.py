"""Random chains of random modules, and pictures of every size of numbers."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from chain_runs import picture_of, run
from drawn_chains import chains, ordinary
from thorough import examples

KINDS = ("scene", "constant", "zero", "huge", "tiny", "wide", "negative", "below zero", "point",
         "edge of single", "edge of double", "least")  # fmt: skip

SETTINGS = settings(
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much,
                           HealthCheck.data_too_large],
)  # fmt: skip


@settings(SETTINGS, max_examples=examples(150))
@given(drawn=chains(ordinary), precision=st.sampled_from(["double", "single"]))
def test_ordinary_parameters(folder, drawn, precision):
    size, chain = drawn
    run(chain, picture_of("scene", size), folder, precision)


@pytest.mark.parametrize("kind", KINDS[1:])
@settings(SETTINGS, max_examples=examples(25))
@given(drawn=chains(ordinary), precision=st.sampled_from(["double", "single"]))
def test_extreme_pictures(folder, kind, drawn, precision):
    size, chain = drawn
    run(chain, picture_of(kind, size), folder, precision)
