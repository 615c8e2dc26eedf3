"""What shows that results have not moved must see the least change, and no more than there is."""

import json
import shutil

import numpy as np
import pytest

from machine_tag import machine_tag
from network_outputs import MTF, PICTURE, READOUTS, network_files
from output_folders import first_difference
from output_statistics import TOLERANCE, differences, hashes_of, picture_statistics, statistics_of
from picture_table import disagreements, read_table, small_run

NAME = "first_steps"
ANOTHER_MACHINE = {"processor": "another"}


@pytest.fixture(scope="module")
def delivered(tmp_path_factory):
    return small_run(network_files()[NAME], tmp_path_factory.mktemp("small"), "double")


@pytest.fixture
def folder(delivered, tmp_path):
    return shutil.copytree(delivered, tmp_path / "copy")


@pytest.fixture
def table(delivered):
    """The stored one, with what this machine delivers."""
    table, hashes = read_table(), hashes_of(delivered)
    for part, figures in statistics_of(delivered).items():
        table["runs"][f"{NAME} double"][part] = hashes[part]
        table["statistics"][f"{part} {hashes[part][:16]}"] = figures
    return {**table, "machine": machine_tag()}


def change_sample(folder, change):
    picture = np.load(folder / PICTURE)
    picture[3, 5] = change(picture[3, 5])
    np.save(folder / PICTURE, picture)


def change_readout(folder, factor):
    nodes = json.loads((folder / READOUTS).read_text())
    nodes["init"]["nyquist_x"] *= factor
    (folder / READOUTS).write_text(json.dumps(nodes))


def change_cell(folder, factor):
    """The MTF at the lowest frequency but 0, in the last column that is no phase."""
    head, *lines = (folder / MTF).read_text().splitlines()
    column = max(i for i, name in enumerate(head.split(",")) if name.endswith("mtf_y"))
    cells = lines[1].split(",")
    cells[column] = repr(float(cells[column]) * factor)
    lines[1] = ",".join(cells)
    (folder / MTF).write_text("\n".join([head, *lines]) + "\n")


def one_more(value):
    return np.nextafter(value, np.inf)


class TestTable:
    def test_the_last_bit_counts_on_one_machine_only(self, table, folder):
        change_sample(folder, one_more)
        (line,) = disagreements(table, machine_tag(), NAME, "double", folder)
        assert line == "picture: other bits on the same machine, alike within double"
        assert disagreements(table, ANOTHER_MACHINE, NAME, "double", folder) == []

    @pytest.mark.parametrize(
        ("change", "part"), [(change_readout, "readouts init.nyquist_x"), (change_cell, "mtf ")]
    )
    def test_a_figure_that_moves_is_named_on_any_machine(self, table, folder, change, part):
        change(folder, 1 + 1e-6)
        for machine in (machine_tag(), ANOTHER_MACHINE):
            (line, *_) = disagreements(table, machine, NAME, "double", folder)
            assert line.startswith(part)
            assert "before" in line

    def test_a_picture_turned_round_is_seen_on_any_machine(self, table, folder):
        np.save(folder / PICTURE, np.load(folder / PICTURE)[:, ::-1])
        lines = disagreements(table, ANOTHER_MACHINE, NAME, "double", folder)
        assert lines[0].startswith("picture blocks[0]")


@pytest.mark.parametrize("precision", TOLERANCE)
def test_rounding_in_another_order_is_within_the_tolerance(precision):
    """Of samples that each move by up to four units in the last place."""
    random = np.random.default_rng(5)
    kind = np.float32 if precision == "single" else np.float64
    before = random.normal(0, 1, (97, 64)).astype(kind)
    after = before + random.integers(-4, 5, before.shape).astype(kind) * np.spacing(before)
    assert (before != after).mean() > 0.8
    figures = [picture_statistics(samples) for samples in (before, after)]
    assert differences("picture", *figures, TOLERANCE[precision]) == []


class TestFolders:
    @pytest.mark.parametrize(
        ("change", "said"),
        [
            (lambda folder: change_sample(folder, one_more), "1 of 65536 samples, first at (3, 5)"),
            (lambda folder: change_readout(folder, 1 + 1e-15), "readouts.json: byte "),
            (lambda folder: change_cell(folder, 1 + 1e-15), "mtf.csv: byte "),
            (lambda folder: (folder / MTF).unlink(), "only in one of both: mtf.csv"),
        ],
    )
    def test_the_first_difference_is_named(self, delivered, folder, change, said):
        assert first_difference(delivered, folder) is None
        change(folder)
        assert said in first_difference(delivered, folder)
