"""Every read-out of the modules of input, output and transform, with unlike axes."""

from __future__ import annotations

import math

import pytest

from node_bench import NodeBench
from nodes.library import standard_library
from readout_bench import (
    COLUMNS,
    DX,
    DY,
    FILL_X,
    FILL_Y,
    FOCAL_LENGTH_MM,
    NYQUIST_X,
    NYQUIST_Y,
    PITCH_X_UM,
    PITCH_Y_UM,
    ROWS,
    bench_of,
)

IFOV_X, IFOV_Y = PITCH_X_UM / FOCAL_LENGTH_MM, PITCH_Y_UM / FOCAL_LENGTH_MM


def test_readouts_of_the_transform(tmp_path):
    found = bench_of(tmp_path, "jitter_mtf", {}).readouts("init")
    assert found == pytest.approx(
        {
            "interval_x_mrad": DX,
            "interval_y_mrad": DY,
            "ifov_x_mrad": IFOV_X * FILL_X,
            "ifov_y_mrad": IFOV_Y * FILL_Y,
            "frequency_interval_x": 1 / (COLUMNS * DX),
            "frequency_interval_y": 1 / (ROWS * DY),
            "nyquist_x": NYQUIST_X,
            "nyquist_y": NYQUIST_Y,
            "pixel_nyquist_x": 0.5 / IFOV_X,
            "pixel_nyquist_y": 0.5 / IFOV_Y,
            "oversampling_x": IFOV_X / DX,
            "oversampling_y": IFOV_Y / DY,
        },
        rel=1e-12,
    )


NEED_X = {"ifov_x_mrad", "oversampling_x", "pixel_nyquist_x"}
NEED_Y = {"ifov_y_mrad", "oversampling_y", "pixel_nyquist_y"}


@pytest.mark.parametrize(
    ("missing", "empty"),
    [("detector_x_um", NEED_X), ("detector_y_um", NEED_Y), ("focal_length_mm", NEED_X | NEED_Y)],
)
def test_readouts_of_the_transform_without_a_detector(tmp_path, missing, empty):
    """What needs a length that is not given is empty, and nothing else."""
    found = bench_of(tmp_path, "jitter_mtf", {}, init={missing: None}).readouts("init")
    assert {name for name, value in found.items() if value is None} == empty


@pytest.mark.parametrize("factor", [1, 3])
def test_readouts_of_the_anti_aliaser(tmp_path, factor):
    found = bench_of(tmp_path, "anti_alias", {"factor": factor}).readouts("it")
    expected = {"new_nyquist_x": NYQUIST_X / factor, "new_nyquist_y": NYQUIST_Y / factor}
    assert found == pytest.approx(expected, rel=1e-12)


def test_nyquist_of_sampled_pixels(tmp_path):
    """Half a cycle in a pixel of three by two samples of 0.5 and 0.25 mrad."""
    seen = {"width": 12, "height": 8, "fov_x_deg": math.degrees(6e-3),
            "fov_y_deg": math.degrees(2e-3)}  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "pixels": ("sample_pixels", {"factor_x": 3, "factor_y": 2}),
    }
    bench = NodeBench(standard_library(), tmp_path, nodes, [("scene.image", "pixels.image")])
    assert bench.readouts("pixels") == pytest.approx({"nyquist_x": 1 / 3, "nyquist_y": 1.0})
