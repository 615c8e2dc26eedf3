"""Figures of Merit on chains whose noise and blur are known, and on noise that is drawn."""

import math

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from merit_sensor import FOV, INTERVAL, NYQUIST, sensor
from planck_truth import band_radiance


def table_of(*args, **kwargs):
    engine, plan, work = sensor(*args, **kwargs)
    return engine.value(plan, "merit.table", work).as_dict()


def curves_of(port, *args, **kwargs):
    engine, plan, work = sensor(*args, **kwargs)
    return {s.label: s for s in engine.value(plan, f"merit.{port}", work).series}


def slope(temperature_K):
    """dL/dT of Planck's law, by a difference."""
    up, down = (float(band_radiance(3.0, 5.0, temperature_K + d)) for d in (0.01, -0.01))
    return (up - down) / 0.02


def transfer(f, sigma):
    """Gaussian blur, and a detector of 80 µm/200 mm = 0.4 mrad."""
    return np.exp(-2 * np.pi**2 * sigma**2 * f**2) * np.sinc(0.4 * f)


def share(length, end):
    x = np.pi * length * (np.arange(20000) + 0.5) * end / 20000
    return float(np.mean((np.sin(x) / x) ** 2))


class TestNoise:
    def test_of_frames_drawn_anew(self):
        """Standard deviation of 40 frames' samples, without a fixed pattern."""
        frames = []
        for seed in range(40):
            engine, plan, work = sensor(seed=seed)
            frames.append(engine.value(plan, "noise.image", work))
        sigma = float(np.std(np.array(frames), axis=0, ddof=1).mean())
        mean = float(np.mean(frames))
        found = table_of()
        assert found["ner"] == pytest.approx(sigma, rel=0.01)
        assert found["snr"] == pytest.approx(mean / sigma, rel=0.01)
        assert found["netd_K"] == pytest.approx(sigma / slope(300.0), rel=0.01)
        assert found["background_K"] == pytest.approx(300.0, rel=1e-3)
        for name in ("vh", "v", "h"):
            assert found[f"sigma_{name}_K"] == 0


class TestMrtd:
    @pytest.mark.parametrize("model", ["ratches_1976", "flir92"])
    @pytest.mark.parametrize(("axis", "sigma"), [("x", 0.2), ("y", 0.1)])
    def test_at_half_of_nyquist(self, model, axis, sigma):
        """(π²/8)·2.5·NETD·√(left)/H at 0.573 cycles/mrad, with 25 frames/s and 0.2 s."""
        found = table_of({"model": model, "frame_rate_Hz": 25.0})
        f = NYQUIST / 2
        over_width = share(0.5 / f, NYQUIST)
        over_length = INTERVAL * 2 * f / 7 if model == "ratches_1976" else share(3.5 / f, NYQUIST)
        noise = found["netd_K"] if model == "ratches_1976" else found["sigma_tvh_K"]
        left = over_width * over_length * noise**2 / 5
        if model == "flir92":  # what little of the noise is the same in a whole column or row
            lines = found["sigma_th_K" if axis == "x" else "sigma_tv_K"] ** 2
            left += over_width * lines / 5
        truth = math.pi**2 / 8 * 2.5 * math.sqrt(left) / transfer(f, sigma)
        assert found[f"mrtd_{axis}_50_percent_nyquist"] == pytest.approx(truth, rel=1e-4)

    @pytest.mark.parametrize(
        ("platform", "scanning", "ends"),
        [
            ("array", "automatic", ("horizontal", "vertical")),
            ("line", "automatic", ("vertical",)),
            ("push", "automatic", ("horizontal",)),
            ("line", "staring", ("horizontal", "vertical")),
            ("array", "parallel_scan", ("vertical",)),
            ("push", "serial_scan", ("vertical",)),
            ("push", "staring", ("horizontal", "vertical")),
        ],
    )
    def test_sampled_directions_end_at_nyquist(self, platform, scanning, ends):
        """One detector scans along x; several along the flight of a push, else along x."""
        curves = curves_of("mrtd", {"scanning": scanning}, init={"platform": platform})
        for label in ("horizontal", "vertical"):
            last = curves[label].x[-1]
            if label in ends:
                assert last < NYQUIST
                assert last == pytest.approx(NYQUIST, rel=0.01)
            else:
                assert last == pytest.approx(2 * NYQUIST, rel=0.01)

    def test_ratches_ends_at_the_detectors_zero(self):
        """A detector of 0.8 mrad has its zero at 1.25 cycles/mrad, above Nyquist at 1.146."""
        large = {"detector_x_um": 160.0}
        curves = curves_of("mrtd", {"model": "ratches_1976"}, init=large)
        assert NYQUIST < curves["horizontal"].x[-1] < 1.25
        assert curves["vertical"].x[-1] > 2


