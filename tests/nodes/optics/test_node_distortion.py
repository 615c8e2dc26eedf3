"""Distortion ray by ray against its own equations, and pictures known between their samples."""

import math
import re

import numpy as np
import pytest

from core.chain.step_lineage import lineage_of
from core.errors import ParameterError
from core.physics.optics.field import Distortion, samples_at
from field_bench import angles, assert_same_in_blocks, cube_bench, field_bench
from node_bench import NodeBench

BROWN = {"k1": -0.25, "k2": 0.08, "k3": -0.01, "p1": 2e-3, "p2": -1e-3}
FISHEYE = {"model": "fisheye", "k1": 0.05, "k2": -0.01, "k3": 0.002, "k4": -1e-4}


def landed(params, x, y):
    """Where OpenCV's equations put the ray at x, y."""
    k = [params.get(f"k{n}", 0.0) for n in (1, 2, 3, 4)]
    p1, p2 = params.get("p1", 0.0), params.get("p2", 0.0)
    if params.get("model") == "fisheye":
        t = np.arctan(np.hypot(x, y))
        share = t * (1 + k[0] * t**2 + k[1] * t**4 + k[2] * t**6 + k[3] * t**8) / np.hypot(x, y)
        return x * share, y * share
    r2 = x * x + y * y
    radial = 1 + k[0] * r2 + k[1] * r2**2 + k[2] * r2**3
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def lens(params):
    k = [params.get(f"k{n}", 0.0) for n in (1, 2, 3, 4)]
    model = params.get("model", "brown")
    k = k if model == "fisheye" else k[:3]
    return Distortion(model, tuple(k), (params.get("p1", 0.0), params.get("p2", 0.0)))


@pytest.mark.parametrize("params", [BROWN, FISHEYE, {"model": "fisheye"}, {"k1": 0.5}])
def test_each_ray_lands_where_it_is_looked_for(params):
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(-0.5, 0.5, 41), [-0.31, 0.013, 0.4]))
    back = landed(params, *lens(params).undistorted(x, y))
    np.testing.assert_allclose(back, (x, y), atol=1e-14)


@pytest.mark.parametrize(("frequency", "amplitude"), [(0.03, 1e-7), (0.1, 5e-5), (0.15, 1e-3),
                                                      (0.2, 5e-3)])  # fmt: skip
def test_waves_between_samples_keep_their_place(frequency, amplitude):
    """A complex wave: its angle is its place, to 1e-3 sample."""
    j = np.arange(200)
    x = np.random.default_rng(3).uniform(20, 180, 5000)
    wave = [samples_at(picture=part(2 * np.pi * frequency * j)[np.newaxis] * np.ones((9, 1)), x=x,
                       y=np.full(5000, 4.3)) for part in (np.cos, np.sin)]  # fmt: skip
    ratio = (wave[0] + 1j * wave[1]) / np.exp(2j * np.pi * frequency * x)
    assert np.abs(np.angle(ratio)).max() / (2 * np.pi * frequency) < 1e-3
    assert np.abs(np.abs(ratio) - 1).max() < amplitude


def waves(x, y):
    """Of at most 0.12 cycles a sample of 2 mrad in each direction."""
    return 3 + np.sin(300 * x + 100 * y) + np.cos(-220 * x + 340 * y) + 0.5 * np.sin(50 * x)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("params", [BROWN, FISHEYE])
def test_a_picture_of_waves(tmp_path, params, precision):
    """The distorted picture is the function itself at each sample's own ray."""
    wide, camera, step = (300, 320), (220, 240), 2.0
    centre = {"centre_x_mrad": 15.0, "centre_y_mrad": -9.0}
    size = {"width": camera[1], "height": camera[0]}
    picture = waves(*angles(wide, step))
    how = {"step_mrad": step, "precision": precision}
    bench = field_bench(tmp_path, picture, "distortion", {**params, **centre, **size}, **how)
    x, y = angles(camera, step)
    u, v = lens(params).undistorted(x - 0.015, y + 0.009)
    np.testing.assert_allclose(landed(params, u, v), (x - 0.015, y + 0.009), atol=1e-13)
    found = bench.value("it.image")
    assert found.dtype == bench.work.policy.dtype
    slope = 0.5 * 50 + math.hypot(300, 100) + math.hypot(220, 340)  # at most, per rad
    off = np.abs(found - waves(u + 0.015, v - 0.009))
    assert off.max() < 1e-3 * slope * step / 1000  # as if 1e-3 sample beside its place
    change = lineage_of(bench.port("it.image").recipe).linear
    assert change.size_before(*camera) == wide
    assert change.transfer(None, None, None) == ()


