"""The network of the thesis' sensor."""

import pytest

from app.run.shipped import shipped_networks
from core.network.file import read_network


@pytest.fixture
def kodak(library):
    return read_network(shipped_networks()["kodak_kir310"], library=library)