def test_mdtd_of_a_large_target():
    """Ten samples wide: SNR_th·NETD·share/√6, less what the blur takes over the border."""
    curve = curves_of("mdtd")["square target"]
    size = curve.x[np.argmin(np.abs(curve.x - 10 * INTERVAL))]
    f = (np.arange(40000) + 0.5) * 1e-3
    intensity = [
        2e-3 * size * float(np.sum(np.sinc(size * f) ** 2 * transfer(f, sigma)))
        for sigma in (0.2, 0.1)
    ]
    found = table_of()
    over = share(size, NYQUIST)
    left = over**2 * found["sigma_tvh_K"] ** 2
    left += over * (found["sigma_th_K"] ** 2 + found["sigma_tv_K"] ** 2)
    truth = 2.5 * math.sqrt(left / 6) / (intensity[0] * intensity[1])
    assert np.interp(size, curve.x, curve.y) == pytest.approx(truth, rel=1e-4)


class TestAcquisition:
    @pytest.mark.parametrize("task", ["detection", "recognition", "identification"])
    def test_half_succeed_at_the_range(self, task):
        curves = curves_of("probability", {"range_max_km": 8.0})
        km = table_of()[f"{task}_range_km"]
        assert np.interp(km, curves[task].x, curves[task].y) == pytest.approx(0.5, abs=0.01)

    @pytest.mark.parametrize("extinction", [0.0, 3.0])
    def test_range_resolves_n50_cycles(self, extinction):
        """At it 2.3 m span N50 cycles of the frequency at which the MRTD is what is left of 2 K."""
        settings = {"extinction_per_km": extinction}
        km = table_of(settings)["recognition_range_km"]
        curve = curves_of("mrtd", settings)["2-D"]
        left = 2.0 * math.exp(-extinction * km)
        resolved = np.exp(np.interp(math.log(left), np.log(curve.y), np.log(curve.x)))
        assert resolved * 2.3 / km == pytest.approx(3.0, rel=1e-3)

    @pytest.mark.parametrize("amplifier_snr", [100.0, 8.0])
    def test_the_published_ttp_by_a_plain_sum(self, amplifier_snr):
        """CTF_eye/MTF·√(1 + (169.6·σ/S)²); white noise through channel and eyeball, summed plainly.

        30 frames a second: σ² is that of a frame, over 30 Hz.
        """
        noise = {"amplifier_snr": amplifier_snr}
        form = {"ttp_threshold": "system_contrast_threshold", "v50": 5.0}
        found = table_of(form, noise=noise)
        variance = sum(found[f"sigma_{name}_K"] ** 2 for name in ("tvh", "t", "tv", "th")) / 30.0
        magnification = 15 / FOV
        fine = (np.arange(20000) + 0.5) * NYQUIST / 20000
        pupil = -9.011 + 13.23 * math.exp(-math.log10(34 / 3.4262590996) / 21.082)
        f0 = math.exp(3.663 - 0.0216 * pupil**2 * math.log(pupil))
        i0 = (0.7155 + 0.277 / math.sqrt(pupil)) ** 2
        at_eye = fine / magnification
        ball = np.exp(-((43.69 * at_eye / f0) ** i0) - 0.375 * at_eye**1.21 - 0.4441 * at_eye**2)
        mrtd = curves_of("mrtd", noise=noise)  # as far as anything is resolved
        sums, grains = [], []
        for label, sigma in (("horizontal", 0.2), ("vertical", 0.1)):
            f = np.linspace(mrtd[label].x[0], mrtd[label].x[-1], 2001)
            channel = np.array(
                [np.mean(np.exp(-4.4 * np.log(fine / one) ** 2) * ball**2) for one in f]
            )
            grain = 169.6**2 * variance * channel * np.mean(ball**2) / 5.0**2
            u = f * 17.453293 / magnification
            a = 540 * (1 + 0.7 / 34) ** -0.2 / (1 + 12 / (15 * (1 + u / 3) ** 2))
            b = 0.3 * (1 + 100 / 34) ** 0.15
            eye = 1 / (a * u * np.exp(-b * u) * np.sqrt(1 + 0.06 * np.exp(b * u)))
            threshold = eye / transfer(f, sigma) * np.sqrt(1 + grain)
            sums.append(np.sqrt(0.163746 / threshold) * (threshold < 0.163746))
            grains.append(grain.max())
        assert max(grains) > 0.3  # noise counts
        v = 2.3 * math.sqrt(np.prod([np.sum(each[1:]) * (f[1] - f[0]) for each in sums]))
        ratio = v / 5.0
        exponent = 1.51 + 0.24 * ratio
        truth = ratio**exponent / (1 + ratio**exponent)
        how = {**form, "range_max_km": 1.0}
        curve = curves_of("probability", how, noise=noise)["TTP"]
        assert curve.y[-1] == pytest.approx(truth, rel=3e-3)
        other = curves_of("probability", {**how, "ttp_threshold": "mrtd"}, noise=noise)["TTP"]
        assert other.y[-1] != pytest.approx(truth, rel=1e-2)


