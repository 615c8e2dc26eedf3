"""Sample Pixels: one sample a pixel, against sums of waves and Bracewell's formulas by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic_stages import CHAINS, INTERVAL_X, INTERVAL_Y
from core.chain.engine import Engine
from core.chain.noise_power import NoisePower
from core.chain.step_lineage import PixelSamples
from core.evaluation.recipes import Region
from core.evaluation.work import Policy
from delivered_chains import FOLD_ERROR, PRECISIONS, delivered, fov_deg, scene
from node_bench import NodeBench
from nodes.analysis.lineage import NoiseOf, transfer_of
from nodes.library import standard_library

LIBRARY = standard_library()


def sampled(**params):
    return (("sample_pixels", params),)


def waves_of(size, edges, number):
    """A wave of the frame and its values anywhere: a cosine that the mirrored frame holds."""
    if edges == "reflect":
        return lambda place: np.cos(np.pi * number * (place + 0.5) / size)
    return lambda place: np.cos(2 * np.pi * number * place / size + 0.7)


@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize(
    ("ratio_x", "ratio_y", "offset", "offset_y"),
    [(2.0, 3.0, 0.0, None), (2.5, 4.0, 0.0, None), (math.pi, 1.3, 0.31, -0.5), (0.7, 1, 0.5, 0.25)],
)
def test_waves_between_samples(tmp_path, edges, ratio_x, ratio_y, offset, offset_y):
    """Each wave is known at any place: no code of the frame's transforms enters."""
    rows, columns = 21, 30
    across = [(1, 2.0), (7, -1.0), (12, 0.5)]
    along = [(0, 1.0), (4, 1.5), (9, -0.25)]

    def picture(y, x):
        wide = sum(a * waves_of(columns, edges, k)(x) for k, a in across)
        high = sum(a * waves_of(rows, edges, k)(y) for k, a in along)
        return 30 + np.multiply.outer(high, wide)

    whole = picture(np.arange(rows), np.arange(columns))
    down = offset if offset_y is None else offset_y
    tail = sampled(factor_x=ratio_x, factor_y=ratio_y, offset=offset, offset_y=offset_y)
    found, plan = delivered(tmp_path, whole, (), "double", edges, tail)
    x = (np.arange(int(columns / ratio_x + 1e-6)) + 0.5 + offset) * ratio_x - 0.5
    y = (np.arange(int(rows / ratio_y + 1e-6)) + 0.5 + down) * ratio_y - 0.5
    assert found.shape == (len(y), len(x))
    assert np.abs(found - picture(y, x)).max() <= 1e-12 * 40
    image = plan.output("tail0.image")
    assert image.interval_x_mrad == pytest.approx(INTERVAL_X * ratio_x, rel=1e-14)
    assert image.interval_y_mrad == pytest.approx(INTERVAL_Y * ratio_y, rel=1e-14)


def camera_network(folder, tail, *, edges="periodic", number=63, ratio=8, fill=1.0):
    """A wave just below the pixels' Nyquist frequency, seen through the detector alone."""
    size, interval = 128 * ratio, 0.01
    wave = 40 + 10 * np.cos(2 * np.pi * number * np.arange(size) / size)
    np.save(folder / "in.npy", np.broadcast_to(wave, (3, size)).copy())
    fovs = {"fov_x_deg": fov_deg(size, interval), "fov_y_deg": fov_deg(3, interval)}
    nodes = {
        "file": ("read_image", {"path": "in.npy", **fovs}),
        "init": ("init_trans", {
            "detector_x_um": ratio * 10 * interval, "detector_y_um": 10 * interval,
            "focal_length_mm": 10, "fill_x": fill, "edges": edges,
        }),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "pixels": tail,
    }  # fmt: skip
    return NodeBench(folder, nodes)


def contrast(picture, number=63):
    row = picture[0].astype(float)
    return 2 * abs(np.fft.fft(row)[number]) / len(row) / 10


