"""What a network delivers against the analytic transfer functions, written here a second time."""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from core.engine import Engine
from core.errors import ImagechainError
from core.network import Link, Network, Node
from core.policy import Policy
from nodes.library import standard_library

LIBRARY = standard_library()
PRECISIONS = ["double", "single"]
MTF_ERROR = {"double": 1e-12, "single": 2e-6}
MEAN_ERROR = {"double": 1e-13, "single": 1e-7}
SHIFT_ERROR = {"double": 1e-10, "single": 1e-5}
FOLD_ERROR = {"double": 1e-13, "single": 1e-6}

FOCAL_MM, PITCH_X_UM, PITCH_Y_UM, FILL_X, FILL_Y = 40.0, 90.0, 60.0, 0.9, 0.8
RANGE_M, SPEED = 400.0, 60.0
SENSOR = {
    "detector_x_um": PITCH_X_UM, "detector_y_um": PITCH_Y_UM, "focal_length_mm": FOCAL_MM,
    "fill_x": FILL_X, "fill_y": FILL_Y, "range_m": RANGE_M, "velocity_m_per_s": SPEED,
    "f_number": 2,
}  # fmt: skip
INTERVAL_X, INTERVAL_Y = 0.8, 1.1  # mrad, what the fields of view below come to
TRANSFERS, EFFICIENCY = 3, 0.8

# One stage each: module, parameters, wires it changes.
STAGES = {
    "air": ("atmosphere_mtf", {
        "fwhm_mrad": 1.1, "turbidity": "custom", "scatter_depth": 0.3,
        "turbidity_cutoff_cyc_per_mrad": 0.35,
    }),
    "fried": ("atmosphere_mtf", {
        "turbulence": "short_exposure", "fried_r0_m": 0.008, "wavelength_um": 9,
        "aperture_mm": 30, "alpha": 0.5,
    }),
    "optics": ("exit_pupil_mtf", {
        "cut_on_um": 8, "cut_off_um": 12, "size_x_cm": 3.2, "size_y_cm": 2.4,
    }),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.31, "sigma_y_mrad": 0.17}),
    "scan": ("crosstrack_mtf", {"dwell_time_s": 1e-3, "scan_velocity_mrad_per_s": 400}),
    "along": ("alongtrack_mtf", {"integration_time_s": 0.004}),
    "smear": ("relative_motion_mtf", {
        "image_velocity_x": 30, "platform_velocity_y": 50, "integration_time_s": 0.005,
        "model": "line",
    }),
    "box": ("relative_motion_mtf", {
        "image_velocity_x": 30, "platform_velocity_y": 50, "integration_time_s": 0.005,
    }),
    "jitter": ("jitter_mtf", {"sigma_mrad": 0.13}),
    "shake": ("vibration_mtf", {"amplitude_x_mrad": 0.4, "amplitude_y_mrad": 0.2}),
    "shake some": ("vibration_mtf", {
        "amplitude_x_mrad": 0.4, "frequency_Hz": 10, "integration_time_s": 0.13,
    }),
    "pixel": ("detector_mtf", {}),
    "left": ("charge_eff_mtf", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
    "late": ("charge_eff_phase", {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY}),
    "published": ("charge_eff_phase", {
        "detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY, "model": "published",
    }),
}  # fmt: skip
PUPIL = {"shape": "cassegrain", "size_x": 64, "size_y": 64, "radius": 24, "obscuration_radius": 9}
ALL = ("air", "optics", "blur", "scan", "along", "smear", "jitter", "shake", "pixel", "left",
       "late")  # fmt: skip
CHAINS = {
    "whole chain": ALL,
    "sampled by rows": ("fried", "box", "shake some", "left", "published"),
    "optics and delay": ("optics", "late"),
    "smear": ("smear", "late"),
    "symmetric": ("fried", "optics", "pixel", "shake", "jitter"),
}
SIZES = [(31, 17), (24, 10), (32, 32), (9, 20), (1, 16), (13, 1), (2, 2), (1, 1)]


