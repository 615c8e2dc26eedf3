"""Read-out artefacts in a network: a moving scene, regions of pictures, and what is predicted."""

import numpy as np
import pytest

from core.errors import ParameterError
from linked_network import linked_network
from nodes.library import standard_library
from region_checks import assert_parts
from short_chain import short_chain

SIZE, INTERVAL = 160, 0.1
ONE_SAMPLE = {"detector_x_um": 10, "detector_y_um": 10, "focal_length_mm": 100}


def made(folder, picture, module, params, **init):
    """The picture behind a module, one sample per pixel if not said otherwise."""
    bench, last = short_chain(
        folder, picture, [(module, params)], interval_mrad=INTERVAL, init={**ONE_SAMPLE, **init}
    )
    return bench, bench.port(last), bench.value(last)


def scene(x, y):
    """A sinusoid and a soft bar."""
    return 3 + np.sin(2 * np.pi * (0.11 * x + 0.06 * y)) + np.exp(-(((x - 70) / 3) ** 2))


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize(("right", "down"), [(9000, -3000), (-700, 0), (0, 4000)])
def test_each_line_shows_the_scene_where_it_was_when_exposed(tmp_path, samples, right, down):
    """Ray by ray, within 1e-3 of a sample; all samples of a line of pixels are exposed at once."""
    rows, columns = np.mgrid[:SIZE, :SIZE].astype(float)
    params = {"image_velocity_x": right, "image_velocity_y": down}
    focal = {"focal_length_mm": 100 / samples}
    bench, _, found = made(tmp_path, scene(columns, rows), "rolling_shutter", params, **focal)
    moved = 2e-5 * samples * (rows // samples)
    x, y = columns - right * moved, rows - down * moved
    inside = (x > 8) & (x < SIZE - 9) & (y > 8) & (y < SIZE - 9)
    assert inside.mean() > 0.6
    slope = 2 * np.pi * 0.11  # of the sinusoid, per sample
    assert np.abs(found - scene(x, y))[inside].max() < 1e-3 * slope
    skew = right * 2e-5 * ((SIZE - 1) // samples)
    assert bench.readouts("rolling_shutter")["skew_px"] == pytest.approx(skew)


def test_regions_are_those_of_the_whole(tmp_path):
    nodes = {
        "scene": ("test_scene", {"width": 90, "height": 131}),
        "it": ("rolling_shutter", {"image_velocity_x": 9000, "image_velocity_y": -4000}),
    }
    network = linked_network(nodes, [("scene.image", "it.image")])
    assert_parts(network, ["it.image"], tmp_path)


def test_what_no_detector_has_is_refused():
    with pytest.raises(ParameterError, match="line_time_s"):
        standard_library()["rolling_shutter"].build({"line_time_s": -1})
