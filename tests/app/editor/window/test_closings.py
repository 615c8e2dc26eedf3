"""Closing real windows by real keys, mouse and signals."""

import pytest

from closing_trials import Trial, close
from virtual_screen import virtual_screen

TRIALS = (
    Trial("window manager", "save as", answer="Cancel"),
    Trial("SIGTERM", "replace"),
    Trial("SIGTERM twice", "computing"),
)


@pytest.fixture(scope="module")
def screen():
    with virtual_screen(1100, 800) as found:
        yield found


@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: f"{trial.way}, {trial.state}")
def test_it_ends_or_asks_and_nothing_is_lost(trial, tmp_path, screen):
    outcome = close(trial, tmp_path, screen)
    assert outcome == ("ended" if trial.is_told else "asked")
