"""Compare Images against plain numpy."""

import numpy as np
import pytest

from node_bench import NodeBench


def blur(sigma, frequency):
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


def picture(seed=1, size=(40, 56)):
    return np.random.default_rng(seed).uniform(20, 60, size)


def compared(folder, image, reference, fov=True, precision="double", **params):
    reading = {"fov_x_deg": 2.0, "fov_y_deg": 1.5} if fov else {}
    np.save(folder / "a.npy", image)
    np.save(folder / "b.npy", reference)
    nodes = {
        "a": ("read_image", {"path": "a.npy", **reading}),
        "b": ("read_image", {"path": "b.npy", **reading}),
        "out": ("compare_images", params),
    }
    links = [("a.image", "out.image"), ("b.image", "out.reference")]
    return NodeBench(folder, nodes, links, precision=precision)


def test_figures_of_the_difference(tmp_path):
    a, b = picture(1, (300, 1000)), picture(2, (300, 1000))
    bench = compared(tmp_path, a, b)
    expected = {
        "rmse": np.sqrt(np.mean((a - b) ** 2)),
        "max_error": np.abs(a - b).max(),
        "psnr_dB": 20 * np.log10((b.max() - b.min()) / np.sqrt(np.mean((a - b) ** 2))),
        "mean_difference": np.mean(a - b),
    }
    found = bench.value("out.table").as_dict()
    assert found == pytest.approx(expected, rel=1e-12)
    assert bench.readouts("out") == found
    np.testing.assert_array_equal(bench.value("out.difference"), a - b)


def blurred(array, fov_deg, sigma, edges):
    """Gaussian blur by plain numpy: on the frame itself, or on the mirrored one."""
    mirrored = edges == "reflect"
    both = np.pad(array, [(0, n) for n in array.shape], mode="symmetric") if mirrored else array
    intervals = [np.radians(f) * 1000 / n for f, n in zip(fov_deg, array.shape, strict=True)]
    eta, xi = (np.fft.fftfreq(n, d) for n, d in zip(both.shape, intervals, strict=True))
    transfer = blur(sigma, eta)[:, None] * blur(sigma, xi)
    result = np.fft.ifft2(np.fft.fft2(both) * transfer).real
    return result[: array.shape[0], : array.shape[1]]


@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("size", [(40, 56), (41, 55)])
def test_ratio_of_a_blurred_picture_is_the_mtf(tmp_path, edges, size):
    reference = picture(size=size)
    image = blurred(reference, (1.5, 2.0), 0.4, edges)
    bench = compared(tmp_path, image, reference, edges=edges)
    series = bench.value("out.curve").series
    assert [each.label for each in series] == ["horizontal", "vertical"]
    for each, fov, samples in zip(series, (2.0, 1.5), size[::-1], strict=True):
        np.testing.assert_allclose(each.y, blur(0.4, each.x), rtol=1e-9)
        nyquist = 0.5 * samples / (np.radians(fov) * 1000)
        assert 0.95 * nyquist < each.x.max() <= nyquist * (1 + 1e-12)
    bench = compared(tmp_path, image, reference, edges=edges, average="radial")
    (ring,) = bench.value("out.curve").series
    assert ring.y[0] == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(ring.y, blur(0.4, ring.x), rtol=0.01, atol=2e-3)


def test_without_interval_frequencies_are_per_sample(tmp_path):
    bench = compared(tmp_path, 2 * picture(), picture(), fov=False)
    curves = bench.value("out.curve")
    assert curves.x_label == "frequency (cycles/sample)"
    assert 0.48 < curves.series[0].x.max() <= 0.5
    np.testing.assert_allclose(curves.series[0].y, 2, rtol=1e-12)


@pytest.mark.parametrize("average", ["axes", "radial"])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("size", [(1, 1), (1, 9), (8, 1), (7, 5)])
@pytest.mark.parametrize("level", [0.0, 3.0, 1e30])
def test_frequencies_without_signal_are_left_out(tmp_path, average, edges, size, level):
    reference, settings = np.full(size, level), {"average": average, "edges": edges}
    bench = compared(tmp_path, picture(size=size), reference, **settings)
    for series in bench.value("out.curve").series:
        assert series.x.tolist() == ([] if level == 0 else [0.0])
        assert np.isfinite(series.y).all()
    assert bench.value("out.table").as_dict()["psnr_dB"] is None
