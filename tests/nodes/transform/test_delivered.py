"""Pictures behind Back Transform."""

import numpy as np
import pytest

from analytic_stages import (
    ALL,
    CHAINS,
    INTERVAL_X,
    INTERVAL_Y,
    SENSOR,
    STAGES,
    analytic,
    expected_h,
)
from delivered_chains import (
    FOLD_ERROR,
    MEAN_ERROR,
    MTF_ERROR,
    PRECISIONS,
    SHIFT_ERROR,
    chain_network,
    delivered,
    fov_deg,
    scene,
)
from linked_network import linked_network
from node_bench import NodeBench

SIZES = [(31, 17), (24, 10), (32, 32), (9, 20), (1, 16), (13, 1), (2, 2), (1, 1)]


@pytest.mark.thorough(but=22)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_delivered_mtf_is_the_analytic_product(tmp_path, size, chain, precision):
    rows, columns = size
    at = rows // 3, columns // 2
    point = np.zeros(size)
    point[at] = 1.0
    found, _ = delivered(tmp_path, point, CHAINS[chain], precision)
    # The FFT of the point itself, written as its phases, goes out of the FFT of the picture.
    towards = np.exp(
        2j * np.pi * (np.outer(np.fft.fftfreq(rows) * at[0], np.ones(columns))
                      + np.fft.fftfreq(columns) * at[1])
    )  # fmt: skip
    expected = expected_h(CHAINS[chain], rows, columns)
    assert np.abs(np.fft.fft2(found) * towards - expected).max() <= MTF_ERROR[precision]


@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize("stages", [("optics",), ("optics", "pixel", "late"), ("smear", "late")])
def test_single_precision_where_planes_are_approximated(tmp_path, edges, stages):
    rows, columns = 144, 262
    picture = scene(rows, columns)
    found, _ = delivered(tmp_path, picture, stages, "single", edges)
    frame = picture
    if edges == "reflect":
        frame = np.block([[picture, picture[:, ::-1]], [picture[::-1], picture[::-1, ::-1]]])
    h = expected_h(stages, *frame.shape, kind=np.float64)
    expected = np.fft.ifft2(np.fft.fft2(frame) * h).real[:rows, :columns]
    assert np.abs(found - expected).max() <= 2e-6 * np.abs(expected).max()


# ---------------------------------------------------------------- mean and shift


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("edges", "chain"), [
    ("periodic", "whole chain"), ("periodic", "sampled by rows"), ("reflect", "symmetric"),
])  # fmt: skip
@pytest.mark.parametrize("size", [(31, 17), (48, 20), (1, 16), (64, 64)], ids=str)
@pytest.mark.parametrize("level", [0.0, 1e5])
def test_mean_radiance_is_kept(tmp_path, size, chain, edges, precision, level):
    picture = (scene(*size) + level).astype(np.float32).astype(float)
    found, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    assert abs(found.mean() / picture.mean() - 1) <= MEAN_ERROR[precision]


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("stages", [("late",), ("published",), ALL])
@pytest.mark.parametrize("size", [(31, 17), (10, 24), (32, 32)], ids=str)
def test_shift_from_the_first_bin(tmp_path, size, stages, precision):
    picture = np.zeros(size)
    picture[1, 2] = 1.0
    found, _ = delivered(tmp_path, picture, stages, precision)
    columns = size[1]
    ratio = np.fft.fft2(found)[0, 1] / np.fft.fft2(picture)[0, 1]
    first = 1 / (columns * INTERVAL_X)
    true = np.prod([analytic(stage, np.array([[first]]), np.zeros((1, 1))) for stage in stages])
    shift, expected = (-np.angle(h) * columns / (2 * np.pi) for h in (ratio, true))
    assert abs(shift - expected) <= SHIFT_ERROR[precision]
    # A delay: to +x.
    assert shift > 0


