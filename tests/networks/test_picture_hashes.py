"""Every network ever shipped delivers what it did: picture, MTF table and read-outs.

To the last bit where the table was made (same libraries, same processor), and within rounding
everywhere else. After a change that is meant to change results, make the table anew:

    python tests/networks/picture_hashes.py --write

The same command with ``--full`` compares all files of runs at full size, before and after.
"""

import pytest

from machine_tag import machine_tag
from network_outputs import PRECISIONS, network_files
from picture_table import disagreements, read_table, small_run

RUNS = [f"{name} {precision}" for name in network_files() for precision in PRECISIONS]


@pytest.fixture(scope="module")
def table():
    return read_table()


def test_the_table_has_every_network(table):
    assert list(table["runs"]) == RUNS


# Each network in one of the precisions, and one in both.
@pytest.mark.thorough(but=len(RUNS) // 2, always=("kodak_kir310 double",))
@pytest.mark.parametrize("run", RUNS)
def test_delivers_what_it_did(run, table, tmp_path):
    name, precision = run.split()
    folder = small_run(network_files()[name], tmp_path, precision)
    lines = disagreements(table, machine_tag(), name, precision, folder)
    assert lines == []
