"""Line of Sight: frames shifted and blurred, as measured in the pictures."""

import numpy as np
import pytest

from core.chain.random_fields import at_frame
from node_bench import NodeBench

SIZE, FOV = 48, 2.75019742  # degrees: 1 mrad a sample
PARAMS = {"rms_x_mrad": 0.5, "rms_y_mrad": 0.25, "corner_Hz": 12.0, "integration_time_s": 0.02}


def bench_of(folder, params, *, edges="periodic", kind="siemens_star", more=None, size=SIZE):
    scene = {"kind": kind, "width": size, "height": size, "fov_x_deg": FOV * size / SIZE,
             "fov_y_deg": FOV * size / SIZE}  # fmt: skip
    nodes = {
        "scene": ("test_scene", scene),
        "init": ("init_trans", {"edges": edges}),
        "los": ("line_of_sight", params),
        "back": ("back_transform", {}),
        **(more or {}),
    }
    return NodeBench(folder, nodes)


def frame(bench, number):
    return bench.work.value(at_frame(bench.port("back.image").recipe, number))


def shift_and_mtf(bench, number):
    """Shifts across and along by the phase of the lowest waves, and the MTF at them."""
    scene = np.fft.fft2(bench.value("scene.image"))
    ratio = np.fft.fft2(frame(bench, number))[[0, 1], [1, 0]] / scene[[0, 1], [1, 0]]
    return -np.angle(ratio) / (2 * np.pi) * SIZE, np.abs(ratio)


def test_frames_are_shifted_by_the_motion_between_them(tmp_path):
    bench = bench_of(tmp_path, PARAMS)
    found = bench.readouts("los")
    shifts = np.array([shift_and_mtf(bench, 37 * number)[0] for number in range(300)])
    np.testing.assert_allclose(
        shifts[0], [found["shift_x_mrad"], found["shift_y_mrad"]], rtol=1e-5, atol=1e-6
    )
    for axis, name in enumerate("xy"):
        expected = found[f"between_{name}_mrad"]
        assert shifts[:, axis].std() == pytest.approx(expected, rel=4 / np.sqrt(600))
    assert abs(np.corrcoef(shifts.T)[0, 1]) < 4 / np.sqrt(300)


def test_a_frame_is_the_scene_moved_and_blurred(tmp_path):
    """The whole frame by hand: one Gaussian mean and one ramp over both axes."""
    bench = bench_of(tmp_path, PARAMS, size=47)
    found = bench.readouts("los")
    scene = np.fft.fft2(bench.value("scene.image"))
    frequency = np.fft.fftfreq(47)
    made = np.fft.fft2(bench.value("back.image"))
    ramp = np.exp(-2j * np.pi * (frequency * found["shift_x_mrad"]
                                 + frequency[:, np.newaxis] * found["shift_y_mrad"]))  # fmt: skip
    blur = made / (scene * ramp)
    strong = np.abs(scene) > 1e-6 * np.abs(scene).max()
    assert np.abs(blur.imag[strong]).max() < 1e-6
    assert np.all(blur.real[strong] < 1 + 1e-6)
    for axis, place in (("x", (0, 1)), ("y", (1, 0))):
        # A Gauss-Markov motion less the mean of the exposure, to the second order.
        a = 2 * np.pi * PARAMS["corner_Hz"] * PARAMS["integration_time_s"]
        variance = PARAMS[f"rms_{axis}_mrad"] ** 2 * (1 - 2 * (a - 1 + np.exp(-a)) / a**2)
        loss = 2 * np.pi**2 * variance / 47**2
        assert blur.real[place] == pytest.approx(1 - loss, abs=loss * (2e-3 + 2 * loss))


def test_the_mtf_at_nyquist_is_the_mean_over_the_exposure(tmp_path):
    found = bench_of(tmp_path, PARAMS).readouts("los")
    a = 2 * np.pi * PARAMS["corner_Hz"] * PARAMS["integration_time_s"]
    time = (np.arange(2000) + 0.5) / 2000
    mean = 2 * (a - 1 + np.exp(-a)) / a**2
    about = 1 + mean - 2 * (2 - np.exp(-a * time) - np.exp(-a * (1 - time))) / a
    for axis in "xy":
        variance = PARAMS[f"rms_{axis}_mrad"] ** 2 * about
        expected = np.mean(np.exp(-2 * np.pi**2 * variance * 0.5**2))
        assert found[f"mtf_at_nyquist_{axis}"] == pytest.approx(expected, abs=1e-4)


def test_a_frame_depends_on_its_number_alone(tmp_path):
    one, two = (bench_of(tmp_path, PARAMS, edges="reflect") for _ in range(2))
    third = frame(one, 3)
    for number in (1, 7, 3):
        again = frame(two, number)
    np.testing.assert_array_equal(third, again)
    assert not np.array_equal(third, frame(two, 4))


def test_a_spectrum_of_a_file(tmp_path):
    (tmp_path / "psd.csv").write_text("# gyro\nHz,x,y\n1,1e-2,4e-2\n100,1e-6,4e-6\n")
    params = {"psd_path": "psd.csv", "integration_time_s": 0.01}
    found = bench_of(tmp_path, params).readouts("los")
    for axis, scale in (("x", 1.0), ("y", 2.0)):  # 1e-2·f^-2 from 1 to 100 Hz
        whole = np.hypot(found[f"within_{axis}_mrad"], found[f"between_{axis}_mrad"])
        assert whole == pytest.approx(scale * np.sqrt(1e-2 * 0.99), rel=1e-4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,1\n", "1 point;"),
        ("1,1\n0.5,1\n", "line 2"),
        ("1,1\n2,-1\n", "line 2"),
        ("1,1\n2,1,1\n", "line 2"),
        ("1,1\nx,y\n", "line 2"),
        ("1,O.1\n2,1\n3,1\n", "line 1"),
        ('1,"' + "9" * 200_000 + '"\n2,1\n3,1\n', "line 1"),
    ],
)
def test_a_file_that_is_no_spectrum_is_refused(tmp_path, text, words):
    (tmp_path / "psd.csv").write_text(text)
    error = str(bench_of(tmp_path, {"psd_path": "psd.csv"}).error("los"))
    assert words in error
    assert "\n" not in error
