"""A program that calls the command keeps its own ways of collecting garbage."""

import gc

from app.command.cli import main


def test_a_call_with_words_leaves_pythons_thresholds(capsys):
    before = gc.get_threshold()
    assert main(["modules", "jitter_mtf"]) == 0
    assert gc.get_threshold() == before
    assert "Jitter MTF" in capsys.readouterr().out
