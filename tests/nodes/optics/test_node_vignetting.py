"""Vignetting against cos⁴ and curves worked out here; its noise, bands and blocks."""

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from core.chain.step_lineage import lineage_of
from core.errors import FileError, ParameterError
from cube_files import C1_UM, C2_UM, centres, write_cube
from field_bench import angles, assert_same_in_blocks, cube_bench, field_bench
from node_bench import NodeBench
from region_checks import assert_parts

SHAPE = (40, 61)
STEP = 20.0  # mrad: the corner is at 35°
CAMERA = {"pitch_um": 15, "focal_length_mm": 0.75}  # 15 µm over it: 20 mrad


def light(folder, params, **how):
    bench = field_bench(folder, np.full(SHAPE, 3.0), "vignetting", params, step_mrad=STEP, **how)
    return bench, bench.value("it.image") / 3.0


def tangents():
    return np.hypot(*angles(SHAPE, STEP))


@pytest.mark.parametrize("camera", [None, CAMERA])
def test_natural_is_the_fourth_power_of_the_cosine(tmp_path, camera):
    bench, found = light(tmp_path, {}, camera=camera)
    np.testing.assert_allclose(found, np.cos(np.arctan(tangents())) ** 4, rtol=1e-13)
    corner = math.cos(math.atan(math.hypot(40, 61) / 2 * STEP / 1000)) ** 4
    shown = bench.readouts("it")
    assert shown["corner_percent"] == pytest.approx(100 * corner, rel=1e-12)
    assert shown["mean_percent"] == pytest.approx(100 * found.mean(), rel=1e-12)


@pytest.mark.parametrize(
    ("against", "of_tangent"),
    [("field_deg", lambda t: np.degrees(np.arctan(t))), ("height_mm", lambda t: 8.0 * t),
     ("half_diagonal", lambda t: t / (math.hypot(40, 61) / 2 * STEP / 1000))],
)  # fmt: skip
def test_a_measured_curve_and_a_polynomial(tmp_path, against, of_tangent):
    height = of_tangent(tangents())
    knots = height.max() * np.array([0.0, 0.3, 0.6, 1.1])
    values = [1.0, 0.97, 0.8, 0.4]
    lines = "\n".join(f"{h:.17g},{v}" for h, v in zip(knots, values, strict=True))
    (tmp_path / "lens.csv").write_text(f"# of the lens\nheight,light\n{lines}\n")
    how = {"natural": False, "against": against, "focal_length_mm": 8.0}
    _, found = light(tmp_path, {**how, "measured": "file", "path": "lens.csv"})
    np.testing.assert_allclose(found, PchipInterpolator(knots, values)(height), rtol=1e-12)
    share = (height / height.max()) ** 2
    c = [-0.3 / height.max() ** 2, -0.1 / height.max() ** 4]
    _, found = light(tmp_path, {**how, "measured": "polynomial", "coefficients": c})
    np.testing.assert_allclose(found, 1 - 0.3 * share - 0.1 * share**2, rtol=1e-12)


def test_shot_noise_follows_from_the_vignetted_light(tmp_path):
    """Variance and mean of the electrons are equal, at the corner as in the middle."""
    scene = {"kind": "uniform", "width": 512, "height": 512, "fov_x_deg": 60, "fov_y_deg": 60,
             "cut_on_um": 3.7, "cut_off_um": 4.8}  # fmt: skip
    fpa = {"integration_time_s": 1e-4, "full_well_e": 1e9, "units": "electrons",
           "photon_weighting": "middle"}  # fmt: skip
    nodes = {"scene": ("test_scene", scene), "it": ("vignetting", {}),
             "init": ("init_trans", {"detector_x_um": 15, "detector_y_um": 15,
                                     "focal_length_mm": 7, "f_number": 4}),
             "fpa": ("focal_plane", fpa)}  # fmt: skip
    bench = NodeBench(tmp_path, nodes)
    made = bench.value("fpa.image")
    corner, middle = made[:64, :64], made[224:288, 224:288]
    row = np.radians(60) * (np.arange(512) - 255.5) / 512
    expected = (1 + row**2 + row[:, np.newaxis] ** 2) ** -2
    for part, share in ((corner, expected[:64, :64]), (middle, expected[224:288, 224:288])):
        scaled = (part - part.mean() * share / share.mean()) / np.sqrt(share)
        assert scaled.var() == pytest.approx(part.mean() / share.mean(), rel=0.06)
    assert corner.mean() / middle.mean() == pytest.approx(
        expected[:64, :64].mean() / expected[224:288, 224:288].mean(), rel=2e-3
    )
    shot = bench.readouts("fpa")["shot_noise_e"]
    assert shot == pytest.approx(math.sqrt(made.mean()), rel=1e-3)