# ---------------------------------------------------------------- analytic


def sinc(x):
    return np.sinc(x)


def overlap(a, b, d):
    """Area two discs of radius a and b share at the distance d, to 30 digits."""
    if d >= a + b:
        return mpf(0)
    if d <= abs(a - b):
        return mp.pi * min(a, b) ** 2
    one = (d * d + a * a - b * b) / (2 * d * a)
    two = (d * d + b * b - a * a) / (2 * d * b)
    kite = mp.sqrt((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b)) / 2
    return a * a * mp.acos(one) + b * b * mp.acos(two) - kite


@cache
def ring(distance: str) -> float:
    """Normalised autocorrelation of the pupil at a lag in samples."""
    with mpmath.workdps(30):
        d, a, b = mpf(distance), mpf(PUPIL["radius"]), mpf(PUPIL["obscuration_radius"])
        shared = overlap(a, a, d) - 2 * overlap(a, b, d) + overlap(b, b, d)
        return float(shared / (mp.pi * (a * a - b * b)))


def optics(xi, eta):
    pitch_x, pitch_y, wavelength = mpf(32) / 64, mpf(24) / 64, mpf(10)
    found = np.empty(np.broadcast(xi, eta).shape)
    for index, (x, y) in enumerate(np.broadcast(xi, eta)):
        with mpmath.workdps(25):
            lag = mp.hypot(wavelength * abs(mpf(x)) / pitch_x, wavelength * abs(mpf(y)) / pitch_y)
            found.flat[index] = ring(mp.nstr(lag, 22))
    return found


def fried(rho):
    lag = 9 * rho
    tilt = np.maximum(0, 1 - 0.5 * (lag / 30) ** (1 / 3))
    return np.exp(-3.44 * (lag / 8) ** (5 / 3) * tilt)


def air(rho):
    sigma = 1.1 / (2 * np.sqrt(2 * np.log(2)))
    return np.exp(-2 * (np.pi * sigma * rho) ** 2) * np.exp(-0.3 * np.minimum(rho / 0.35, 1) ** 2)


def bessel(x):
    return np.vectorize(lambda v: float(mp.besselj(0, v)))(x)


def shake_some(xi):
    """Mean of exp(−2πi·xi·A·sin(2πft)) over 1.3 periods, by Gauss's rule; the modulus."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    t = 0.065 * (nodes + 1)
    moved = 0.4 * np.sin(2 * np.pi * 10 * t)
    return np.abs(np.exp(-2j * np.pi * np.multiply.outer(xi, moved)) @ weights / 2)


def one_transfer(xi):
    lost = 1 - EFFICIENCY
    return EFFICIENCY / (1 - lost * np.exp(-2j * np.pi * xi * INTERVAL_X))


def analytic(stage, xi, eta):
    """H of a stage on broadcast frequencies, cycles/mrad."""
    w = 2 * np.pi * xi * INTERVAL_X
    blur_x, blur_y = -30 * 0.005 / RANGE_M * 1000, 50 * 0.005 / RANGE_M * 1000
    forms = {
        "air": lambda: air(np.hypot(xi, eta)),
        "fried": lambda: fried(np.hypot(xi, eta)),
        "optics": lambda: optics(xi, eta),
        "blur": lambda: np.exp(-2 * np.pi**2 * ((0.31 * xi) ** 2 + (0.17 * eta) ** 2)),
        "scan": lambda: sinc(0.4 * xi),
        "along": lambda: sinc(SPEED * 0.004 / RANGE_M * 1000 * eta),
        "smear": lambda: sinc(blur_x * xi + blur_y * eta),
        "box": lambda: sinc(blur_x * xi) * sinc(blur_y * eta),
        "jitter": lambda: np.exp(-2 * np.pi**2 * 0.13**2 * (xi**2 + eta**2)),
        "shake": lambda: bessel(2 * np.pi * 0.4 * xi) * bessel(2 * np.pi * 0.2 * eta),
        "shake some": lambda: shake_some(xi),
        "pixel": lambda: (
            sinc(PITCH_X_UM / FOCAL_MM * FILL_X * xi) * sinc(PITCH_Y_UM / FOCAL_MM * FILL_Y * eta)
        ),
        "left": lambda: np.abs(one_transfer(xi)) ** TRANSFERS,
        "late": lambda: np.exp(1j * TRANSFERS * np.angle(one_transfer(xi))),
        "published": lambda: np.exp(-1j * TRANSFERS * (1 - EFFICIENCY) * (w - np.sin(w))),
    }
    return forms[stage]() + 0 * (xi + eta)


@cache
def plane(stage, rows, columns, flip_y, flip_x):
    """H of a stage at a plain FFT's frequencies; at Nyquist of either sign."""
    xi, eta = np.fft.fftfreq(columns, INTERVAL_X), np.fft.fftfreq(rows, INTERVAL_Y)
    if flip_x:
        xi[np.arange(columns) * 2 == columns] *= -1
    if flip_y:
        eta[np.arange(rows) * 2 == rows] *= -1
    return analytic(stage, xi[np.newaxis, :], eta[:, np.newaxis])


