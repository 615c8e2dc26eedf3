"""Networks of all kinds through the real commands: valid ones, damaged files, edited ones.

    python tests/fuzz/networks.py --count 50000 --seed 1 --workers 2

A finding is printed with the words that repeat it; the figures come at the end.
"""

from __future__ import annotations

import sys
from pathlib import Path

# This file is named like the package of the shipped networks: the root comes before its folder.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from cases import Case, command
from damaged_files import try_damaged_file
from edit_sittings import try_sitting
from network_runs import try_network


def attempt(case: Case) -> None:
    """One case: of twenty, ten networks are run, seven files damaged, three networks edited."""
    kind = case.number % 20
    if kind < 10:
        try_network(case)
    elif kind < 17:
        try_damaged_file(case)
    else:
        try_sitting(case)


if __name__ == "__main__":
    sys.exit(command(__file__, __doc__.split("\n")[0], attempt, count=1000))
