"""Figures of Merit on chains whose noise and blur are known, and on noise that is drawn."""

import math
import warnings

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from linked_network import linked_network
from node_bench import NodeBench, square_detectors
from planck_truth import band_radiance

FOV = 2.0  # degrees in 80 samples: 0.4363 mrad
INTERVAL = math.radians(FOV) * 1000 / 80
NYQUIST = 0.5 / INTERVAL
SCENE = {
    "kind": "uniform", "width": 80, "height": 80, "fov_x_deg": FOV, "fov_y_deg": FOV,
    "cut_on_um": 3.0, "cut_off_um": 5.0, "temperature_K": 300.0,
}  # fmt: skip
INIT = square_detectors(80.0, 200.0, 2.0, range_m=400.0, platform="array")
NOISE = {
    "region": "MWIR", "d_star": 1e12, "material": "manual", "bandwidth_Hz": 3e5,
    "amplifier_snr": 100.0,
}  # fmt: skip


def sensor(merit=None, *, scene=None, init=None, noise=None, noisy=True, seed=1, air=()):
    """`air`: parameters of Atmospheric Paths one after the other, behind the scene."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        **{f"air{number}": ("atmospheric_path", path) for number, path in enumerate(air)},
        "init": ("init_trans", {**INIT, **(init or {})}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.1}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        **({"noise": ("electronics_noise", {**NOISE, **(noise or {})})} if noisy else {}),
        "merit": ("figures_of_merit", merit or {}),
    }
    return NodeBench(None, linked_network(nodes, seed=seed))


def table_of(*args, **kwargs):
    return sensor(*args, **kwargs).value("merit.table").as_dict()


def curves_of(port, *args, **kwargs):
    return {s.label: s for s in sensor(*args, **kwargs).value(f"merit.{port}").series}


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
        frames = [sensor(seed=seed).value("noise.image") for seed in range(40)]
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
                assert last == pytest.approx(NYQUIST, rel=1e-12)
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
    bench, other = sensor(), sensor({"n50_detection": 2.0, "target_size_m": 5.0})
    for port, same in (("mrtd", True), ("mdtd", True), ("probability", False), ("table", False)):
        before, after = (one.port(f"merit.{port}") for one in (bench, other))
        assert (before.key == after.key) is same


def test_read_outs_are_the_tables():
    bench = sensor()
    shown = bench.readouts("merit")
    table = bench.value("merit.table").as_dict()
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
    bench = sensor(merit)
    fault = next(iter(bench.plan.errors()), None)
    if fault is None:
        with pytest.raises(error) as caught:
            bench.value("merit.table")
        fault = caught.value
    assert (type(fault), fault.exit_code) == (error, 2)
    assert text in str(fault)


VISIBLE = {"cut_on_um": 0.4, "cut_off_um": 0.8, "temperature_K": 1250.0}


def test_reflected_light_is_refused():
    """Its brightness temperature of 1250 K would be nobody's."""
    bench = sensor(scene=VISIBLE, noisy=False)
    assert [str(error) for error in bench.plan.errors()] == [
        "merit: the band begins at 0.4 µm, where the signal is reflected light, which has no "
        "temperature. NETD, MRTD, MDTD and the ranges derived from them do not apply. Use Image "
        "Quality, or give background_K for a scene hot enough to emit in this band"
    ]


# --- Figures of Merit: extremes, and ranges through air ---


