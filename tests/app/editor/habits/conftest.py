"""The window with an empty network."""

import pytest

from window_hands import WindowHands


@pytest.fixture
def hand(window):
    """Hands on a window with an empty network."""
    made = WindowHands(window)
    made.begin()
    return made
