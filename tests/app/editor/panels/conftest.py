"""Previews with a worker behind them."""

import pytest

from preview_hands import PreviewBench


@pytest.fixture
def bench(qtbot, session, tmp_path):
    made = PreviewBench(qtbot, session, tmp_path)
    yield made
    made.close()