def expected_h(chain, rows, columns):
    """The Hermitian part of the chain's H: the mean over both signs of Nyquist."""
    total = np.zeros((rows, columns), complex)
    for flip_y in (False, True):
        for flip_x in (False, True):
            h = np.ones((rows, columns), complex)
            for stage in CHAINS[chain]:
                h *= plane(stage, rows, columns, flip_y, flip_x)
            total += h / 4
    return total


# ---------------------------------------------------------------- networks


def fov_deg(samples, interval):
    return float(np.degrees(samples * interval / 1000))


def chain_network(stages, rows, columns, edges="periodic", tail=()):
    """A picture file through the stages to `last.image`; `tail` are further image modules."""
    nodes = {
        "file": ("read_image", {"path": "in.npy"}),
        "init": ("init_trans", {
            **SENSOR, "edges": edges, "fov_x_deg": fov_deg(columns, INTERVAL_X),
            "fov_y_deg": fov_deg(rows, INTERVAL_Y),
        }),
        "pupil": ("exit_pupil", PUPIL),
        "back": ("back_transform", {}),
    }  # fmt: skip
    links = [("file.image", "init.image")]
    wires = {"magnitude": "init", "phase": "init"}
    for stage in stages:
        key, params = STAGES[stage]
        nodes[stage] = (key, params)
        links.append(("init.context", f"{stage}.context"))
        wire = "phase" if key == "charge_eff_phase" else "magnitude"
        changed = ("magnitude", "phase") if key == "exit_pupil_mtf" else (wire,)
        if key == "exit_pupil_mtf":
            links.append(("pupil.pupil", f"{stage}.pupil"))
        for name in changed:
            links.append((f"{wires[name]}.{name}", f"{stage}.{name}"))
            wires[name] = stage
    links += [(f"{source}.{name}", f"back.{name}") for name, source in wires.items()]
    last = "back"
    for number, (key, params) in enumerate(tail):
        nodes[f"tail{number}"] = (key, params)
        links.append((f"{last}.image", f"tail{number}.image"))
        last = f"tail{number}"
    return network(nodes, links), last


