"""A short seed of the kills."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path


def test_runs_that_are_ended_leave_whole_files_and_say_what_is_true():
    spec = spec_from_file_location("fuzz_kills", Path(__file__).with_name("kills.py"))
    kills = sys.modules.setdefault(spec.name, module_from_spec(spec))  # its classes look for it
    spec.loader.exec_module(kills)
    assert kills.kills(4, 7) == []
