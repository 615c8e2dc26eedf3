"""Read-outs in the unit of the picture that comes in."""

import pytest


@pytest.mark.parametrize(("units", "unit"), [("dn", "DN"), ("radiance", "W/m²/sr")])
def test_figures_of_a_picture_have_its_unit(works, small, write, units, unit):
    """They had none, and those of 3-D Noise were of radiance, whatever came in."""
    small["nodes"]["scene"]["params"] |= {
        "kind": "uniform", "cut_on_um": 3.7, "cut_off_um": 4.8, "width": 16, "height": 12,
    }  # fmt: skip
    small["nodes"]["init"]["params"] |= {
        "detector_x_um": 15.0, "detector_y_um": 15.0, "f_number": 4.0, "platform": "array",
    }  # fmt: skip
    camera = {"integration_time_s": 1e-3, "read_noise_e": 50.0, "prnu_percent": 1.0, "units": units}
    small["nodes"] |= {
        "fpa": {"module": "focal_plane", "params": camera},
        "budget": {"module": "noise_budget"},
        "cube": {"module": "noise_3d", "params": {"frames": 0}},
        "look": {"module": "examine_image"},
        "nuc": {"module": "nuc", "params": {"reference_frames": 2}},
    }
    small["links"] += [
        ["init.context", "fpa.context"], ["scene.image", "fpa.image"],
        *(["fpa.image", f"{name}.image"] for name in ("budget", "cube", "look", "nuc")),
    ]  # fmt: skip
    done = works("run", write(small), "--all")
    rows = {tuple(line.split()[:2]): line.split() for line in done.stdout.splitlines() if line}
    for row in (("budget", "sigma"), ("cube", "temporal"), ("look", "mean"),
                ("nuc", "pattern_low")):  # fmt: skip
        assert rows[row][-1] == unit, row