@pytest.mark.thorough(but=27)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(
    ("size", "factors"),
    [
        ((24, 36), (2, 3)),
        ((21, 20), (7, 4)),
        ((30, 30), (30, 2)),
        ((15, 7), (5, 7)),
        ((1, 12), (1, 6)),
    ],
    ids=str,
)
def test_fold_then_inverse_is_inverse_then_mean(tmp_path, size, factors, chain, edges, precision):
    picture, (fy, fx) = scene(*size), factors
    tail = (("combine_pixels", {"factor_x": fx, "factor_y": fy}),)
    folded, plan = delivered(tmp_path, picture, CHAINS[chain], precision, edges, tail)
    # It was folded: nothing else went over the full frame again.
    assert type(plan.output("tail0.image").recipe).__name__ == "Delivered"
    fine, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    expected = fine.reshape(size[0] // fy, fy, size[1] // fx, fx).mean(axis=(1, 3))
    assert np.abs(folded - expected).max() <= FOLD_ERROR[precision] * np.abs(expected).max()


def two_images(shape_a, shape_b, fov_b=1.0, late=False):
    rows, columns = shape_a
    fovs = {"fov_x_deg": fov_deg(columns, INTERVAL_X), "fov_y_deg": fov_deg(rows, INTERVAL_Y)}
    nodes = {
        "a": ("read_image", {"path": "a.npy", "unit": "K"}),
        "b": ("read_image", {"path": "b.npy", "unit": "DN"}),
        "init a": ("init_trans", {**SENSOR, **fovs}),
        "init b": ("init_trans", {**SENSOR, **{k: v * fov_b for k, v in fovs.items()}}),
        "blur": STAGES["blur"],
        "late": STAGES["late"],
        "back": ("back_transform", {}),
    }
    links = [
        ("a.image", "init a.image"), ("b.image", "init b.image"),
        ("init a.context", "blur.context"), ("init a.magnitude", "blur.magnitude"),
        ("init b.context", "late.context"), ("init b.phase", "late.phase"),
        ("blur.magnitude", "back.magnitude"),
        ("late.phase" if late else "init b.phase", "back.phase"),
    ]  # fmt: skip
    return linked_network(nodes, links)


@pytest.mark.parametrize("size", [(31, 17), (24, 10), (1, 8), (7, 1)], ids=str)
@pytest.mark.parametrize("late", [False, True])
def test_magnitude_of_one_and_phase_of_another(tmp_path, size, late):
    a, b = scene(*size, seed=1), scene(*size, seed=2)
    np.save(tmp_path / "a.npy", a)
    np.save(tmp_path / "b.npy", b)
    bench = NodeBench(tmp_path, two_images(size, size, late=late))
    found = bench.value("back.image")
    h = expected_h(("blur", "late") if late else ("blur",), *size)
    spectrum = np.abs(np.fft.fft2(a)) * np.exp(1j * np.angle(np.fft.fft2(b))) * h
    expected = np.fft.ifft2(spectrum)
    assert np.abs(expected.imag).max() <= 1e-12 * np.abs(expected).max()
    assert np.abs(found - expected.real).max() <= 1e-12 * np.abs(expected).max()
    assert abs(found.mean() / a.mean() - 1) <= 1e-13
    assert bench.port("back.image").unit == "K"  # as the levels are


def test_two_samplings_of_one_size_are_kept_apart(tmp_path):
    """A PTF belongs to the frequencies of its own Init & Trans, whatever it is combined with."""
    picture = scene(16, 12)
    np.save(tmp_path / "a.npy", picture)
    np.save(tmp_path / "b.npy", picture)
    bench = NodeBench(tmp_path, two_images((16, 12), (16, 12), fov_b=2.0, late=True))
    found = bench.value("back.image")
    # Packets are one sample apart on either: w = 2πk/N at bin k.
    h = expected_h(("blur", "late"), 16, 12)
    expected = np.fft.ifft2(np.fft.fft2(picture) * h).real
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("size", [(31, 17), (24, 10)], ids=str)
def test_filter_alone_gives_its_impulse_response(tmp_path, size):
    np.save(tmp_path / "in.npy", scene(*size))
    document, _ = chain_network(("pixel", "late"), *size)
    for name in ("pixel", "late"):
        document = document.with_parameter(name, "apply", "filter_only")
    found = NodeBench(tmp_path, document).value("back.image")
    assert np.abs(np.fft.fft2(found) - expected_h(("pixel", "late"), *size)).max() <= 1e-12
    assert found.sum() == pytest.approx(1, abs=1e-13)
