"""Illustrations with a worker behind them."""

import pytest

from illustration_hands import IllustrationBench


@pytest.fixture
def bench(qtbot, session, tmp_path):
    made = IllustrationBench(qtbot, session, tmp_path)
    yield made
    made.close()
