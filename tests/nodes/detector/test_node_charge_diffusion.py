"""Charge Diffusion MTF: the module's curve is the formula's, over the picture's band."""

import pytest

from core.physics.detector.detector_mtf import diffusion_mtf
from node_bench import NodeBench
from reference_cases import CAMERA, reference_cases


def bench_of(folder, params, *, band=(0.5, 0.8), pixel_um=10.0, focal_mm=100.0):
    scene = {"kind": "point", "width": 32, "height": 24, "fov_x_deg": 0.1, "fov_y_deg": 0.1,
             "temperature_K": 1200.0, "cut_on_um": band[0], "cut_off_um": band[1]}  # fmt: skip
    init = {"detector_x_um": pixel_um, "detector_y_um": pixel_um, "focal_length_mm": focal_mm,
            "f_number": 4, "platform": "array"}  # fmt: skip
    nodes = {"scene": ("test_scene", scene), "init": ("init_trans", init),
             "it": ("charge_diffusion_mtf", params)}  # fmt: skip
    return NodeBench(folder, nodes)


@pytest.mark.parametrize("case", reference_cases("diffusion_mtf", file=CAMERA)[:3])
def test_the_reference(case, tmp_path):
    """At the pixels' Nyquist frequency, which is the frequency of the case."""
    given = {name: float(value) for name, value in case["inputs"].items()}
    frequency = given.pop("cycles_per_mm")
    bench = bench_of(tmp_path, given, pixel_um=500.0 / frequency)
    found = bench.readouts("it")["mtf_at_pixel_nyquist_x"]
    assert found == pytest.approx(float(case["expected"]["mtf"]), rel=1e-9)


def test_red_light_blurs_most_from_the_front_and_blue_from_the_back(tmp_path):
    back = {"side": "back", "thickness_um": 15.0}

    def nyquist(params, band):
        return bench_of(tmp_path, params, band=band).readouts("it")["mtf_at_pixel_nyquist_x"]

    red, blue = (0.85, 0.95), (0.42, 0.48)
    assert nyquist({}, red) < 0.6
    assert nyquist({}, blue) > 0.95
    assert nyquist(back, blue) < nyquist(back, red)


@pytest.mark.parametrize(
    ("params", "band", "words"),
    [
        (
            {},
            (3.0, 5.0),
            "0.25 to 1.2 µm, where silicon absorbs; for other wavelengths, give absorption_per_um",
        ),
        (
            {"side": "back"},
            (0.5, 0.8),
            "thickness_um is empty: the thickness of a back-illuminated detector must",
        ),
        ({"side": "back", "thickness_um": 3.0}, (0.5, 0.8), "thickness_um = 3"),
    ],
)
def test_faults(tmp_path, params, band, words):
    bench = bench_of(tmp_path, params, band=band)
    assert words in str(bench.error("it"))


def test_it_blurs_the_picture_by_its_curve(tmp_path):
    bench = bench_of(tmp_path, {"absorption_per_um": 0.1})
    before, after = bench.value("init.magnitude"), bench.value("it.magnitude")
    ratio = after[0, 5] / before[0, 5]
    xi = 5 * bench.readouts("init")["frequency_interval_x"]
    expected = diffusion_mtf(
        cycles_per_mm=xi * 10.0, absorption_per_um=0.1, depletion_um=5.0,
        diffusion_length_um=50.0,
    )  # fmt: skip
    assert expected < 0.95
    assert ratio == pytest.approx(float(expected), rel=1e-9)