def network(nodes, links):
    return Network(
        nodes={name: Node(name, key, params) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )


def delivered(tmp_path, picture, stages, precision, edges="periodic", tail=()):
    np.save(tmp_path / "in.npy", picture)
    document, last = chain_network(stages, *picture.shape, edges, tail)
    engine = Engine(LIBRARY)
    plan = engine.plan(document, folder=tmp_path)
    assert plan.errors() == []
    work = engine.work(Policy(precision=precision))
    found = engine.value(plan, f"{last}.image", work)
    assert found.dtype == work.policy.dtype
    return found.astype(float), plan


def scene(rows, columns, seed=5):
    """A frame with a wide range that is exact in single precision too."""
    drawn = np.random.default_rng(seed).uniform(20, 60, (rows, columns))
    return drawn.astype(np.float32).astype(float)


# ---------------------------------------------------------------- delivered MTF


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_delivered_mtf_is_the_analytic_product(tmp_path, size, chain, precision):
    rows, columns = size
    at = rows // 3, columns // 2
    point = np.zeros(size)
    point[at] = 1.0
    found, _ = delivered(tmp_path, point, CHAINS[chain], precision)
    # The FFT of the point itself, written as its phases, goes out of the FFT of the picture.
    towards = np.exp(
        2j * np.pi * (np.outer(np.fft.fftfreq(rows) * at[0], np.ones(columns))
                      + np.fft.fftfreq(columns) * at[1])
    )  # fmt: skip
    expected = expected_h(chain, rows, columns)
    assert np.abs(np.fft.fft2(found) * towards - expected).max() <= MTF_ERROR[precision]


@pytest.mark.parametrize("stage", STAGES)
def test_each_stage_alone_and_as_shown(tmp_path, stage):
    rows, columns = 15, 12
    point = np.zeros((rows, columns))
    point[0, 0] = 1.0
    found, plan = delivered(tmp_path, point, (stage,), "double")
    expected = np.mean(
        [plane(stage, rows, columns, fy, fx) for fy in (False, True) for fx in (False, True)],
        axis=0,
    )
    assert np.abs(np.fft.fft2(found) - expected).max() <= 1e-12
    engine = Engine(LIBRARY)
    work = engine.work(Policy(precision="double"))
    shown = np.ones((rows, columns), complex)
    if "mtf" in plan.nodes[stage].outputs:
        shown = shown * engine.value(plan, f"{stage}.mtf", work)
    if "ptf" in plan.nodes[stage].outputs:
        shown = shown * np.exp(1j * engine.value(plan, f"{stage}.ptf", work))
    assert np.abs(shown - plane(stage, rows, columns, False, False)).max() <= 1e-12


@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize("stages", [("optics",), ("optics", "pixel", "late"), ("smear", "late")])
def test_single_precision_where_planes_are_approximated(tmp_path, edges, stages):
    rows, columns = 144, 262
    picture = scene(rows, columns)
    found, _ = delivered(tmp_path, picture, stages, "single", edges)
    frame = picture
    if edges == "reflect":
        frame = np.block([[picture, picture[:, ::-1]], [picture[::-1], picture[::-1, ::-1]]])
    h = fast_h(stages, *frame.shape)
    expected = np.fft.ifft2(np.fft.fft2(frame) * h).real[:rows, :columns]
    assert np.abs(found - expected).max() <= 2e-6 * np.abs(expected).max()


def fast_h(stages, rows, columns):
    """As `expected_h`, the ring in plain double precision."""
    total = np.zeros((rows, columns), complex)
    for sign_y, sign_x in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        xi, eta = np.fft.fftfreq(columns, INTERVAL_X), np.fft.fftfreq(rows, INTERVAL_Y)
        xi[np.arange(columns) * 2 == columns] *= sign_x
        eta[np.arange(rows) * 2 == rows] *= sign_y
        h = np.ones((rows, columns), complex)
        for stage in stages:
            if stage == "optics":
                h *= fast_ring(np.hypot(10 * xi / 0.5, 10 * eta[:, np.newaxis] / 0.375))
            else:
                h *= analytic(stage, xi, eta[:, np.newaxis])
        total += h / 4
    return total


def fast_ring(lag):
    a, b = float(PUPIL["radius"]), float(PUPIL["obscuration_radius"])

    def shared(one, two):
        d = np.clip(lag, abs(one - two) + 1e-12, one + two)
        angles = [
            r * r * np.arccos(np.clip((d * d + r * r - s * s) / (2 * d * r), -1, 1))
            for r, s in ((one, two), (two, one))
        ]
        inner = (one + two - d) * (d + one - two) * (d - one + two) * (d + one + two)
        area = sum(angles) - np.sqrt(np.maximum(inner, 0)) / 2
        return np.where(lag <= abs(one - two), np.pi * min(one, two) ** 2, area)

    return (shared(a, a) - 2 * shared(a, b) + shared(b, b)) / (np.pi * (a * a - b * b))


# ---------------------------------------------------------------- mean and shift


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("edges", "chain"), [
    ("periodic", "whole chain"), ("periodic", "sampled by rows"), ("reflect", "symmetric"),
])  # fmt: skip
@pytest.mark.parametrize("size", [(31, 17), (48, 20), (1, 16), (64, 64)], ids=str)
@pytest.mark.parametrize("level", [0.0, 1e5])
def test_mean_radiance_is_kept(tmp_path, size, chain, edges, precision, level):
    picture = (scene(*size) + level).astype(np.float32).astype(float)
    found, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    assert abs(found.mean() / picture.mean() - 1) <= MEAN_ERROR[precision]


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("stages", [("late",), ("published",), ALL])
@pytest.mark.parametrize("size", [(31, 17), (10, 24), (32, 32)], ids=str)
def test_shift_from_the_first_bin(tmp_path, size, stages, precision):
    picture = np.zeros(size)
    picture[1, 2] = 1.0
    found, _ = delivered(tmp_path, picture, stages, precision)
    columns = size[1]
    ratio = np.fft.fft2(found)[0, 1] / np.fft.fft2(picture)[0, 1]
    first = 1 / (columns * INTERVAL_X)
    true = np.prod([analytic(stage, np.array([[first]]), np.zeros((1, 1))) for stage in stages])
    shift, expected = (-np.angle(h) * columns / (2 * np.pi) for h in (ratio, true))
    assert abs(shift - expected) <= SHIFT_ERROR[precision]
    # A delay: to +x.
    assert shift > 0


