"""A person who keeps snapshots of the first network."""

import pytest

from snapshot_hands import PORT, Person


@pytest.fixture
def person(window, idle):
    window.files.open_now("first_steps")
    idle(window)
    window.activateWindow()
    made = Person(window, idle)
    assert made.viewer.choices.port == PORT
    return made
