"""``imagechain solve``: the value at which a read-out is as wanted, against closed forms."""

import math
import re

import pytest

CAMERA = {  # camera-shared-0 of the reference, without the optics' own emission
    "integration_time_s": 0.004, "quantum_efficiency": 0.7, "optics_transmission": 0.765,
    "read_noise_e": 400.0, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip
SIGNAL_E_PER_S = 453078.91635770707839 / 0.004
RESPONSE_E_PER_K_S = 17260.089407696938714 / 0.004
CONSTANT = 400.0**2 + 123.34285186862541511**2  # read noise and rounding


@pytest.fixture
def camera(small, write):
    small["nodes"]["scene"]["params"] |= {
        "kind": "uniform", "temperature_K": 293.15, "cut_on_um": 3.7, "cut_off_um": 4.8,
        "width": 8, "height": 6,
    }  # fmt: skip
    small["nodes"]["init"]["params"] |= {
        "detector_x_um": 15.0, "detector_y_um": 15.0, "fill_x": 0.9025, "f_number": 4.0,
        "platform": "array",
    }  # fmt: skip
    small["nodes"]["fpa"] = {"module": "focal_plane", "params": CAMERA}
    small["links"] += [["init.context", "fpa.context"], ["scene.image", "fpa.image"]]
    return write(small)


def time_of(netd_K):
    """√(S·t + c)/(R·t) = NETD, solved for t."""
    a, b = (netd_K * RESPONSE_E_PER_K_S) ** 2, SIGNAL_E_PER_S
    return (b + math.sqrt(b * b + 4 * a * CONSTANT)) / (2 * a)


def solved(text):
    return float(re.search(r" = ([0-9.e+-]+)", text)[1])


def test_the_integration_time_at_which_netd_is_25_mk(works, camera):
    words = ("--for", "fpa.integration_time_s", "--until", "fpa.netd_K=0.025")
    done = works("solve", camera, *words, "--precision", "double")
    time = time_of(0.025)
    first = done.stdout.splitlines()[0]
    assert first.startswith("fpa.integration_time_s = ")
    assert first.endswith("fpa.netd_K = 0.025 K")
    assert solved(first) == pytest.approx(time, rel=2e-4)
    fill = re.search(r"fpa\.well_fill_percent  ([0-9.]+) %", done.stdout)
    assert float(fill[1]) == pytest.approx(100 * SIGNAL_E_PER_S * time / 7e6, rel=2e-4)


def test_no_value_does_it_and_what_the_ends_give(imagechain, camera):
    words = ("--for", "fpa.integration_time_s=0.001:0.01", "--until", "fpa.netd_K=0.001")
    done = imagechain("solve", camera, *words)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    ends = [
        math.sqrt(SIGNAL_E_PER_S * t + CONSTANT) / (RESPONSE_E_PER_K_S * t) for t in (0.001, 0.01)
    ]
    assert "no value of fpa.integration_time_s from 0.001 s to 0.01 s" in line
    assert "makes fpa.netd_K equal to 0.001 K" in line
    found = [float(text) for text in re.findall(r"([0-9.]+) K at", line)]
    assert found == pytest.approx(ends, rel=2e-3)


def test_of_several_solutions_the_one_nearest_to_the_present(works, small, write):
    """J0 of the vibration crosses the same value again and again as its amplitude grows."""
    small["nodes"]["shake"] = {"module": "vibration_mtf", "params": {"amplitude_x_mrad": 2.0}}
    small["links"] += [["init.context", "shake.context"], ["init.magnitude", "shake.magnitude"]]
    words = ("--for", "shake.amplitude_x_mrad=0.01:9", "--until", "shake.mtf_at_nyquist_x=0.1")
    done = works("solve", write(small), *words)
    first = done.stdout.splitlines()[0]
    assert "other solutions are near" in first
    from scipy.special import j0

    nyquist = 48 / math.radians(3.0) / 2000
    assert j0(2 * math.pi * solved(first) * nyquist) == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--for", "fpa.units", "--until", "fpa.netd_K=1"), "not a number that can be solved for"),
        (("--for", "fpa.read_noise_e", "--until", "fpa.netd=1"), "no such read-out"),
        (("--for", "fpa.read_noise_e", "--until", "fpa.netd_K=cold"), "must be a number, in K"),
        (("--for", "fpa.read_noise_e"), "--until"),
    ],
)  # fmt: skip
def test_what_cannot_be_solved_is_one_line(fails, camera, words, line):
    assert line in fails("solve", camera, *words)