def test_a_new_task_keeps_the_thresholds():
    _, plan, _ = sensor()
    _, other, _ = sensor({"n50_detection": 2.0, "target_size_m": 5.0})
    before, after = plan.nodes["merit"].outputs, other.nodes["merit"].outputs
    for port, same in (("mrtd", True), ("mdtd", True), ("probability", False), ("table", False)):
        assert (before[port].key == after[port].key) is same


def test_read_outs_are_the_tables():
    engine, plan, work = sensor()
    shown = engine.readouts(plan, "merit", work)
    table = engine.value(plan, "merit.table", work).as_dict()
    assert shown["netd_K"] == table["netd_K"]
    assert shown["mrtd_x_K"] == table["mrtd_x_50_percent_nyquist"]
    assert shown["ttp_range_km"] == table["ttp_range_km"]


@pytest.mark.parametrize(
    ("merit", "error", "text"),
    [
        ({"background_K": 1.0}, DataError, "emits nothing"),
        ({"cut_on_um": 6.0}, ParameterError, "at least cut_on_um"),
        ({"snr_threshold": 0.0}, ParameterError, "above 0"),
    ],
)
def test_refused(merit, error, text):
    engine, plan, work = sensor(merit)
    fault = next(iter(plan.errors()), None)
    if fault is None:
        with pytest.raises(error) as caught:
            engine.value(plan, "merit.table", work)
        fault = caught.value
    assert (type(fault), fault.exit_code) == (error, 2)
    assert text in str(fault)


VISIBLE = {"cut_on_um": 0.4, "cut_off_um": 0.8, "temperature_K": 1250.0}


def test_reflected_light_is_refused():
    """Its brightness temperature of 1250 K would be nobody's."""
    _, plan, _ = sensor(scene=VISIBLE, noisy=False)
    assert [str(error) for error in plan.errors()] == [
        "merit: the band begins at 0.4 µm, where the signal is reflected light, which has no "
        "temperature. NETD, MRTD, MDTD and the ranges derived from them do not apply. Use Image "
        "Quality, or give background_K for a scene hot enough to emit in this band"
    ]