MERIT = [
    {"frame_rate_Hz": None},
    {"eye_integration_s": 10.0, "frame_rate_Hz": 1e6},
    {"background_K": 2.0},
    {"background_K": 10.0},
    {"background_K": 20.0},
    {"background_K": 1e6},
    {"cut_on_um": 0.4, "cut_off_um": 0.5},
    {"target_delta_K": -2.0},
    {"target_delta_K": 0.0},
    {"target_delta_K": 1e4, "extinction_per_km": 0.0},
    {"target_size_m": 1e6},
    {"target_size_m": 1e-9},
    {"extinction_per_km": 1e6},
    {"range_max_km": 1e-12},
    {"range_max_km": 1e6},
    {"range_max_km": 0.0},
    {"eye_limit_mrad": 1e-9},
    {"mdtd_window": "image"},
    {"magnification": 1e6},
    {"magnification": 1e-6},
    {"display_cd_m2": 1e-300},
    {"scene_contrast_K": 1e-300},
    {"v50": 1e-300},
    {"n50_detection": 1e-300},
    {"snr_threshold": 1e-300},
]
BOOST = {
    "post_filter": "boost", "post_corner_Hz": 60.0, "post_gain": 30.0, "scan_mirror_rate_Hz": 0.02,
}  # fmt: skip
SENSORS = [
    {"noisy": False},
    {"noise": {"gain_percent": 1e5}},
    {"noise": {"amplifier_snr": None, "bits": 4, "d_star": 1e30}},
    {"noise": {**BOOST, "bandwidth_Hz": 3e5}},
    {"noise": {**BOOST, "post_filter": "highpass"}},
    {"scene": {"height": 24, "fov_y_deg": 3.0}},
    {"scene": {"width": 3, "height": 3, "fov_x_deg": 3 * FOV / 80, "fov_y_deg": 3 * FOV / 80}},
    {"scene": {"height": 1, "fov_y_deg": FOV / 80}},
    {"scene": {"temperature_K": 30.0}},
    {"init": {"detector_x_um": 400.0}},
    {"init": {"detector_x_um": 40000.0, "detector_y_um": 40000.0}},
    {"init": {"detector_x_um": 4e6}},
    {"init": {"platform": "line"}, "noise": {"gain_percent": 3.0}},
    {"init": {"platform": "push"}, "noise": {"gain_percent": 3.0}},
]
REFUSED = [
    ({"background_K": 2.0}, {}),  # emits nothing
    ({"background_K": 10.0}, {}),  # next to nothing
    ({}, {"scene": {"height": 1, "fov_y_deg": FOV / 80}}),  # no rows to compare
    # A high pass leaves no mean to be the radiance of a background.
    ({}, {"noise": {**BOOST, "post_filter": "highpass"}}),
]


@pytest.mark.thorough(but=39)
@pytest.mark.parametrize("model", ["flir92", "ratches_1976"])
@pytest.mark.parametrize(
    ("merit", "given"), [*((each, {}) for each in MERIT), *(({}, each) for each in SENSORS)]
)
def test_numbers_or_one_line(model, merit, given):
    bench = sensor({**merit, "model": model}, **given)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if (merit, given) in REFUSED:
            with pytest.raises(DataError) as caught:
                bench.value("merit.table")
            assert "\n" not in str(caught.value)
            return
        table = bench.value("merit.table").as_dict()
        curves = [bench.value(f"merit.{port}") for port in ("mrtd", "mdtd", "probability")]
    assert all(value is None or np.isfinite(value) for value in table.values())
    for curve in curves:
        for series in curve.series:
            assert np.isfinite(series.x).all()
            assert np.isfinite(series.y).all()
            assert (np.diff(series.x) > 0).all(), series.label
    for series in curves[2].series:
        assert ((series.y >= 0) & (series.y <= 1)).all()
        assert (np.diff(series.y) <= 1e-12).all()


PATH = {
    "model": "visibility_km", "visibility_km": 4.0, "angstrom_q": 1.1, "range_m": 300.0,
    "air_K": 300.0,
}  # fmt: skip
TASKS = {"detection": 0.75, "recognition": 3.0, "identification": 6.0}
RANGES = [*(f"{task}_range_km" for task in TASKS), "ttp_range_km"]


def evaluated(merit=None, air=(), **changes):
    bench = sensor(merit, air=air, **changes)
    assert bench.plan.errors() == []
    curves = {one.label: one for one in bench.value("merit.mrtd").series}
    table = bench.value("merit.table").as_dict()
    return table, curves, [str(one) for one in bench.plan.warnings() if one.node == "merit"]


def left_of_difference(km, background_K, visibility_km=4.0, q=1.1):
    """∫τ(λ, R)·dL/dT dλ over ∫dL/dT dλ from 3 to 5 µm, as a sum of 20 000 midpoints."""
    um = 3 + 2 * (np.arange(20000) + 0.5) / 20000
    x = 14387.768775039338 / (um * background_K)
    slope = um**-6 * np.exp(x) / np.expm1(x) ** 2
    passed = np.exp(-3.912 / visibility_km * (0.55 / um) ** q * km)
    return float((passed * slope).sum() / slope.sum())


