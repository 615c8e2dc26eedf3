"""Arrays on disk: where they lie, how long, and what is left of them."""

import gc

import numpy as np
import pytest

from core.errors import FileError
from core.evaluation.store import Store, size_in_bytes
from core.scratch import ScratchDisk, is_on_disk
from core.transfer.mirrored import MeanFree


@pytest.fixture
def disk(tmp_path):
    with ScratchDisk(tmp_path, 1 << 20) as made:
        yield made


def test_what_lies_there(disk, tmp_path):
    assert disk.wants((129, 128), np.float32)  # of 1 MiB, more than a sixteenth
    assert not disk.wants((128, 128), np.float32)
    array = disk.empty((300, 200), np.float64)
    array[:] = np.arange(60000.0).reshape(300, 200)
    disk.trim()
    assert array.sum() == 59999 * 30000  # as it was written, though let go of
    assert is_on_disk(array[7:9])
    assert is_on_disk((1, array))
    assert is_on_disk(MeanFree(array, 0.0))
    assert not is_on_disk(array.copy())
    assert not list(tmp_path.iterdir())  # without a name, nothing can be left


def test_a_store_keeps_it_only_while_it_is_pinned(disk):
    store = Store(1 << 30)
    store.pin("a")
    for key in "ab":
        store.get(key, lambda: disk.empty((300, 200), np.float64))
    assert (store.holds("a"), store.holds("b")) == (True, False)
    assert store.used_bytes == size_in_bytes(disk.empty((2, 2), np.int8))  # of memory
    store.unpin("a")
    assert not store.holds("a")
    gc.collect()
    assert (disk.files, disk.most_bytes) == (3, 960_000)  # never three at a time


def test_no_folder_one_line(tmp_path):
    with pytest.raises(FileError, match=r"cannot write to the scratch folder .*away: No such file"):
        ScratchDisk(tmp_path / "away", 1000).empty((3,), np.float64)
