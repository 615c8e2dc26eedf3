"""The modules there are, and the networks that are shipped."""

from pathlib import Path

import pytest

from app.run.shipped import shipped_networks
from core.network.file import read_network
from nodes.library import standard_library

EVER_SHIPPED = Path(__file__).parents[2] / "networks" / "ever_shipped"


@pytest.fixture(scope="session")
def library():
    return standard_library()


@pytest.fixture(scope="session")
def shipped(library):
    """Shipped networks by name."""
    return {name: read_network(path, library=library) for name, path in shipped_networks().items()}


@pytest.fixture(scope="session")
def kodak(library):
    """As it was once shipped, so that its places on the canvas stay as the tests have them."""
    return read_network(EVER_SHIPPED / "kodak_kir310_2.json", library=library)


@pytest.fixture(scope="session")
def inframetrics(shipped):
    return shipped["inframetrics"]