def bisected_km(curve, delta_K, cycles, left, size_m=2.3):
    """Where the apparent difference is the MRTD at the frequency of that many cycles."""
    near, far = 1e-3, 1e3
    for _ in range(80):
        middle = math.sqrt(near * far)
        frequency = cycles / (size_m / middle)  # a metre at a km is a mrad
        beyond = frequency > curve.x[-1]
        needed = np.exp(np.interp(np.log(frequency), np.log(curve.x), np.log(curve.y)))
        near, far = (near, middle) if beyond or left(middle) * delta_K < needed else (middle, far)
    return near


def test_johnson_ranges_by_bisection():
    table, curves, _ = evaluated({"target_delta_K": 0.1}, air=[PATH])
    background = table["background_K"]
    assert background == pytest.approx(300.0, abs=0.01)  # through air as warm as the scene
    for task, cycles in TASKS.items():
        expected = bisected_km(
            curves["2-D"], 0.1, cycles, lambda km: left_of_difference(km, background)
        )
        assert table[f"{task}_range_km"] == pytest.approx(expected, rel=1e-7)
    clear, _, _ = evaluated({"target_delta_K": 0.1, "extinction_per_km": 0.0})
    assert table["detection_range_km"] < 0.9 * clear["detection_range_km"]


@pytest.mark.parametrize("form", ["mrtd", "system_contrast_threshold"])
def test_the_ttp_range_is_that_of_the_extinction_there(form):
    """At its own range a haze has an extinction −ln τ(R)/R, which typed in gives the same range."""
    merit = {"ttp_threshold": form, "target_delta_K": 0.1, "v50": 8.0}
    table, _, _ = evaluated(merit, air=[PATH])
    km = table["ttp_range_km"]
    extinction = -math.log(left_of_difference(km, table["background_K"])) / km
    typed, _, _ = evaluated({**merit, "extinction_per_km": extinction})
    assert typed["ttp_range_km"] == pytest.approx(km, rel=1e-5)
    assert km < 0.99 * evaluated({**merit, "extinction_per_km": 0.0})[0]["ttp_range_km"]


@pytest.mark.parametrize(
    "air",
    [
        [{"model": "extinction_per_km", "extinction_per_km": 0.6, "range_m": 250.0}],
        [{"transmission": math.exp(-0.15), "range_m": 250.0}],
        [{"transmission": math.exp(-0.24)}],  # of the 400 m on Init & Trans
        [
            {"model": "extinction_per_km", "extinction_per_km": 0.4, "range_m": 250.0},
            {"transmission": math.exp(-0.05), "range_m": 250.0},
        ],
    ],
)
def test_grey_air_is_an_extinction(air):
    """The range sought counts, not that of the picture; two paths are two constituents."""
    air = [{**one, "air_K": 300.0} for one in air]
    through, _, warned = evaluated({"target_delta_K": 0.5}, air=air)
    typed, _, _ = evaluated({"target_delta_K": 0.5, "extinction_per_km": 0.6})
    for name in RANGES:
        assert through[name] == pytest.approx(typed[name], rel=1e-9)
    assert warned == []


def test_an_extinction_beside_a_path_is_a_warning():
    grey = {"model": "extinction_per_km", "extinction_per_km": 0.6, "range_m": 250, "air_K": 300}
    _, _, warned = evaluated({"extinction_per_km": 0.5}, air=[grey])
    assert len(warned) == 1
    assert "extinction_per_km = 0.5 1/km is not used" in warned[0]
    assert evaluated({"extinction_per_km": 0.6}, air=[grey])[2] == []
    assert len(evaluated({"extinction_per_km": 0.6}, air=[PATH])[2]) == 1
    assert evaluated({"extinction_per_km": 0.6})[2] == []


# --- Figures of Merit of staring, parallel and serial scans, and of noise that is not white ---


SIDE = 96
SCAN_MRAD = 0.5  # mrad
SCAN_NYQUIST = 1.0
SCANNED = {
    "kind": "uniform", "width": SIDE, "height": SIDE, "cut_on_um": 8.0, "cut_off_um": 12.0,
    "fov_x_deg": math.degrees(SIDE * SCAN_MRAD / 1000), "temperature_K": 300.0,
    "fov_y_deg": math.degrees(SIDE * SCAN_MRAD / 1000),
}  # fmt: skip
SCANNING = {
    "detector_x_um": 50.0, "detector_y_um": 50.0, "focal_length_mm": 100.0, "f_number": 2.0,
    "scan_velocity_mrad_per_s": 1000.0,
}  # fmt: skip
SCAN_NOISE = {"region": "LWIR", "d_star": 1e10, "material": "manual"}  # bandwidth 1/(2·0.5 ms)


