"""TDI MTF: a picture against the mean of its shifted exposures."""

import numpy as np
import pytest

from node_bench import NodeBench

SIZE, FOV = 60, 3.43774677  # degrees: 1 mrad a sample
INIT = {"edges": "periodic", "detector_y_um": 400, "detector_x_um": 200, "focal_length_mm": 100}


def bench_of(folder, params, init=INIT):
    scene = {"kind": "siemens_star", "width": SIZE, "height": SIZE, "fov_x_deg": FOV,
             "fov_y_deg": FOV}  # fmt: skip
    nodes = {"scene": ("test_scene", scene), "init": ("init_trans", init),
             "tdi": ("tdi_mtf", params), "back": ("back_transform", {})}  # fmt: skip
    return NodeBench(folder, nodes)


@pytest.mark.parametrize("direction", ["y", "x"])
@pytest.mark.parametrize("phases", [2, 0])
def test_an_image_askew_is_the_mean_of_exposures_shifted_both_ways(tmp_path, direction, phases):
    """At 10° of yaw and +5 % the image moves by 1.05·(cos 10°, sin 10°) while the charge steps."""
    pitch = 4.0 if direction == "y" else 2.0
    params = {"stages": 6, "phases": phases, "velocity_mismatch_percent": 5.0, "yaw_deg": 10.0,
              "direction": direction}  # fmt: skip
    bench = bench_of(tmp_path, params)
    scene, found = bench.value("scene.image"), bench.value("back.image")
    steps, instants = (12, 100) if phases else (1200, 1)
    time = (np.arange(steps * instants) + 0.5) / (steps * instants) * 6  # pitches of the charge
    charge = np.floor(time * phases) / phases if phases else time
    along = 1.05 * np.cos(np.radians(10)) * time - charge
    across = 1.05 * np.sin(np.radians(10)) * time
    along, across = ((way - 0.5 * (way[0] + way[-1])) * pitch for way in (along, across))
    fy, fx = np.meshgrid(np.fft.fftfreq(SIZE), np.fft.fftfreq(SIZE), indexing="ij")
    f_along, f_across = (fy, fx) if direction == "y" else (fx, fy)
    waves = [np.exp(-2j * np.pi * (f_along * a + f_across * b))
             for a, b in zip(along, across, strict=True)]  # fmt: skip
    expected = np.mean(waves, axis=0)
    assert np.abs(expected.imag).max() < 1e-12
    inner = (np.abs(fx) < 0.5) & (np.abs(fy) < 0.5)  # Nyquist's waves have no place to move to
    spectrum = (np.fft.fft2(scene) * expected)[inner]
    seen = np.fft.fft2(found)[inner]
    np.testing.assert_allclose(seen, spectrum, atol=1e-6 * np.abs(spectrum).max())
    readouts = bench.readouts("tdi")
    assert readouts["drift_across_px"] == pytest.approx(1.05 * np.sin(np.radians(10)))
    assert readouts["mismatch_percent"] == pytest.approx(
        100 * (1.05 * np.cos(np.radians(10)) - 1), rel=1e-12
    )


def test_the_line_rate_gives_the_mismatch(tmp_path):
    """7000 m/s at 600 km is 11.667 mrad/s; at 3 lines/s of 4 mrad the charge moves 12 mrad/s."""
    init = {**INIT, "velocity_m_per_s": 7000, "range_m": 6e5}
    bench = bench_of(tmp_path, {"line_rate_Hz": 3.0, "stages": 10}, init)
    found = bench.readouts("tdi")
    assert found["mismatch_percent"] == pytest.approx(100 * (7000 / 6e5 * 1e3 / 12 - 1), rel=1e-12)
    assert found["drift_mrad"] == pytest.approx(40 * found["mismatch_percent"] / 100, rel=1e-12)
    error = str(bench_of(tmp_path, {"line_rate_Hz": 3.0}).error("tdi"))
    assert "velocity_m_per_s = 0" in error


def test_figures(tmp_path):
    params = {"stages": 10, "phases": 4, "velocity_mismatch_percent": -7.0, "detector_um": 300,
              "focal_length_mm": 150}  # fmt: skip
    found = bench_of(tmp_path, params).readouts("tdi")
    assert found["step_mrad"] == pytest.approx(0.93 * 2.0 / 4)
    assert found["drift_mrad"] == pytest.approx(-1.4)
    assert found["mtf_at_nyquist_x"] == 1.0
    # sin(πNx)/(N·sin(πx)) with N = 40 and x = −0.07·0.5·0.5.
    shifts = np.sin(40 * np.pi * -0.0175) / (40 * np.sin(np.pi * -0.0175))
    assert found["mtf_at_nyquist_y"] == pytest.approx(np.sinc(0.93 * 0.5 * 0.5) * shifts, rel=1e-6)


def test_the_pitch_of_init_and_trans(tmp_path):
    assert bench_of(tmp_path, {"phases": 1}).readouts("tdi")["step_mrad"] == pytest.approx(4.0)
    error = str(bench_of(tmp_path, {}, {"focal_length_mm": 100}).error("tdi"))
    assert "detector_y_um" in error


def test_warnings(tmp_path):
    def found(params, init=INIT):
        bench = bench_of(tmp_path, params, init)
        return [caution.message for caution in bench.plan.checks() if caution.node == "tdi"]

    assert "a yaw of 2°" in found({"stages": 100, "yaw_deg": 2.0})[0]
    moving = {"line_rate_Hz": 3.0, "velocity_mismatch_percent": 1.0}
    (unused,) = found(moving, {**INIT, "velocity_m_per_s": 7200, "range_m": 6e5})
    assert "velocity_mismatch_percent = 1 % is not used" in unused
