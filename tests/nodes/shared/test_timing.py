"""Times that do not fit together: exposure and frame, line and ground speed, stages typed twice."""

import pytest

from node_bench import NodeBench

SCENE = {"kind": "uniform", "width": 8, "height": 6, "fov_x_deg": 1.0, "fov_y_deg": 1.0,
         "cut_on_um": 3.7, "cut_off_um": 4.8, "temperature_K": 300.0}  # fmt: skip
INIT = {"detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
        "platform": "array", "range_m": 1000}  # fmt: skip


def cautions(folder, check, *, init=None, tdi=None, detector=("focal_plane", {}), merit=None):
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {**INIT, **(init or {})}),
        "stages": ("tdi_mtf", tdi or {"stages": 1}),
        "back": ("back_transform", {}),
        "it": (detector[0], {"optics_transmission": 0.8, **detector[1]}),
        "merit": ("figures_of_merit", merit or {}),
    }
    bench = NodeBench(folder, nodes)
    assert bench.plan.errors() == []
    return [caution.message for caution in bench.warnings() if caution.check == check]


def test_an_exposure_longer_than_a_frame(tmp_path):
    """20 ms at 200 Hz; 5 ms fill a frame and are fine, and a still frame has no rate."""
    long = ("focal_plane", {"integration_time_s": 0.02})
    (said,) = cautions(tmp_path, "timing", detector=long, merit={"frame_rate_Hz": 200})
    assert "integration_time_s is 20 ms, but a frame lasts 5 ms at frame_rate_Hz = 200 Hz" in said
    short = ("focal_plane", {"integration_time_s": 0.005})
    assert not cautions(tmp_path, "timing", detector=short, merit={"frame_rate_Hz": 200})
    assert not cautions(tmp_path, "timing", detector=long, merit={"frame_rate_Hz": None})


def test_two_frame_rates(tmp_path):
    bolometer = ("microbolometer", {"frame_rate_Hz": 60})
    (said,) = cautions(tmp_path, "timing", detector=bolometer, merit={"frame_rate_Hz": 30})
    assert "frame_rate_Hz = 30 Hz here but 60 Hz on Microbolometer" in said
    assert not cautions(tmp_path, "timing", detector=bolometer, merit={"frame_rate_Hz": 60})


@pytest.mark.parametrize(
    ("integration_time_s", "stages", "said"),
    [
        (1.5e-3, 1, False),  # 0.15 m of ground at 100 m/s
        (1.0e-3, 1, False),
        (2.0e-3, 1, True),
        (1.5e-3, 8, False),
        (1.0e-3, 8, True),  # charge that moves faster than the image
        (2.0e-3, 8, True),
    ],
)
def test_a_line_time_and_the_speed_over_the_ground(tmp_path, integration_time_s, stages, said):
    push = {"platform": "push", "velocity_m_per_s": 100.0}
    plane = {"integration_time_s": integration_time_s, "tdi_stages": stages}
    found = cautions(
        tmp_path, "line_time", init=push, tdi={"stages": stages}, detector=("focal_plane", plane)
    )
    assert bool(found) is said
    if said:
        assert "moves by one pixel (0.15 m across the line of sight) in 0.0015 s" in found[0]