@pytest.mark.parametrize("fill", [1.0, 0.8])
def test_a_pixel_averages_once(tmp_path, fill):
    """2/π at Nyquist for a full pixel; a mean of eight samples on top takes 0.64 of that again."""
    frequency = 63 / 128  # cycles a pixel
    detector = math.sin(math.pi * frequency * fill) / (math.pi * frequency * fill)
    bench = camera_network(tmp_path, ("sample_pixels", {}), fill=fill)
    once = bench.value("pixels.image")
    assert once.shape == (3, 128)  # the pitch of Init & Trans
    assert contrast(once) == pytest.approx(detector, rel=1e-12)
    assert once.mean() == pytest.approx(40, rel=1e-13)
    assert bench.plan.warnings() == []
    twice = ("combine_pixels", {"factor_x": 8})
    bench = camera_network(tmp_path, twice, fill=fill)
    block = math.sin(math.pi * frequency) / (8 * math.sin(math.pi * frequency / 8))
    picture = bench.value("pixels.image")
    assert contrast(picture) == pytest.approx(detector * block, rel=1e-12)
    (caution,) = bench.plan.warnings()
    assert caution.node == "pixels"
    for part in ("Detector MTF (detector)", "averaged twice", "0.641", "Sample Pixels"):
        assert part in str(caution)


def test_lineage_has_the_detector_and_the_shift_alone(tmp_path):
    bench = camera_network(tmp_path, ("sample_pixels", {"offset": 0.25, "offset_y": 0}))
    passed = transfer_of(bench.port("pixels.image"))
    assert [(stage.label, len(stage.factors)) for stage in passed.stages] == [
        ("Detector MTF", 1), ("Sampled pixels", 1),
    ]  # fmt: skip
    (shift,) = passed.part("ptf")
    phase = shift.factors[0].axis(bench.work, shift.factors[0].x, np.array([0.0, 3.0]))
    assert phase == pytest.approx([0.0, 2 * np.pi * 3.0 * 0.25 * 0.08], abs=1e-15)
    made = bench.value("pixels.image")[0]
    fixed = camera_network(tmp_path, ("sample_pixels", {})).value("pixels.image")[0]
    turned = np.angle(np.fft.fft(made)[63] / np.fft.fft(fixed)[63])
    assert turned == pytest.approx(2 * np.pi * 63 / 128 * 0.25, abs=1e-12)


@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("ratio", [2.0, 2.5])
def test_noise_follows(tmp_path, edges, ratio):
    """Predicted against the linear map itself: each sample's variance is a sum of squares."""
    rng = np.random.default_rng(8)
    np.save(tmp_path / "in.npy", 40 + rng.uniform(size=(6, 10)))
    nodes = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 1, "fov_y_deg": 1}),
        "init": ("init_trans", {"edges": edges}),
        "back": ("back_transform", {}),
        "noise": ("poisson_noise", {"mode": "photon", "photons_per_unit": 10.0}),
        "pixels": ("sample_pixels", {"factor_x": ratio, "factor_y": 1}),
    }
    bench = NodeBench(tmp_path, nodes)
    found = bench.work.value(NoiseOf(bench.port("pixels.image"))).total.total
    places = (np.arange(int(10 / ratio)) + 0.5) * ratio - 0.5
    variance = np.mean(bench.value("back.image")) / 10
    # Of the frame's interpolation at a place: the squares of its weights.
    if edges == "reflect":
        k = np.arange(1, 10)[:, None, None]
        n, x = np.arange(10)[:, None] + 0.5, places + 0.5
        weights = (1 + 2 * (np.cos(np.pi * k * n / 10) * np.cos(np.pi * k * x / 10)).sum(0)) / 10
    else:
        k, away = np.arange(1, 5)[:, None, None], np.arange(10)[:, None] - places
        weights = 1 + 2 * np.cos(2 * np.pi * k * away / 10).sum(0)
        nyquist = np.cos(np.pi * np.arange(10))[:, None] * np.cos(np.pi * places)
        weights = (weights + nyquist) / 10
    assert found == pytest.approx(variance * np.mean(np.sum(weights**2, axis=0)), rel=2e-3)


def test_refusals(tmp_path):
    for params, words in (
        ({}, ("factor_x", "Camera", "Init & Trans")),
        ({"factor_x": 200, "factor_y": 1}, ("200", "12")),
    ):
        np.save(tmp_path / "in.npy", scene(8, 12))
        nodes = {"file": ("read_image", {"path": "in.npy"}), "pixels": ("sample_pixels", params)}
        (error,) = NodeBench(tmp_path, nodes).plan.errors()
        for word in words:
            assert word in str(error)


