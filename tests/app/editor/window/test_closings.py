"""Closing real windows by real keys, mouse and signals."""

import pytest

from closing_trials import Trial, close
from virtual_screen import virtual_screen

TRIALS = (
    Trial("menu", "modified", modified=True, answer="Save"),
    Trial("window manager", "computing", modified=True, answer="Discard"),
    Trial("window manager", "dialog", "save as", modified=True, answer="Cancel"),
    Trial("SIGTERM", "dialog", "replace", modified=True),
    Trial("SIGTERM twice", "computing", modified=True),
)


@pytest.fixture(scope="module")
def screen():
    with virtual_screen(1100, 800) as found:
        yield found


@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: f"{trial.way}, {trial.state}")
def test_it_ends_or_asks_and_nothing_is_lost(trial, tmp_path, screen):
    outcome = close(trial, tmp_path, screen)
    assert outcome == ("asked" if trial.modified and not trial.is_told else "ended")
