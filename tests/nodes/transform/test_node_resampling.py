"""Interpolate and Anti-alias Filter; their pictures are compared in `test_random_networks`."""

import numpy as np
import pytest

from core.physics.sampling.detector_sampling import block_mean_mtf
from node_bench import NodeBench
from nodes.transform.resampling import lanczos_mtf
from slow_reference.resampling import interpolated


def picture(rows, columns, seed=1):
    return np.random.default_rng(seed).uniform(20, 60, (rows, columns))


def through(folder, array, key, params, precision="double", threads=1):
    np.save(folder / "in.npy", array)
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": 2.0, "fov_y_deg": 1.5}),
        "out": (key, params),
    }
    bench = NodeBench(folder, nodes, precision=precision, threads=threads)
    source, image = bench.port("in.image"), bench.port("out.image")
    return source, image, bench.value("out.image"), bench.readouts("out")


PADS = {"periodic": "wrap", "reflect": "symmetric"}


@pytest.mark.parametrize("edges", PADS)
@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize(
    ("size", "new"), [((7, 10), (13, 24)), ((12, 9), (5, 4)), ((1, 6), (3, 11)), ((5, 1), (2, 1))]
)
def test_a_transformed_frame_goes_on_as_its_edges_say(tmp_path, size, new, order, edges):
    """As the middle of nine frames, which are laid side by side before they are interpolated."""
    array = picture(*size)
    params = {"width": new[1], "height": new[0], "order": order}
    value, cropped = transformed(tmp_path, array, params, edges)
    frames = np.pad(array, [(size[0],) * 2, (size[1],) * 2], mode=PADS[edges])
    expected = interpolated(frames, 3 * new[1], 3 * new[0], order)
    middle = expected[new[0] : 2 * new[0], new[1] : 2 * new[1]]
    np.testing.assert_allclose(value, middle, rtol=0, atol=1e-12)
    if size == (12, 9):  # of a frame with its last column cut off nothing is known beyond it
        pairs = array[:, :8].reshape(12, 4, 2).mean(axis=2)
        clamped = interpolated(pairs, new[1], new[0], order)
        np.testing.assert_allclose(cropped, clamped, rtol=0, atol=1e-12)


def transformed(folder, array, params, edges):
    """Interpolated straight from Back Transform, and after pairs of its pixels are combined."""
    np.save(folder / "in.npy", array)
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": 2.0, "fov_y_deg": 1.5}),
        "init": ("init_trans", {"edges": edges}),
        "back": ("back_transform", {}),
        "out": ("interpolate", params),
        "pairs": ("combine_pixels", {"factor_x": min(2, array.shape[1]), "factor_y": 1}),
        "cropped": ("interpolate", params),
    }
    links = [
        ("in.image", "init.image"), ("init.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"), ("back.image", "out.image"), ("back.image", "pairs.image"),
        ("pairs.image", "cropped.image"),
    ]  # fmt: skip
    bench = NodeBench(folder, nodes, links)
    return [bench.value(f"{name}.image") for name in ("out", "cropped")]


def test_bilinear_by_hand(tmp_path):
    params = {"width": 4, "height": 1}
    source, image, value, _ = through(tmp_path, np.array([[0.0, 8.0]]), "interpolate", params)
    assert value.tolist() == [[0.0, 2.0, 6.0, 8.0]]
    assert image.interval_x_mrad == pytest.approx(source.interval_x_mrad / 2)
    assert image.interval_y_mrad == source.interval_y_mrad


def test_frame_grabber_keeps_planes_and_constants(tmp_path):
    rows, columns = np.mgrid[:128, :170]
    params = {"width": 512, "height": 480}
    value = through(tmp_path, 3.0 + 0.5 * rows - 0.25 * columns, "interpolate", params)[2]
    y, x = (np.arange(480) + 0.5) * 128 / 480 - 0.5, (np.arange(512) + 0.5) * 170 / 512 - 0.5
    plane = 3.0 + 0.5 * np.clip(y, 0, 127)[:, None] - 0.25 * np.clip(x, 0, 169)
    np.testing.assert_allclose(value, plane, rtol=0, atol=1e-12)
    for order in (0, 1, 3):
        constant = through(
            tmp_path, np.full((9, 7), 1 / 3), "interpolate", {**params, "order": order}
        )
        assert (constant[2] == 1 / 3).all()


def test_threads_change_no_bit(tmp_path):
    params = {"width": 900, "height": 700, "order": 3}
    one = through(tmp_path, picture(300, 400), "interpolate", params, "single", threads=1)[2]
    three = through(tmp_path, picture(300, 400), "interpolate", params, "single", threads=3)[2]
    np.testing.assert_array_equal(one, three)


@pytest.mark.parametrize("params", [{}, {"width": 9, "height": 6}, {"width": 0, "order": 3}])
def test_equal_size_passes_the_key(tmp_path, params):
    source, image, _, _ = through(tmp_path, picture(6, 9), "interpolate", params)
    assert image.key == source.key


def test_low_passes_are_one_at_zero_exactly():
    for factor in range(1, 40):
        box = block_mean_mtf(frequency=np.zeros(1), interval_mrad=1.0, samples=factor)
        assert box[0] == 1.0
        assert lanczos_mtf(frequency=np.zeros(1), factor=factor)[0] == 1.0


def test_factor_one_passes_the_key(tmp_path):
    source, image, _, _ = through(tmp_path, picture(6, 9), "anti_alias", {"kernel": "lanczos"})
    assert image.key == source.key
