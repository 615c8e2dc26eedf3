"""Light of real lenses, from Camera to electrons, NER and a bolometer's noise."""

import pytest

from node_bench import NodeBench
from reference_cases import CAMERA, reference_cases

LENS = ("f_number", "t_number", "obscuration_ratio", "irradiance")
SENSOR = {"pitch_um": 15.0, "focal_length_mm": 100.0, "f_number": 4.0}
PLANE = {"integration_time_s": 0.004, "quantum_efficiency": 0.7, "bits": 0, "units": "electrons"}
SCENE = {
    "kind": "uniform", "width": 8, "height": 6, "fov_x_deg": 1.0, "fov_y_deg": 1.0,
    "cut_on_um": 3.7, "cut_off_um": 4.8, "temperature_K": 300.0,
}  # fmt: skip
ELECTRONICS = {
    "region": "MWIR", "material": "manual", "d_star": 1e11, "bandwidth_Hz": 1e4, "bits": 0,
    "background_K": 300.0,
}  # fmt: skip


def bench_of(
    folder, camera, *, module="focal_plane", params=None, scene=None, init=None, optics=None
):
    """Scene, Camera, Init & Trans, diffraction, and a detector `it`."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "camera": ("camera", camera),
        "init": ("init_trans", {"platform": "array", **(init or {})}),
        "optics": ("diffraction_mtf", optics or {}),
        "back": ("back_transform", {}),
        "it": (module, PLANE if params is None else params),
    }
    return NodeBench(folder, nodes)


def cautions(bench, check):
    return [caution.message for caution in bench.warnings() if caution.check == check]


@pytest.mark.parametrize("case", reference_cases("focal_plane_lens", file=CAMERA))
def test_lenses_of_the_reference(case, tmp_path):
    given = {
        name: value if name == "irradiance" else float(value)
        for name, value in case["inputs"].items()
    }
    camera = {name: given.pop(name) for name in LENS if name in given}
    camera |= {"pitch_um": given.pop("pitch_um"), "fill_x": given.pop("fill"), "fill_y": 1.0}
    scene = {name: given[name] for name in ("cut_on_um", "cut_off_um")}
    scene |= {"temperature_K": given.pop("scene_K")}
    given["bits"] = int(given["bits"])
    camera["aperture_mm"] = 25.0
    bench = bench_of(tmp_path, camera, params=given, scene=scene)
    found = bench.readouts("it")
    for name, value in case["expected"].items():
        assert found[name] == pytest.approx(float(value), rel=1e-9, abs=0.0), name


def test_an_obscuration_takes_its_share_of_the_light_everywhere(tmp_path):
    for module, params, name, power in (
        ("focal_plane", PLANE, "signal_e", 1.0),
        ("electronics_noise", ELECTRONICS, "ner", -1.0),
        ("microbolometer", {"netd_mK": 50.0}, "netd_K", -1.0),
    ):
        clear, obscured, typed = (
            bench_of(
                tmp_path, {**SENSOR, **camera}, module=module, params=params, init=init
            ).readouts("it")[name]
            for camera, init in (({}, {}), ({"obscuration_ratio": 0.6}, {}),
                                 ({}, {"obscuration_ratio": 0.6}))
        )  # fmt: skip
        assert obscured == pytest.approx(clear * 0.64**power, rel=1e-9), module
        assert typed == obscured


def test_a_t_number_replaces_transmission_and_obscuration_but_not_diffraction(tmp_path):
    camera = {**SENSOR, "obscuration_ratio": 0.3, "t_number": 5.0}
    warm = {**PLANE, "optics_K": 290.0}
    by_t = bench_of(tmp_path, camera, params=warm)
    # the transmission that gives the same light through the same aperture
    share = (4 * 4.0**2 + 1) / ((4 * 5.0**2 + 1) * (1 - 0.3**2))
    camera["t_number"] = None
    by_share = bench_of(tmp_path, camera, params={**warm, "optics_transmission": share})
    one, other = by_t.readouts("it"), by_share.readouts("it")
    assert one["optics_e"] > 0
    for name in ("signal_e", "optics_e", "netd_K"):
        assert one[name] == pytest.approx(other[name], rel=1e-12), name
    cutoffs = [bench.readouts("optics")["aperture_mm"] for bench in (by_t, by_share)]
    assert cutoffs == [25.0, 25.0]


@pytest.mark.parametrize("module", ["focal_plane", "electronics_noise", "microbolometer"])
def test_a_transmission_beside_a_t_number_is_warned_of(tmp_path, module):
    params = {"focal_plane": PLANE, "electronics_noise": ELECTRONICS, "microbolometer": {}}[module]
    camera = {**SENSOR, "t_number": 5.0}
    bench = bench_of(tmp_path, camera, module=module, params={**params, "optics_transmission": 0.9})
    (said,) = cautions(bench, "transmission")
    assert "optics_transmission = 0.9 is not used: t_number = 5" in said
    assert "0.6436" in said  # 65/101
    agreeing = {**params, "optics_transmission": 0.64}
    assert not cautions(bench_of(tmp_path, camera, module=module, params=agreeing), "transmission")


def test_more_light_than_the_f_number_passes_is_warned_of(tmp_path):
    bench = bench_of(tmp_path, {**SENSOR, "t_number": 3.0})
    (said,) = cautions(bench, "light")
    assert "t_number = 3 is too small for f_number" in said
    by_t = bench_of(tmp_path, {**SENSOR, "f_number": None, "aperture_mm": 25.0, "t_number": 3.0,
                               "focal_length_mm": None, "pitch_um": 15.0})  # fmt: skip
    assert bench.readouts("it")["signal_e"] == by_t.readouts("it")["signal_e"]


def test_an_obscuration_that_blurs_alone_is_warned_of(tmp_path):
    own = {"obscuration_ratio": 0.35}
    (said,) = cautions(bench_of(tmp_path, SENSOR, optics=own), "obscuration")
    assert "the blur uses obscuration_ratio = 0.35 on optics, but the radiometry uses 0" in said
    assert not cautions(bench_of(tmp_path, SENSOR, optics=own, init=own), "obscuration")
    assert not cautions(bench_of(tmp_path, {**SENSOR, **own}), "obscuration")


def test_the_netd_of_a_camera_contains_its_lens(tmp_path):
    """40 mK of a camera at F/1.1 and 0.9 stays 40 mK when that lens is entered on both sides."""
    sheet = {"netd_mK": 40.0, "reference_f_number": 1.1, "optics_transmission": 0.9}
    scene = {"cut_on_um": 8.0, "cut_off_um": 14.0}
    camera = {**SENSOR, "f_number": 1.1}
    found = [
        bench_of(
            tmp_path, camera, module="microbolometer", scene=scene,
            params={**sheet, "reference_transmission": share},
        ).readouts("it")["netd_K"]
        for share in (1.0, 0.9)
    ]  # fmt: skip
    assert found[0] == pytest.approx(0.040 / 0.9, rel=1e-6)
    assert found[1] == pytest.approx(0.040, rel=1e-6)


@pytest.mark.parametrize("case", reference_cases("field_of_view", file=CAMERA))
def test_fields_of_view_of_the_reference(case, tmp_path):
    given = {name: float(value) for name, value in case["inputs"].items()}
    camera = {
        "pixels_x": int(given["pixels"]), "pixels_y": 8, "pitch_um": given["pitch_um"],
        "focal_length_mm": given["focal_length_mm"], "f_number": 1.1,
    }  # fmt: skip
    bench = bench_of(tmp_path, camera, scene={"fov_x_deg": None, "fov_y_deg": None})
    found = bench.readouts("camera")
    assert found["fov_x_deg"] == pytest.approx(float(case["expected"]["fov_deg"]), rel=1e-9)
    of_pixel = given["pitch_um"] / given["focal_length_mm"]
    assert found["pixel_x_mrad"] == pytest.approx(of_pixel, rel=1e-15)
