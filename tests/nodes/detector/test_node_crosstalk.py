"""Crosstalk: a lit pixel's neighbours show the kernel, in a picture of one sample per pixel."""

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.detector.detector_mtf import crosstalk_kernel, crosstalk_otf
from linked_network import in_order
from node_bench import NodeBench

SIDES = "0.01 0.03 0.01; 0.02 0.85 0.03; 0.01 0.03 0.01"
WIDE = "0 0 .01 0 0; 0 .02 .03 .01 0; .01 .04 .75 .05 .01; 0 .01 .03 .01 0; 0 0 .02 0 0"


def bench_of(folder, params, *, with_phase=True, edges="periodic"):
    """One sample per pixel of 0.1 mrad."""
    scene = np.full((24, 32), 1.0)
    scene[10, 14] = 101.0
    np.save(folder / "scene.npy", scene)
    fov = {"fov_x_deg": np.degrees(0.1e-3 * 32), "fov_y_deg": np.degrees(0.1e-3 * 24)}
    nodes = {
        "scene": ("read_image", {"path": "scene.npy", **fov}),
        "init": ("init_trans", {"detector_x_um": 10, "detector_y_um": 10, "edges": edges,
                                "focal_length_mm": 100, "f_number": 2, "platform": "array"}),
        "it": ("crosstalk", params),
        "back": ("back_transform", {}),
    }  # fmt: skip
    links = in_order(nodes)
    if not with_phase:
        links = [link for link in links if "it.phase" not in link] + [("init.phase", "back.phase")]
    return NodeBench(folder, nodes, links)


@pytest.mark.parametrize("text", [SIDES, WIDE])
def test_a_lit_pixel_shows_the_kernel(tmp_path, text):
    """By direct sum: the picture is the scene's point, and the kernel times it around."""
    kernel = np.array(crosstalk_kernel(text))
    half = len(kernel) // 2
    expected = np.full((24, 32), 1.0)
    expected[10 - half : 11 + half, 14 - half : 15 + half] += 100 * kernel
    seen = bench_of(tmp_path, {"kernel": text}).value("back.image")
    np.testing.assert_allclose(seen, expected, rtol=0, atol=1e-10)


def test_an_asymmetric_kernel_needs_the_phase(tmp_path):
    even = "0 0.02 0; 0.03 0.9 0.03; 0 0.02 0"

    def warned(text, **how):
        bench = bench_of(tmp_path, {"kernel": text}, **how)
        return [one.check for one in bench.warnings() if one.node == "it"]

    assert warned(WIDE, with_phase=False) == ["no_phase"]
    assert warned(WIDE) == warned(even, with_phase=False) == []


def test_the_otf_of_a_symmetric_kernel_is_its_cosines():
    kernel = crosstalk_kernel("0 0.02 0; 0.03 0.9 0.03; 0 0.02 0")
    xi, eta = 2.3, 4.1
    found = crosstalk_otf(xi=xi, eta=eta, kernel=kernel, pitch_x_mrad=0.1, pitch_y_mrad=0.2)
    expected = 0.9 + 0.06 * np.cos(2 * np.pi * xi * 0.1) + 0.04 * np.cos(2 * np.pi * eta * 0.2)
    assert complex(found) == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0 0 0; 0 0.9 0; 0 0 0", "add up to 1, not 0.9"),
        ("1", "kernel = '1' is not allowed: .*not 1 row with 1 number$"),
        ("0 0; 0 1 0; 0 0 0", "not 3 rows with 2, 3, 3 numbers$"),
        ("0 0 0; 0 one 0; 0 0 0", "one"),
        ("0 -0.1 0; 0 1.1 0; 0 0 0", "0 or above"),
        ("", "kernel"),
    ],
)
def test_kernels_that_are_none(tmp_path, text, words):
    with pytest.raises(ParameterError, match=words):
        crosstalk_kernel(text)
    assert "kernel" in str(bench_of(tmp_path, {"kernel": text}).error("it"))
