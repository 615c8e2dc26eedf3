"""The modules there are, and the networks that are shipped."""

from __future__ import annotations

import pytest

from app.shipped import shipped_networks
from core.network_file import read_network
from nodes.library import standard_library


@pytest.fixture(scope="session")
def library():
    return standard_library()


@pytest.fixture(scope="session")
def shipped(library):
    """Shipped networks by name."""
    return {name: read_network(path, library=library) for name, path in shipped_networks().items()}


@pytest.fixture(scope="session")
def kodak(shipped):
    return shipped["kodak_kir310"]


@pytest.fixture(scope="session")
def inframetrics(shipped):
    return shipped["inframetrics"]