@pytest.mark.parametrize("edges", ["reflect", "periodic"])
def test_a_region_is_the_wholes(tmp_path, edges):
    """Through what follows too, for a viewer that shows a part."""
    tail = (
        ("sample_pixels", {"factor_x": 1.7, "factor_y": 2}),
        ("interpolate", {"width": 40, "height": 9}),
    )
    whole, plan = delivered(tmp_path, scene(24, 36), CHAINS["whole chain"], "single", edges, tail)
    region = Region(2, 5, 4, 11)
    part = Engine(LIBRARY).work(Policy()).part(plan.output("tail1.image").recipe, region)
    assert np.array_equal(part, whole[region.slices])


@pytest.mark.parametrize("axes", ["mirrored", "periodic"])
@pytest.mark.parametrize(("rows", "columns", "factors"), [(12, 10, (3, 2)), (8, 9, (4, 3))])
def test_noise_folded_is_noise_sampled(axes, rows, columns, factors):
    rng = np.random.default_rng(4)
    power = rng.uniform(0.5, 2, (rows, columns))
    if axes == "periodic":
        power = power + np.roll(power[::-1, ::-1], (1, 1), (0, 1))  # as of real noise
    coloured = NoisePower(rows, columns, power, axes=axes)
    edges = "reflect" if axes == "mirrored" else "periodic"
    pixels = PixelSamples((rows, columns), factors[1], factors[0], 0.0, 0.0, edges)
    assert pixels.folds
    beside = replace(pixels, offset_x=1e-15)
    assert not beside.folds
    found, true = (each.noise(None, coloured).shown for each in (pixels, beside))
    assert np.broadcast_to(found, true.shape) == pytest.approx(true, rel=1e-11)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_frame_that_an_anti_aliaser_mirrored_is_sampled_as_the_transform_had_it(
    tmp_path, precision
):
    """Whole samples at the same places, whichever of a periodic frame's waves are summed."""
    samples = scene(11, 13)
    before = ("anti_alias", {"kernel": "gaussian", "factor": 2})
    smooth, _ = delivered(tmp_path, samples, (), precision, "periodic", (before,))
    size, places = 13, np.arange(3) * 4.0 + 1.5 + 4 * 0.5595
    found, _ = delivered(
        tmp_path, samples, (), precision, "periodic",
        (before, *sampled(factor_x=4.0, factor_y=1.0, offset=0.5595, offset_y=0.0)),
    )  # fmt: skip
    # Dirichlet's kernel of an odd number of samples.
    apart = np.pi * (places[:, np.newaxis] - np.arange(size))
    kernel = np.sin(apart) / (size * np.sin(apart / size))
    expected = smooth.astype(float) @ kernel.T
    assert np.abs(found - expected).max() <= FOLD_ERROR[precision] * np.abs(samples).max()


@pytest.mark.parametrize("column", ["mtf", "mtf_x"])
def test_a_table_may_have_been_measured_behind_the_pixels(tmp_path, column):
    """A blur beside it could not; both are warned of, and the table's way out is named."""
    (tmp_path / "m.csv").write_text(f"frequency (cyc/pixel),{column}\n0,1\n0.5,0.3\n1,0\n")
    remedies = []
    for stage in (("mtf_file", {"path": "m.csv"}), ("gaussian_mtf", {"sigma_x_mrad": 0.1})):
        nodes = {
            "scene": ("test_scene", {"width": 32, "height": 32, "fov_x_deg": 1, "fov_y_deg": 1}),
            "init": ("init_trans", {"focal_length_mm": 100, "detector_x_um": 200,
                                    "detector_y_um": 200}),
            "stage": stage,
            "back": ("back_transform", {}),
            "pixels": ("sample_pixels", {"factor_x": 2.0, "factor_y": 2.0}),
        }  # fmt: skip
        warned = NodeBench(tmp_path, nodes).warnings()
        remedies += [str(one) for one in warned if one.check == "no_average"]
    assert ["includes the pixel MTF" in line for line in remedies] == [True, False]