def test_figures_and_warnings(tmp_path):
    """f-θ: at the corner θ/tan θ − 1; beyond the scene where tan θ leaves it."""
    shape, step = (60, 80), 15.0
    bench = field_bench(tmp_path, np.ones(shape), "distortion", {"model": "fisheye"},
                        step_mrad=step)  # fmt: skip
    np.testing.assert_allclose(bench.value("it.image"), 1.0, rtol=1e-13)
    shown = bench.readouts("it")
    x, y = angles(shape, step)
    theta = np.hypot(x, y)
    corner = theta.max()
    assert shown["corner_percent"] == pytest.approx(100 * (corner / math.tan(corner) - 1))
    share = np.tan(theta) / theta
    out = (np.abs(x * share) > 0.04 * step) | (np.abs(y * share) > 0.03 * step)
    assert shown["beyond_percent"] == pytest.approx(100 * out.mean(), abs=1e-9)
    cos, sin = x.max() / corner, y.max() / corner  # a step along the row, radial and across
    stretch = math.hypot(cos / math.cos(corner) ** 2, sin * math.tan(corner) / corner)
    assert shown["largest_step"] == pytest.approx(stretch, rel=0.02)
    texts = [caution.message for caution in bench.warnings()]
    assert len(texts) == 1 + (stretch > 1.5)
    assert "lie beyond the scene" in texts[0]


def test_the_scene_that_the_warning_asks_for(tmp_path):
    """The scene before had the lens' own field, 2·atan; a spot lands where the equations put it."""
    camera = {"pitch_um": 5.0, "focal_length_mm": 0.8, "pixels_x": 64, "pixels_y": 48}
    size, step = (96, 128), 3.125  # mrad, two samples a pixel

    def made(shape, fov, params):
        y, x = angles(shape, step)[::-1]
        spot = np.exp(-0.5 * ((x - 0.16) ** 2 + (y + 0.1) ** 2) / 0.006**2)
        np.save(tmp_path / "wide.npy", spot)
        read = {"path": "wide.npy", "fov_x_deg": fov[0], "fov_y_deg": fov[1]}
        nodes = {"read": ("read_image", read), "camera": ("camera", camera),
                 "it": ("distortion", {"k1": -0.9, **params})}  # fmt: skip
        bench = NodeBench(tmp_path, nodes)
        return bench, [c for c in bench.warnings() if c.node == "it"]

    lens_field = [math.degrees(2 * math.atan(n * step / 2000)) for n in size[::-1]]
    _, (caution,) = made(size, lens_field, {})
    wanted = r"(\d+) × (\d+) samples .*= ([\d.]+) .*= ([\d.]+), .*= (\d+) .*= (\d+) here"
    columns, rows, *fov, width, height = re.search(wanted, str(caution)).groups()
    assert (int(height), int(width)) == size
    bench, cautions = made((int(rows), int(columns)), [float(f) for f in fov],
                           {"width": int(width), "height": int(height)})  # fmt: skip
    assert not cautions
    found = bench.value("it.image")
    x, y = ((part * found).sum() / found.sum() for part in angles(size, step))
    np.testing.assert_allclose((x, y), landed({"k1": -0.9}, 0.16, -0.1), atol=2e-4)


def test_bands_and_blocks(tmp_path):
    bench, width = cube_bench(tmp_path, "distortion", BROWN)
    image = bench.port("it.image")
    whole = sum(w * bench.work.value(image.bands.band(n)) for n, w in enumerate([width] * 3))
    np.testing.assert_allclose(whole, bench.value("it.image"), rtol=1e-12)
    picture = np.random.default_rng(2).random((300, 333))
    bench = field_bench(tmp_path, picture, "distortion", {**BROWN, "width": 290})
    assert_same_in_blocks(bench, "it.image", tmp_path, 200_000)


def test_a_picture_that_folds_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"k1 = -1\.0 is.*fold back"):
        field_bench(tmp_path, np.ones((40, 50)), "distortion", {"k1": -1}, step_mrad=20)
    with pytest.raises(ParameterError, match="fold back"):
        field_bench(tmp_path, np.ones((40, 50)), "distortion", {"model": "fisheye"}, step_mrad=60)
    with pytest.raises(ParameterError, match=r"p2 = 2\.0 is.*fold back"):
        field_bench(tmp_path, np.ones((40, 50)), "distortion", {"p2": 2}, step_mrad=20)
