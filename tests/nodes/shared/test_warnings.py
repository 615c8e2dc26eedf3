"""What modules warn of: each warning with values that bring it about, and with sound ones."""

import numpy as np
import pytest

from core.modules.declaration import declaration
from node_bench import NodeBench, square_detectors
from nodes.library import standard_library

LIBRARY = standard_library()
SCENE = {"width": 16, "height": 16, "fov_x_deg": 1.0, "cut_on_um": 8.0, "cut_off_um": 12.0}
INIT = square_detectors(
    20.0, 100.0, 2.0, range_m=1000.0, velocity_m_per_s=50.0, scan_velocity_mrad_per_s=900.0
)
SHARP = {"size_x": 64, "size_y": 64, "radius": 12.5}  # 50 mm where 64 samples are 12.8 cm
# Module and warning: parameters that bring it about, what the line says, and sound parameters.
# Those of `scene` and `init` are of these nodes; with `seen` the picture comes through a detector.
CASES = {
    ("electronics_noise", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 5.0, "bandwidth_Hz": 1e4},
        ("8 to 12 µm", "3 to 5 µm", "do not overlap"),
        {"cut_on_um": 8.0, "cut_off_um": 12.0, "bandwidth_Hz": 1e4},
    ),
    ("electronics_noise", "unit"): (
        {"scene": {"unit": "K"}, "bandwidth_Hz": 1e4},
        ("'K'", "NETD", "W/m²/sr", "To Radiance"),
        {"scene": {"unit": "W/m²/sr"}, "bandwidth_Hz": 1e4},
    ),
    ("electronics_noise", "scan"): (
        {"scan_mirror_rate_Hz": 16.0},
        ("1.005e+05 mrad/s", "900 mrad/s"),  # 2π·1000·16
        {"scan_mirror_rate_Hz": 16.0, "init": {"scan_velocity_mrad_per_s": 0.0}},
    ),
    ("veiling_glare", "unused"): (
        {"form": "harvey", "share_percent": 5.0},
        ("share_percent = 5 is not used", "harvey"),
        {"form": "harvey", "b_per_sr": 0.1},
    ),
    ("focal_plane", "unit"): (
        {"scene": {"unit": "K"}},
        ("'K'", "counting photons", "W/m²/sr", "To Radiance"),
        {"scene": {"unit": "W/m²/sr"}},
    ),
    ("focal_plane", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 12.0},
        ("3 to 12 µm", "8 to 12 µm", "extrapolated"),
        {"cut_on_um": 9.0, "cut_off_um": 12.0},
    ),
    ("focal_plane", "spectrum"): (
        {"scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}},
        ("0.4 µm", "5800 K", "photon_weighting to source"),
        {"scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}, "photon_weighting": "source"},
    ),
    ("spectral_response", "unit"): (
        {"scene": {"unit": "K"}},
        ("'K'", "radiance", "W/m²/sr"),
        {"scene": {"unit": "W/m²/sr"}},
    ),
    ("microbolometer", "unit"): (
        {"scene": {"unit": "K"}},
        ("'K'", "NETD", "W/m²/sr", "To Radiance"),
        {"scene": {"unit": "W/m²/sr"}},
    ),
    ("microbolometer", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 5.0},
        ("8 to 12 µm", "3 to 5 µm", "do not overlap"),
        {"cut_on_um": 8.0, "cut_off_um": 12.0},
    ),
    ("microbolometer", "aperture"): ({"f_number": 1.0}, ("f_number", "1", "2"), {"f_number": 2.0}),
    ("microbolometer", "settling"): (
        {"time_constant_s": 1.0, "frame_rate_Hz": 30.0},
        ("63 frames", "12 %"),  # exp(−63/30)
        {"time_constant_s": 0.1, "frame_rate_Hz": 30.0},
    ),
    ("nuc", "nothing"): ({}, ("nothing to correct", "Focal Plane"), {"method": "none"}),
    ("line_of_sight", "exposure"): (
        {"rms_x_mrad": 0.1, "integration_time_s": 0.02, "frame_rate_Hz": 100.0},
        ("0.02 s", "0.01 s", "overlap"),
        {"rms_x_mrad": 0.1, "integration_time_s": 0.01, "frame_rate_Hz": 100.0},
    ),
    ("tdi_mtf", "geometry"): (
        {"detector_um": 30.0},
        ("detector_um", "30 µm", "20 µm"),
        {"detector_um": 20.0},
    ),
    ("tdi_mtf", "apart"): (
        {"stages": 100, "velocity_mismatch_percent": 3.0},
        ("100 stages", "3 pixels"),
        {"stages": 100, "velocity_mismatch_percent": -2.0},
    ),
    ("exit_pupil", "map_unused"): (
        {"wavefront_path": "opd.txt"},
        ("wavefront_path", "clear"),
        {"shape": "clear"},
    ),
    ("exit_pupil_mtf", "band"): (
        {"cut_on_um": 4.0, "cut_off_um": 4.0, "size_x_cm": 12.8},
        ("4 µm", "8 to 12 µm"),
        {"cut_on_um": 10.0, "cut_off_um": 10.0, "size_x_cm": 12.8},
    ),
    ("exit_pupil_mtf", "aperture"): (
        {"size_x_cm": 25.6},
        ("100 mm wide", "F/1,", "F/2"),
        {"size_x_cm": 12.8},
    ),
    ("figures_of_merit", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 5.0},
        ("8 to 12 µm", "3 to 5 µm"),
        {},
    ),
    ("figures_of_merit", "unit"): ({"scene": {"unit": "DN"}}, ("'DN'", "MRTD"), {}),
    ("image_quality", "band"): (
        {},
        ("8 to 12 µm", "visible", "Figures of Merit"),
        {"snr_of": "mean", "scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}},
    ),
    ("image_quality", "contrast"): (
        {"scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}},
        ("15 %", "8/15", "snr_of"),
        {"snr": 50, "scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}},
    ),
    ("image_quality", "view"): (
        {"elevation_deg": 40, "off_nadir_deg": 20, "snr": 50},
        ("off_nadir_deg = 20°", "elevation_deg = 40°"),
        {"elevation_deg": 40, "snr": 50, "scene": {"cut_on_um": 0.4, "cut_off_um": 0.8}},
    ),
    ("poisson_noise", "unit"): (
        {"mode": "photon", "photons_per_unit": 1e3, "scene": {"unit": "K"}},
        ("'K'", "photons_per_unit"),
        {"mode": "photon", "photons_per_unit": 1e3, "scene": {"unit": "DN"}},
    ),
    ("poisson_noise", "scale"): (
        {"percent": 2.0},
        ("'W/m²/sr'", "the 1996 model", "Focal Plane"),
        {"percent": 0.0},
    ),
    ("examine_image", "no_temperature"): (
        {"scene": {"unit": "counts"}},
        ("'counts'", "W/m²/sr"),
        {"scene": {"unit": "K"}},
    ),
    ("atmosphere_mtf", "wavelength"): (
        {"turbulence": "long_exposure", "fried_r0_m": 0.1, "wavelength_um": 0.55},
        ("0.55 µm", "8 to 12 µm"),
        {"turbulence": "long_exposure", "fried_r0_m": 0.1, "wavelength_um": 9.0},
    ),
    ("atmosphere_mtf", "aperture"): (
        {"turbulence": "short_exposure", "fried_r0_m": 0.1, "aperture_mm": 80.0},
        ("80 mm", "50 mm"),
        {"turbulence": "short_exposure", "fried_r0_m": 0.1, "aperture_mm": 51.0},
    ),
    ("detector_mtf", "geometry"): (
        {"detector_y_um": 30.0},
        ("detector_y_um", "30 µm", "20 µm"),
        {"detector_y_um": 20.0, "detector_x_um": 20.0},
    ),
    ("crosstrack_mtf", "velocity"): (
        {"scan_velocity_mrad_per_s": 700.0},
        ("700 mrad/s", "900 mrad/s"),
        {},
    ),
    ("alongtrack_mtf", "velocity"): (
        {"velocity_m_per_s": 70.0},
        ("70 m/s", "50 m/s"),
        {"velocity_m_per_s": 50.0},
    ),
    ("alongtrack_mtf", "distance"): ({"range_m": 500.0}, ("500 m", "1000 m"), {"range_m": 1000.0}),
    ("relative_motion_mtf", "distance"): ({"range_m": 500.0}, ("500 m", "1000 m"), {}),
    ("combine_pixels", "pixel_counted_twice"): (
        # 20 µm at 100 mm; 1° in 16 samples of 1.0908 mrad
        {"seen": {"detector_x_um": 200.0}, "factor_x": 2},
        ("Detector MTF (detector)", "2 mrad horizontally", "2.182 mrad", "averaged twice", "0.707"),
        {"factor_x": 2},
    ),
    ("sample_pixels", "pitch"): (
        {"seen": {}, "init": {"detector_x_um": 400.0}, "factor_x": 2.0, "factor_y": 1},
        ("factor_x = 2 samples", "3.667 samples", "pitch"),
        {"seen": {}, "init": {"detector_x_um": 400.0, "detector_y_um": 400.0}},
    ),
    ("sample_pixels", "no_average"): (
        {"factor_x": 2.0, "factor_y": 1.0},
        ("no Detector MTF", "Combine Pixels"),
        {"factor_x": 0.5, "factor_y": 1.0},
    ),
    ("camera", "aperture"): (
        {"focal_length_mm": 100.0, "aperture_mm": 40.0, "f_number": 2.0},
        ("f_number = 2 here", "2.5 from 100 mm / 40 mm"),
        {"focal_length_mm": 100.0, "aperture_mm": 50.0, "f_number": 2.0},
    ),
    ("camera", "field_of_view"): (
        {"pixels_x": 32, "pitch_um": 100.0, "focal_length_mm": 100.0},
        ("pixels_x = 32 at 1 mrad", "1.833°", "1°"),
        {"pixels_x": 8, "pixels_y": 8, "pitch_um": 218.166, "focal_length_mm": 100.0},
    ),
    ("camera", "pixel_shape"): (
        {"pitch_um": 300.0, "pitch_y_um": 450.0, "focal_length_mm": 100.0},
        ("ratio is 1 for", "1.5 for the pixels"),
        {"pitch_um": 300.0, "pitch_y_um": 301.0, "focal_length_mm": 100.0},
    ),
    ("camera", "pixels"): (
        {"pitch_um": 15.0, "focal_length_mm": 100.0},
        ("1.091 mrad", "0.15 mrad", "coarser than"),
        {"pitch_um": 25.0, "focal_length_mm": 10.0},
    ),
    ("diffraction_mtf", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 5.0, "source_K": 300.0},
        ("4 µm", "8 to 12 µm"),
        {"cut_on_um": 9.0, "cut_off_um": 11.0},
    ),
    ("diffraction_mtf", "aperture"): (
        {"aperture_mm": 40.0},
        ("aperture_mm = 40 mm here", "50 mm from focal length"),  # 100 mm at F/2
        {"aperture_mm": 51.0},
    ),
    ("diffraction_mtf", "kelvin"): (
        {"scene": {"unit": "K"}},
        ("in kelvin", "To Radiance"),
        {"scene": {"unit": "W/m²/sr"}},
    ),
    ("to_radiance", "band"): (
        {"scene": {"unit": "K"}, "cut_on_um": 3.0, "cut_off_um": 5.0},
        ("8 to 12 µm", "3 to 5 µm"),
        {"scene": {"unit": "K"}},
    ),
    ("to_temperature", "band"): (
        {"cut_on_um": 3.0, "cut_off_um": 5.0},
        ("8 to 12 µm", "3 to 5 µm"),
        {},
    ),
    ("init_trans", "field_of_view"): (
        {"fov_x_deg": 3.0},
        ("fov_x_deg", "3 deg", "1 deg"),
        {"fov_x_deg": 1.0},
    ),
}


@pytest.fixture
def planned(tmp_path):
    """The node planned behind a scene, Init & Trans and a pupil, all of which agree."""
    np.save(tmp_path / "frame.npy", np.full((16, 16), 40.0))

    def plan(key, params):
        params = dict(params)
        scene = ("test_scene", {"kind": "uniform", "fov_y_deg": 1.0, **SCENE})
        of_file = params.pop("scene", None)
        seen = params.pop("seen", None)
        if of_file is not None:
            size = {name: SCENE[name] for name in ("fov_x_deg", "cut_on_um", "cut_off_um")}
            scene = ("read_image", {"path": "frame.npy", "fov_y_deg": 1.0, **size, **of_file})
        nodes = {
            "scene": scene,
            "init": ("init_trans", {**INIT, **params.pop("init", {})}),
            "pupil": ("exit_pupil", SHARP),
        }
        if seen is not None:
            nodes |= {"detector": ("detector_mtf", seen), "back": ("back_transform", {})}
        found = NodeBench(tmp_path, {**nodes, "node": (key, params)}).plan
        assert found.errors() == []
        return found

    return plan


def told(plan, check):
    return [each for each in plan.nodes["node"].warnings if each.check == check]


@pytest.mark.parametrize(("key", "check"), CASES, ids=map(".".join, CASES))
def test_it_is_told_with_its_values(planned, key, check):
    wrong, fragments, sound = CASES[key, check]
    (caution,) = told(planned(key, wrong), check)
    for fragment in fragments:
        assert fragment in caution.text
    assert caution.node == "node"
    assert [str(each) for each in planned(key, sound).warnings()] == []


@pytest.mark.parametrize("key", sorted(LIBRARY))
def test_declared_as_contracted(key):
    described = declaration(LIBRARY[key])
    inputs = {port.name for port in described.inputs}
    taken = {each.name for each in (*described.parameters, *described.readouts)}
    for name, meaning, needs in described.warnings:
        assert meaning.endswith("."), name
        assert {*needs} <= inputs | {"outputs", "given"}, name
        assert name not in taken