@pytest.mark.parametrize("in_bands", [False, True])
@pytest.mark.parametrize(
    ("key", "params"),
    [("focal_plane", {"integration_time_s": 1e-3, "read_noise_e": 300}),
     ("microbolometer", {"netd_mK": 50}), ("electronics_noise", {"bandwidth_Hz": 1e5})],
)  # fmt: skip
def test_half_the_light_costs_netd_as_half_the_transmission_does(tmp_path, key, params, in_bands):
    waves, width = centres(40, low=3.7, high=4.8)
    planck = C1_UM / waves**5 / np.expm1(C2_UM / waves / 293.15)
    write_cube(tmp_path, np.multiply.outer(planck, np.ones((8, 8))), waves, width)
    np.save(tmp_path / "flat.npy", np.full((8, 8), width * planck.sum()))
    band = {} if in_bands else {"cut_on_um": 3.7, "cut_off_um": 4.8}
    file = {"path": "cube.img", "bands": "all"} if in_bands else {"path": "flat.npy"}
    (tmp_path / "half.csv").write_text("0 0.5\n90 0.5\n")
    half = {"natural": False, "measured": "file", "path": "half.csv"}
    lens = {"detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 50, "f_number": 2}
    made = []
    for law, transmission in ((half, 0.8), ({"natural": False}, 0.4)):
        nodes = {"read": ("read_image", {**file, **band, "fov_x_deg": 0.1, "fov_y_deg": 0.1}),
                 "it": ("vignetting", law), "init": ("init_trans", lens),
                 "fpa": (key, {**params, "optics_transmission": transmission}),
                 "fom": ("figures_of_merit", {})}  # fmt: skip
        bench = NodeBench(tmp_path, nodes)
        table = bench.value("fpa.table").as_dict()
        made.append((bench.readouts("fom")["netd_K"], table))
    (seen, vignetted), (other, dimmed) = made
    name = "netd_system_K" if key == "electronics_noise" else "netd_K"
    kelvin = vignetted.get("scene_K", vignetted.get("background_K"))
    assert kelvin == pytest.approx(293.15, rel=1e-5)  # of the bands' sum
    assert vignetted[name] == pytest.approx(dimmed[name], rel=1e-5)
    assert seen == pytest.approx(other, rel=1e-5)


def test_bands_and_blocks(tmp_path):
    bench, _ = cube_bench(tmp_path, "vignetting", {})
    image = bench.port("it.image")
    one, before = (bench.work.value(stack.band(1)) for stack in
                   (image.bands, bench.port("read.image").bands))  # fmt: skip
    np.testing.assert_allclose(one / before, bench.value("it.image") / bench.value("read.image"))
    assert_parts(bench.plan.network, ["it.image"], tmp_path)
    bench = field_bench(tmp_path, np.random.default_rng(2).random((300, 200)), "vignetting", {})
    assert_same_in_blocks(bench, "it.image", tmp_path, 200_000)


def test_gain_and_noise_are_means_over_the_field(tmp_path):
    bench, found = light(tmp_path, {})
    change = lineage_of(bench.port("it.image").recipe).linear
    assert change.gain == pytest.approx(found.mean(), rel=1e-12)
    assert change.transfer(None, None, None) == ()


@pytest.mark.parametrize(
    ("params", "error", "words"),
    [({"measured": "file"}, ParameterError, "path"),
     ({"measured": "polynomial"}, ParameterError, "coefficients"),
     ({"measured": "polynomial", "coefficients": [-0.01]}, ParameterError, "it reaches -"),
     ({"measured": "polynomial", "coefficients": [1.0], "against": "height_mm"}, ParameterError,
      "focal_length_mm"),
     ({"measured": "file", "path": "bad.csv"}, FileError, "line 2: must contain a larger")],
)  # fmt: skip
def test_what_is_refused(tmp_path, params, error, words):
    (tmp_path / "bad.csv").write_text("1 1\n0.5 0.9\n")
    with pytest.raises(error, match=words):
        light(tmp_path, params)