def scanner(platform="line", merit=None, *, noise=None, seed=1, **scene):
    """Scene, aperture, electronics, the figures."""
    nodes = {
        "scene": ("test_scene", {**SCANNED, **scene}),
        "init": ("init_trans", {**SCANNING, "platform": platform}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "noise": ("electronics_noise", {**SCAN_NOISE, **(noise or {})}),
        "merit": ("figures_of_merit", merit or {}),
    }
    return NodeBench(None, linked_network(nodes, seed=seed))


def table_of_scan(*args, **kwargs):
    return scanner(*args, **kwargs).value("merit.table").as_dict()


def curves_of_scan(port, *args, **kwargs):
    return {s.label: s for s in scanner(*args, **kwargs).value(f"merit.{port}").series}


class TestPatternOfDetectors:
    """A spread of gain of 2 %: on a uniform field 2 % of its radiance, over dL/dT."""

    @pytest.mark.parametrize("kind", ["uniform", "two_panel"])
    @pytest.mark.parametrize(
        ("platform", "component"), [("array", "vh"), ("push", "h"), ("line", "")]
    )
    def test_is_of_samples_columns_or_nothing(self, platform, component, kind):
        """Whatever the scene shows, one detector has no pattern, and those of a push columns."""
        found = table_of_scan(platform, noise={"gain_percent": 2.0}, kind=kind, delta_K=20.0)
        background = found["background_K"]
        level, warmer, colder = (
            float(band_radiance(8.0, 12.0, background + d)) for d in (0.0, 0.01, -0.01)
        )
        for name in ("vh", "v", "h"):
            expected = 0.02 * level / ((warmer - colder) / 0.02) if name == component else 0.0
            # What the seed does to the mean itself is a hundredth of the pattern and less.
            assert found[f"sigma_{name}_K"] == pytest.approx(expected, rel=0.03, abs=1e-9), name

    def test_columns_hide_upright_bars_and_leave_lying_ones(self):
        clean, spoilt = (
            table_of_scan("push", noise={"gain_percent": percent}) for percent in (0.0, 2.0)
        )
        name = "mrtd_{}_50_percent_nyquist"
        assert spoilt[name.format("x")] > 5 * clean[name.format("x")]
        assert spoilt[name.format("y")] == pytest.approx(clean[name.format("y")], rel=0.05)


class TestNoiseBehindAFilter:
    """A pre-amplifier of the dwell time leaves 40 % of the variance, at low frequencies mostly."""

    FILTERED = {"use_mtf": True}  # noqa: RUF012

    def test_threshold_is_that_of_bars_cut_out_of_frames(self):
        """Bars of 8 × 56 samples (7:1), averaged in 60 frames of noise; (π²/8)·2.5·σ/H."""
        means = []
        for seed in range(60):
            bench = scanner("line", noise=self.FILTERED, seed=seed)
            drawn = bench.value("noise.noise")[:56, :]
            means.append(drawn.mean(axis=0).reshape(12, 8).mean(axis=1))
        up, down = (float(band_radiance(8.0, 12.0, 300.0 + d)) for d in (0.01, -0.01))
        sigma_K = np.std(means) / ((up - down) / 0.02)
        # Bars of 4 mrad: 0.125 cycles/mrad. Detector of 0.5 mrad, pole 1/√(1 + (2π·0.5·0.125)²).
        transfer = np.sinc(0.5 * 0.125) / math.sqrt(1 + (math.pi * 0.125) ** 2)
        truth = math.pi**2 / 8 * 2.5 * sigma_K / transfer
        curve = curves_of_scan("mrtd", "line", {"frame_rate_Hz": None}, noise=self.FILTERED)
        found = np.interp(0.125, curve["horizontal"].x, curve["horizontal"].y)
        assert found == pytest.approx(truth, rel=0.08)  # 720 bars: σ to 2.6 %


def test_gain_error_as_printed_is_refused():
    bench = scanner(noise={"gain_model": "literal", "gain_percent": 1.0})
    with pytest.raises(DataError, match="gain_model = literal"):
        bench.value("merit.table")
