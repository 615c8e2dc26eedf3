"""What Focal Plane warns of beside clipping: bands, dark current, a response that breaks off."""

import pytest

from focal_plane_bench import CAMERA_SHEET, SENSOR, cautions, focal_plane_bench
from node_bench import NodeBench


@pytest.mark.parametrize(
    ("params", "warned"),
    [
        ({"material_cutoff_um": 4.5}, True),
        ({"material_cutoff_um": 4.5, "cut_off_um": 4.5}, False),
        ({"material_cutoff_um": 4.5, "response": "qe.csv"}, False),
        ({"material_cutoff_um": 5.3}, False),
        ({}, False),
    ],
)
def test_photons_beyond_the_cutoff_of_the_material_are_warned_of(tmp_path, params, warned):
    (tmp_path / "qe.csv").write_text("3.0,0.7\n4.4,0.7\n4.6,0\n5.0,0\n")
    bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, "detector_K": 90, "rule_07": bool(
        params.get("material_cutoff_um")), **params}, size=(8, 8))  # fmt: skip
    found = cautions(bench, "material")
    assert len(found) == warned
    if warned:
        assert "3.7 to 4.8 µm" in found[0].text
        assert "material_cutoff_um = 4.5 µm" in found[0].text


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ({"detector_K": 150, "material_cutoff_um": 5.2}, "rule_07 is off"),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "rule_07": True}, None),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "rule_07": True,
          "dark_current_e_per_s": 2e5}, "dark_current_e_per_s = 200000 e-/s is not used"),
        ({"detector_K": 150, "material_cutoff_um": 5.2, "dark_current_e_per_s": 2e5}, None),
        ({}, None),
    ],
)  # fmt: skip
def test_a_dark_current_that_does_nothing_is_warned_of(tmp_path, params, said):
    bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 8))
    found = cautions(bench, "dark_current")
    assert len(found) == (said is not None)
    assert said is None or said in found[0].text


@pytest.mark.parametrize(
    ("optics", "params", "warned"),
    [
        ({}, {"cut_on_um": 7.7, "cut_off_um": 9.3}, True),
        ({"cut_on_um": 7.7, "cut_off_um": 9.3}, {"cut_on_um": 7.7, "cut_off_um": 9.3}, False),
        ({}, {"cut_on_um": 7.9, "cut_off_um": 12.0}, False),
        ({}, {}, False),
        ({"cut_on_um": 7.5, "cut_off_um": 8.0}, {}, True),
    ],
)
def test_optics_of_another_band_than_the_cold_filter_are_warned_of(
    tmp_path, optics, params, warned
):
    """At F/2 and 100 mm, 7.5 to 12 µm end at 5.1 cyc/mrad and 7.7 to 9.3 µm at 5.9."""
    seen = {
        "kind": "uniform", "width": 16, "height": 12, "fov_x_deg": 0.1, "fov_y_deg": 0.1,
        "temperature_K": 300.0, "cut_on_um": 7.5, "cut_off_um": 12.0,
    }  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "init": ("init_trans", {**SENSOR, "f_number": 2}),
        "lens": ("diffraction_mtf", optics),
        "back": ("back_transform", {}),
        "pixels": ("sample_pixels", {}),
        "it": ("focal_plane", {**CAMERA_SHEET, **params}),
    }
    bench = NodeBench(tmp_path, nodes)
    found = cautions(bench, "optics")
    assert len(found) == warned
    if warned and params:
        for words in ("(lens)", "7.5 to 12 µm", "7.7 to 9.3 µm", "cut_on_um = 7.7"):
            assert words in found[0].text
