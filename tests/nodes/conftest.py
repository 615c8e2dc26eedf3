"""Folders with a picture in them."""

import numpy as np
import pytest

from lens_files import write_lens_files
from noise_bench import Bench


@pytest.fixture
def bench(tmp_path):
    return Bench(tmp_path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all tests of a file, with a frame of noise for the small scenes and a lens' MTF."""
    place = tmp_path_factory.mktemp("shared")
    np.save(place / "noise.npy", np.random.default_rng(1).normal(size=(11, 15)))
    write_lens_files(place)
    return place
