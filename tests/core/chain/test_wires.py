"""Chains of many stages on a wire: their keys, and how long they may be."""

import numpy as np
import pytest

from core.chain.wires import MOST_STAGES, Magnitude
from core.errors import NetworkError
from core.transfer.factors import Grid, Law, Separable

GRID = Grid(8, 8, 0.1, 0.1)


def blur(frequency, sigma_mrad):
    return np.exp(-2 * (np.pi * sigma_mrad * frequency) ** 2)


def stage(number):
    law = Law.of(blur, sigma_mrad=0.001 * number)
    return Separable(x=law, y=law, node=f"n{number}")


def test_a_key_tells_of_the_stages_and_not_of_how_they_came_together():
    stages = tuple(stage(number) for number in range(4))
    whole = Magnitude(None, GRID, factors=stages)
    bare = Magnitude(None, GRID)
    assert bare.times(*stages).key == whole.key
    assert bare.times(*stages[:1]).times(*stages[1:3]).times(stages[3]).key == whole.key
    assert Magnitude(None, GRID, factors=stages[:3]).times(stages[3]).key == whole.key
    others = (stages[:3], stages[1:], (*stages[:2], stages[3], stages[2]), (*stages, stages[3]))
    assert len({Magnitude(None, GRID, factors=other).key for other in others} | {whole.key}) == 5


def test_a_chain_beyond_the_budget_is_refused():
    longest = Magnitude(None, GRID, factors=(stage(1),) * MOST_STAGES)
    with pytest.raises(
        NetworkError, match=r"^5,001 stages in one chain; at most 5,000 are allowed$"
    ):
        longest.times(stage(2))
