"""Networks of all kinds through the real commands: valid ones, damaged files, edited ones.

    python tests/fuzz/networks.py --count 50000 --seed 1 --workers 2

A finding is printed with the words that repeat it; the figures come at the end. Of all cases

* 50 % are drawn networks, each checked; of these 90 % are run and 10 % varied by `tradeoff`;
* 35 % are damaged files, half of them shipped networks and half drawn ones, checked, read, opened
  by the editor, saved and read again; drawn ones that are still valid and small are run too;
* 15 % are sittings of 5 to 60 steps at a document: edits, undo, redo, save, autosave, reload.

Of the runs 15 % of those that succeed are repeated with another number of threads, to the same
bits; 25 % write a report as JSON, 0.6 % as HTML (2 % of the trade-offs), whose figures take some
twenty times as long as the rest of a case. Every file a run writes is whole, and finite where it
holds numbers. Pictures have sides of 1 to 64; of 100 networks 4 have pictures of a single line and
2 large ones of up to 509. The cases' folders lie in memory where there is such a file system; the
product flushes its files there as anywhere.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

# As the command itself has it; numpy, which reads it, is imported here before the command runs.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Else argparse looks for translations of its words on the disk, two dozen times a command.
os.environ.setdefault("LANGUAGE", "C")

# This file is named like the package of the shipped networks: the root comes before its folder.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from cases import Case, command, memory_folder
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
    about = __doc__.split("\n")[0]
    sys.exit(command(__file__, about, attempt, count=1000, folder=memory_folder()))
