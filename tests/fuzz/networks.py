"""Random networks through the real commands: checked, run, varied, run again.

    python tests/fuzz/networks.py --count 50000 --seed 1 --workers 2

A finding is printed with the words that repeat it; the figures come at the end. Of the networks
90 % are run and 10 % varied by `tradeoff`. Of the runs 15 % of those that succeed are repeated with
another number of threads, to the same bits; 25 % write a report as JSON, 0.6 % as HTML. Every file
a run writes is whole, and finite where it holds numbers. Pictures have sides of 1 to 64; of 100
networks 4 have pictures of a single line and 2 large ones of up to 509. The cases' folders lie in
memory where there is such a file system.
"""

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

from cases import command, memory_folder
from network_runs import try_network

if __name__ == "__main__":
    about = __doc__.split("\n")[0]
    sys.exit(command(about, try_network, count=1000, folder=memory_folder()))