# ---------------------------------------------------------------- edges


def gaussian_matrix(size, sigma, pad):
    """Direct sum over every image of the frame, by the frame extended by `pad` samples."""
    n, m = np.arange(size)[:, np.newaxis], np.arange(-pad, size + pad)
    kernel = np.exp(-((n - m) ** 2) / (2 * sigma**2))
    # The spectrum beyond Nyquist is below 1e-14: the sampled kernel's sum is exact.
    return kernel / (sigma * np.sqrt(2 * np.pi))


def lag_matrix(size, pad):
    """Direct sum of the charge that `TRANSFERS` transfers leave behind."""
    lag = np.arange(size)[:, np.newaxis] - np.arange(-pad, size + pad)
    n = np.maximum(lag, 0)
    behind = EFFICIENCY**TRANSFERS * (1 - EFFICIENCY) ** n * (n + 1) * (n + 2) / 2
    return np.where(lag >= 0, behind, 0)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("size", [(31, 17), (24, 10), (16, 1), (1, 9), (33, 48)], ids=str)
class TestDirectConvolution:
    """A spatial sum over the extended frame; no transform at all."""

    def test_gaussian(self, tmp_path, size, edges, precision, monkeypatch):
        sigma, pad = (2.7, 2.6), 24
        monkeypatch.setitem(STAGES, "blur", ("gaussian_mtf", {
            "sigma_x_mrad": sigma[1] * INTERVAL_X, "sigma_y_mrad": sigma[0] * INTERVAL_Y,
        }))  # fmt: skip
        picture = scene(*size)
        found, _ = delivered(tmp_path, picture, ("blur",), precision, edges)
        frame = np.pad(picture, pad, mode="symmetric" if edges == "reflect" else "wrap")
        along, across = (gaussian_matrix(n, s, pad) for n, s in zip(size, sigma, strict=True))
        expected = along @ frame @ across.T
        assert np.abs(found - expected).max() <= MTF_ERROR[precision] * np.abs(expected).max()

    def test_charge_left_behind(self, tmp_path, size, edges, precision):
        pad = 30
        picture = scene(*size)
        found, _ = delivered(tmp_path, picture, ("left", "late"), precision, edges)
        mode = "symmetric" if edges == "reflect" else "wrap"
        frame = np.pad(picture, ((0, 0), (pad, pad)), mode=mode)
        expected = frame @ lag_matrix(size[1], pad).T
        assert np.abs(found - expected).max() <= MTF_ERROR[precision] * np.abs(expected).max()


