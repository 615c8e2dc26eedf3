"""A window with a small sensor whose blur is varied."""

import json

import pytest

from core.editing.document import Document
from core.network.file import parse_network
from tradeoff_network import DOCUMENT


@pytest.fixture
def opened_window(window, library, idle):
    """A window with the sensor of the tests."""
    network = parse_network(json.dumps(DOCUMENT), library=library)
    window.session.open(Document(network, library=library))
    window.show_canvas()
    idle(window)
    return window


@pytest.fixture
def dock(opened_window, idle):
    """The dock, with the blur of the sensor varied."""
    opened_window.viewers.trade_off("blur", "sigma_x_mrad")
    idle(opened_window)
    return opened_window.viewers.tradeoff


@pytest.fixture
def graph(dock):
    """What is drawn of a figure."""

    def find(name):
        return next(line for _, line in dock.plots.graphs if line.name == name)

    return find
