"""The window with an empty network, and with one of the thesis' sensors."""

import pytest

from window_hands import WindowHands, show_small


@pytest.fixture
def hand(window):
    """Hands on a window with an empty network."""
    made = WindowHands(window)
    made.begin()
    return made


@pytest.fixture
def kodak(window, idle):
    """The window with the Kodak KIR-310, its canvas with the focus."""
    show_small(window, "kodak_kir310")
    idle(window)
    window.activateWindow()
    window.canvas.setFocus()
    return window
