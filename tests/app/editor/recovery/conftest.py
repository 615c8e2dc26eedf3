"""The networks that are shipped."""

from __future__ import annotations

import pytest

from app.run.shipped import shipped_networks
from core.network.file import read_network


@pytest.fixture
def shipped(library):
    """Shipped networks by name."""
    return {name: read_network(path, library=library) for name, path in shipped_networks().items()}


@pytest.fixture
def kodak(shipped):
    return shipped["kodak_kir310"]
