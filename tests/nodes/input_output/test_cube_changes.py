"""A cube that another program writes to while its bands are read."""

from __future__ import annotations

import os

import numpy as np
import pytest

from core.errors import FileError
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from cube_files import write_cube
from node_bench import NodeBench
from nodes.library import standard_library


class WrittenMeanwhile(Work):
    """An evaluation during whose first pass over a file another program writes to it."""

    def __init__(self, file):
        super().__init__(Policy(), Store(1 << 20))
        self._file = file

    def for_each(self, function, items):
        super().for_each(function, items)
        with self._file.open("r+b") as file:
            file.write(np.full(1, 9.0, "<f8").tobytes())
        os.utime(self._file, ns=(0, 0))  # another time, however coarse the clock


@pytest.mark.parametrize("wanted", ["picture", "means"])
@pytest.mark.parametrize("missing", ["refuse", "zero", "mean"])
def test_what_is_read_of_a_cube_that_changes_meanwhile_is_refused(tmp_path, missing, wanted):
    path = write_cube(tmp_path, np.ones((3, 8, 9)), np.array([3.5, 4.0, 4.5]), 0.5)
    read = {"path": path.name, "bands": "all", "missing": missing}
    there = NodeBench(standard_library(), tmp_path, {"read": ("read_image", read)}, [])
    image = there.port("read.image")
    with pytest.raises(FileError, match="changed since the network was planned"):
        WrittenMeanwhile(path).value(image.recipe if wanted == "picture" else image.bands.means())