# ---------------------------------------------------------------- combining pixels


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(
    ("size", "factors"),
    [
        ((24, 36), (2, 3)),
        ((21, 20), (7, 4)),
        ((30, 30), (30, 2)),
        ((15, 7), (5, 7)),
        ((1, 12), (1, 6)),
    ],
    ids=str,
)
def test_fold_then_inverse_is_inverse_then_mean(tmp_path, size, factors, chain, edges, precision):
    picture, (fy, fx) = scene(*size), factors
    tail = (("combine_pixels", {"factor_x": fx, "factor_y": fy}),)
    folded, plan = delivered(tmp_path, picture, CHAINS[chain], precision, edges, tail)
    # It was folded: nothing else went over the full frame again.
    assert type(plan.output("tail0.image").recipe).__name__ == "Delivered"
    fine, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    expected = fine.reshape(size[0] // fy, fy, size[1] // fx, fx).mean(axis=(1, 3))
    assert np.abs(folded - expected).max() <= FOLD_ERROR[precision] * np.abs(expected).max()


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("size", "left"), [(512, 2), (32, 2), (11, 2)])
def test_combining_by_three_crops(tmp_path, precision, size, left):
    picture = scene(size, size)
    tail = (("combine_pixels", {"factor_x": 3, "factor_y": 3}),)
    found, plan = delivered(tmp_path, picture, ("blur",), precision, "reflect", tail)
    fine, _ = delivered(tmp_path, picture, ("blur",), precision, "reflect")
    kept = size - left
    assert found.shape == (kept // 3, kept // 3)
    expected = fine[:kept, :kept].reshape(kept // 3, 3, kept // 3, 3).mean(axis=(1, 3))
    assert np.abs(found - expected).max() <= FOLD_ERROR[precision] * expected.max()
    image = plan.output("tail0.image")
    assert image.interval_x_mrad == pytest.approx(3 * INTERVAL_X, rel=1e-12)
    assert image.interval_y_mrad == pytest.approx(3 * INTERVAL_Y, rel=1e-12)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("steps", [((2, 3), (3, 2)), ((4, 1), (1, 5)), ((5, 5), (2, 2))])
def test_combining_twice_is_combining_once(tmp_path, precision, steps):
    picture = scene(60, 60)
    tail = tuple(("combine_pixels", {"factor_y": y, "factor_x": x}) for y, x in steps)
    twice, _ = delivered(tmp_path, picture, ("pixel", "late"), precision, "reflect", tail)
    fine, _ = delivered(tmp_path, picture, ("pixel", "late"), precision, "reflect")
    y, x = np.prod(steps, axis=0)
    expected = fine.reshape(60 // y, y, 60 // x, x).mean(axis=(1, 3))
    assert np.abs(twice - expected).max() <= FOLD_ERROR[precision] * expected.max()


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("factors", [(2, 3), (5, 4)])
def test_sum_is_mean_times_samples(tmp_path, precision, factors):
    found = {}
    for mode in ("mean", "sum"):
        values = {"factor_y": factors[0], "factor_x": factors[1], "mode": mode}
        tail = (("combine_pixels", values),)
        found[mode], _ = delivered(tmp_path, scene(24, 36), ("blur",), precision, tail=tail)
    expected = found["mean"] * factors[0] * factors[1]
    assert np.abs(found["sum"] - expected).max() <= 3e-7 * expected.max()


# ---------------------------------------------------------------- two images


def two_images(shape_a, shape_b, fov_b=1.0, late=False):
    rows, columns = shape_a
    fovs = {"fov_x_deg": fov_deg(columns, INTERVAL_X), "fov_y_deg": fov_deg(rows, INTERVAL_Y)}
    nodes = {
        "a": ("read_image", {"path": "a.npy"}),
        "b": ("read_image", {"path": "b.npy"}),
        "init a": ("init_trans", {**SENSOR, **fovs}),
        "init b": ("init_trans", {**SENSOR, **{k: v * fov_b for k, v in fovs.items()}}),
        "blur": STAGES["blur"],
        "late": STAGES["late"],
        "back": ("back_transform", {}),
    }
    links = [
        ("a.image", "init a.image"), ("b.image", "init b.image"),
        ("init a.context", "blur.context"), ("init a.magnitude", "blur.magnitude"),
        ("init b.context", "late.context"), ("init b.phase", "late.phase"),
        ("blur.magnitude", "back.magnitude"),
        ("late.phase" if late else "init b.phase", "back.phase"),
    ]  # fmt: skip
    return network(nodes, links)


@pytest.mark.parametrize("size", [(31, 17), (24, 10), (1, 8), (7, 1)], ids=str)
@pytest.mark.parametrize("late", [False, True])
def test_magnitude_of_one_and_phase_of_another(tmp_path, size, late):
    a, b = scene(*size, seed=1), scene(*size, seed=2)
    np.save(tmp_path / "a.npy", a)
    np.save(tmp_path / "b.npy", b)
    engine = Engine(LIBRARY)
    plan = engine.plan(two_images(size, size, late=late), folder=tmp_path)
    found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    h = np.mean(
        [
            plane("blur", *size, fy, fx) * (plane("late", *size, fy, fx) if late else 1.0)
            for fy in (False, True)
            for fx in (False, True)
        ],
        axis=0,
    )
    spectrum = np.abs(np.fft.fft2(a)) * np.exp(1j * np.angle(np.fft.fft2(b))) * h
    expected = np.fft.ifft2(spectrum)
    assert np.abs(expected.imag).max() <= 1e-12 * np.abs(expected).max()
    assert np.abs(found - expected.real).max() <= 1e-12 * np.abs(expected).max()
    assert abs(found.mean() / a.mean() - 1) <= 1e-13


def test_two_images_of_different_size_are_refused(tmp_path):
    np.save(tmp_path / "a.npy", scene(8, 8))
    np.save(tmp_path / "b.npy", scene(8, 9))
    plan = Engine(LIBRARY).plan(two_images((8, 8), (8, 9)), folder=tmp_path)
    assert [error.node for error in plan.errors()] == ["back"]


def test_two_samplings_of_one_size_are_refused_or_kept_apart(tmp_path):
    """A PTF belongs to the frequencies of its own Init & Trans, whatever it is combined with."""
    picture = scene(16, 12)
    np.save(tmp_path / "a.npy", picture)
    np.save(tmp_path / "b.npy", picture)
    engine = Engine(LIBRARY)
    plan = engine.plan(two_images((16, 12), (16, 12), fov_b=2.0, late=True), folder=tmp_path)
    if plan.errors():
        assert [error.node for error in plan.errors()] == ["back"]
        return
    try:
        found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    except ImagechainError:
        return
    # Packets are one sample apart on either: w = 2πk/N at bin k.
    h = np.mean([plane("blur", 16, 12, fy, fx) * plane("late", 16, 12, fy, fx)
                 for fy in (False, True) for fx in (False, True)], axis=0)  # fmt: skip
    expected = np.fft.ifft2(np.fft.fft2(picture) * h).real
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("size", [(31, 17), (24, 10)], ids=str)
def test_filter_alone_gives_its_impulse_response(tmp_path, size):
    np.save(tmp_path / "in.npy", scene(*size))
    document, _ = chain_network(("pixel", "late"), *size)
    for name in ("pixel", "late"):
        document = document.with_parameter(name, "apply", "filter_only")
    engine = Engine(LIBRARY)
    plan = engine.plan(document, folder=tmp_path)
    found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    h = np.mean(
        [
            plane("pixel", *size, fy, fx) * plane("late", *size, fy, fx)
            for fy in (False, True)
            for fx in (False, True)
        ],
        axis=0,
    )
    assert np.abs(np.fft.fft2(found) - h).max() <= 1e-12
    assert found.sum() == pytest.approx(1, abs=1e-13)
