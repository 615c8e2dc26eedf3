"""Random networks on small frames, in both precisions, against direct sums of another hand.

    python tests/fuzz/direct_sums.py --count 10000 --seed 1 --workers 2

A finding is printed as the least network that still shows it; the figures come at the end.
"""

from __future__ import annotations

import sys
import tempfile
from functools import cache
from pathlib import Path

# This folder has a file named like the package of the shipped networks: the root comes before it.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from cases import Case, command

from drawn_networks import SMALL, drawn
from slow_comparison import Comparison, fault, reduced


@cache
def _comparison() -> tuple[Comparison, tempfile.TemporaryDirectory[str]]:
    """One for all cases of a process, with the folder of its frames."""
    folder = tempfile.TemporaryDirectory(prefix="fuzz-", ignore_cleanup_errors=True)
    return Comparison(Path(folder.name), SMALL, threads=1), folder


def attempt(case: Case) -> None:
    """One network."""
    comparison, _ = _comparison()
    network = drawn(case.random, comparison.names)
    case.counts["modules"] += len(network.items)
    wrong = fault(comparison, network)
    case.expect(wrong is None, "" if wrong is None else reduced(comparison, network))


if __name__ == "__main__":
    sys.exit(command(__file__, __doc__.split("\n")[0], attempt, count=1000))
