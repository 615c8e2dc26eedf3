"""Random chains of random modules: the right mean, finite numbers, or one clear error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.declaration import declaration
from core.engine import Engine
from core.errors import ImagechainError
from core.network import Link, Network, Node
from core.parameters import Parameter, plain
from core.policy import Policy
from nodes.library import standard_library

LIBRARY = standard_library()
SPECTRUM = (
    "atmosphere_mtf", "exit_pupil_mtf", "gaussian_mtf", "crosstrack_mtf", "alongtrack_mtf",
    "relative_motion_mtf", "jitter_mtf", "vibration_mtf", "detector_mtf", "charge_eff_mtf",
    "charge_eff_phase",
)  # fmt: skip
PICTURE = (
    "combine_pixels", "anti_alias", "interpolate", "poisson_noise", "electronics_noise",
    "periodic_noise",
)  # fmt: skip
SIZES = [
    (1, 1),
    (1, 2),
    (1, 7),
    (9, 1),
    (2, 2),
    (2, 3),
    (5, 4),
    (7, 13),
    (33, 7),
    (16, 16),
    (12, 31),
]
# Where the declared range is that of a large machine, not of a test.
AFFORDABLE = {
    "width": (1, 40), "height": (1, 40), "wavelengths": (1, 6), "size_x": (2, 48),
    "size_y": (2, 48), "factor": (1, 60), "factor_x": (1, 6), "factor_y": (1, 6), "vanes": (0, 9),
}  # fmt: skip
SENSOR = {
    "detector_x_um": 30, "detector_y_um": 25, "focal_length_mm": 50, "f_number": 2, "range_m": 500,
    "velocity_m_per_s": 100, "scan_velocity_mrad_per_s": 5000,
}  # fmt: skip
PUPIL = {"size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4, "slit_width": 3}
BAND = {"cut_on_um": 8, "cut_off_um": 12}
# Of these some parameters must be given for the module to run at all.
GIVEN: dict[str, dict[str, Any]] = {
    "exit_pupil_mtf": BAND,
    "electronics_noise": {**BAND, "d_star": 1e10, "background_K": 300, "bandwidth_Hz": 1e4},
    "poisson_noise": {"photons_per_unit": 10},
    "atmosphere_mtf": {"wavelength_um": 9, "fried_r0_m": 0.02, "aperture_mm": 20},
}
MEAN_ERROR = {"double": 1e-12, "single": 1e-6}


def ordinary(parameter: Parameter) -> st.SearchStrategy[Any]:
    """Values a person may give, over the declared range."""
    return drawn(parameter, 3)


def extreme(parameter: Parameter) -> st.SearchStrategy[Any]:
    """Values over the whole range of the type."""
    return drawn(parameter, 300)


def drawn(parameter: Parameter, decades: int) -> st.SearchStrategy[Any]:
    low, high = AFFORDABLE.get(parameter.name, (parameter.param.low, parameter.param.high))
    if parameter.kind == "choice":
        return st.sampled_from(parameter.choices)
    if parameter.kind == "switch":
        return st.booleans()
    if parameter.kind == "integer":
        whole = st.integers(int(low or 0), int(min(high or 10**4, 10**9)))
        return whole | st.none() if parameter.empty else whole
    if parameter.kind == "number":
        size = st.floats(-decades, decades).map(lambda power: float(10.0**power))
        ends = [e for e in (low, high, 1.0, 0.0) if e is not None]
        value = st.one_of(size, size.map(lambda v: -v), st.sampled_from(ends))
        fits = value.filter(parameter._in_range)
        return fits | st.none() if parameter.empty else fits
    return st.just(plain(parameter.default))


@st.composite
def module_values(draw, key, strategy, few=3):
    """A few parameters of a module; the others keep their default, or what lets it run."""
    parameters = declaration(LIBRARY[key]).parameters
    some = draw(st.lists(st.sampled_from(parameters), max_size=few, unique_by=lambda p: p.name))
    return {**GIVEN.get(key, {}), **{p.name: draw(strategy(p)) for p in some}}


@dataclass
class Chain:
    """A network, its last picture, and whether the mean should come out as it went in."""

    network: Network
    last: str
    keeps_mean: bool


@st.composite
def chains(draw, strategy, sizes=SIZES):
    size = draw(st.sampled_from(sizes))
    edges = draw(st.sampled_from(["reflect", "periodic"]))
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1}),
        "init": ("init_trans", {**SENSOR, "edges": edges}),
        "pupil": ("exit_pupil", PUPIL),
        "back": ("back_transform", {}),
    }
    links = [("file.image", "init.image")]
    wires = {"magnitude": "init", "phase": "init"}
    keeps = True
    for number, key in enumerate(draw(st.lists(st.sampled_from(SPECTRUM), max_size=4))):
        name = f"s{number}"
        values = draw(module_values(key, strategy))
        nodes[name] = (key, values)
        links.append(("init.context", f"{name}.context"))
        keeps &= values.get("apply") != "filter_only"
        changed = ["phase"] if key == "charge_eff_phase" else ["magnitude"]
        if key == "exit_pupil_mtf":
            links.append(("pupil.pupil", f"{name}.pupil"))
            changed = ["magnitude", "phase"]
            if draw(st.booleans()):
                nodes["pupil"] = (
                    "exit_pupil",
                    {**PUPIL, **draw(module_values("exit_pupil", strategy))},
                )
        # On mirrored frames an H that is not even along each axis moves the mean.
        uneven = "phase" in changed or values.get("model") == "line"
        keeps &= not (uneven and edges == "reflect")
        for wire in changed:
            links.append((f"{wires[wire]}.{wire}", f"{name}.{wire}"))
            wires[wire] = name
    links += [(f"{source}.{wire}", f"back.{wire}") for wire, source in wires.items()]
    last, shape = "back", size
    for number, key in enumerate(draw(st.lists(st.sampled_from(PICTURE), max_size=3))):
        name = f"p{number}"
        values = draw(module_values(key, strategy))
        nodes[name] = (key, values)
        links.append((f"{last}.image", f"{name}.image"))
        if declaration(LIBRARY[key]).input("context"):
            links.append(("init.context", f"{name}.context"))
        if key == "combine_pixels":
            fy, fx = values.get("factor_y", 2), values.get("factor_x", 2)
            keeps &= shape[0] % fy == 0 and shape[1] % fx == 0 and values.get("mode") != "sum"
            shape = shape[0] // fy, shape[1] // fx
        elif key != "anti_alias":
            keeps = False
        last = name
    document = Network(
        seed=draw(st.integers(0, 5)),
        nodes={name: Node(name, key, values) for name, (key, values) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )
    return size, Chain(document, last, keeps)


def picture_of(kind: str, shape: tuple[int, int]) -> np.ndarray:
    random = np.random.default_rng(7)
    uniform = random.uniform(20, 60, shape)
    return {
        "scene": lambda: uniform,
        "constant": lambda: np.full(shape, 37.25),
        "zero": lambda: np.zeros(shape),
        "huge": lambda: 1e30 * uniform,
        "tiny": lambda: 1e-30 * uniform,
        "edge of single": lambda: 5e36 * uniform,
        "edge of double": lambda: 2.9e306 * uniform,
        "least": lambda: 5e-324 * np.rint(uniform),
        "wide": lambda: 10.0 ** random.uniform(-6, 6, shape),
        "negative": lambda: uniform - 45.0,
        "below zero": lambda: -uniform,
        "point": lambda: np.where(
            np.arange(uniform.size).reshape(shape) == uniform.size // 2, 1.0, 0.0
        ),
    }[kind]()


KINDS = ("scene", "constant", "zero", "huge", "tiny", "wide", "negative", "below zero", "point",
         "edge of single", "edge of double", "least")  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("chains")


def not_nan(value: Any) -> bool:
    return not (isinstance(value, float) and math.isnan(value))


def run(chain: Chain, picture: np.ndarray, folder, precision: str, threads: int = 1) -> None:
    """Everything the network can show is finite, or there is one clear error."""
    np.save(folder / "in.npy", picture)
    engine = Engine(LIBRARY)
    work = engine.work(Policy(precision=precision, threads=threads))
    try:
        plan = engine.plan(chain.network, folder=folder)
        for error in plan.errors():
            raise error
        final = engine.value(plan, f"{chain.last}.image", work)
    except ImagechainError as error:
        assert_clear(error, chain)
    else:
        assert final.shape == plan.output(f"{chain.last}.image").shape
        assert np.isfinite(final).all()
        if chain.keeps_mean:
            # Below the least normal number there are no digits to keep.
            scale = np.abs(picture).max() + np.finfo(final.dtype).tiny / MEAN_ERROR[precision]
            error = abs(final.mean(dtype=float) - picture.mean())
            assert error <= MEAN_ERROR[precision] * scale
    for name, node in plan.nodes.items():
        if node.error is not None:
            continue
        for output in node.outputs:
            try:
                value = engine.value(plan, f"{name}.{output}", work)
            except ImagechainError as error:
                assert_clear(error, chain)
                continue
            if isinstance(value, np.ndarray):
                assert np.isfinite(value).all(), f"{name}.{output}"
        try:
            figures = engine.readouts(plan, name, work)
        except ImagechainError as error:
            assert_clear(error, chain)
            continue
        assert all(not_nan(figure) for figure in figures.values()), (name, figures)


def assert_clear(error: ImagechainError, chain: Chain) -> None:
    assert error.exit_code == 2, error
    assert error.node in chain.network.nodes
    assert "\n" not in str(error)
    assert len(str(error)) < 400


SETTINGS = settings(
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much,
                           HealthCheck.data_too_large],
)  # fmt: skip


@settings(SETTINGS, max_examples=150)
@given(drawn=chains(ordinary), precision=st.sampled_from(["double", "single"]))
def test_ordinary_parameters(folder, drawn, precision):
    size, chain = drawn
    run(chain, picture_of("scene", size), folder, precision)


@settings(SETTINGS, max_examples=100)
@given(drawn=chains(extreme, sizes=SIZES[2:9]), precision=st.sampled_from(["double", "single"]))
def test_extreme_parameters(folder, drawn, precision):
    size, chain = drawn
    run(chain, picture_of("scene", size), folder, precision)


@pytest.mark.parametrize("kind", KINDS[1:])
@settings(SETTINGS, max_examples=25)
@given(drawn=chains(ordinary), precision=st.sampled_from(["double", "single"]))
def test_extreme_pictures(folder, kind, drawn, precision):
    size, chain = drawn
    run(chain, picture_of(kind, size), folder, precision)


def test_faults_in_worker_threads_are_errors_too(folder):
    """Where rows are shared out among threads, an overflow is no less an error."""
    picture = np.random.default_rng(3).uniform(20, 60, (300, 310))
    cases = [
        ("periodic_noise", {"amplitude": 1e300, "modulation": 0.5}, picture),
        ("electronics_noise", {**GIVEN["electronics_noise"], "use_mtf": True}, 1e37 * picture / 60),
        ("electronics_noise", {**GIVEN["electronics_noise"], "amplifier_snr": 1e-60}, picture),
        ("interpolate", {"width": 700, "height": 300, "order": 3}, 5e36 * picture),
        ("jitter_mtf", {}, 5e36 * picture),
        ("charge_eff_phase", {"efficiency": 0.9}, 5e36 * picture),
        ("poisson_noise", {"percent": 90}, 5e36 * picture),
        ("combine_pixels", {"factor_x": 7, "mode": "sum"}, 5e36 * picture),
        ("anti_alias", {"factor": 5, "kernel": "lanczos"}, 5e36 * picture),
    ]
    for key, values, samples in cases:
        run(fixed_chain(key, values), samples, folder, "single", threads=2)


# What is switched on beside the parameter under test, so that it acts.
ACTIVE: dict[str, list[dict[str, Any]]] = {
    "atmosphere_mtf": [
        {"turbulence": "short_exposure", **GIVEN["atmosphere_mtf"]},
        {"turbulence": "long_exposure", "cn2": 1e-14, "wavelength_um": 9},
        {"turbulence": "long_exposure", "cn2": 1e-14, "wavelength_um": 9, "view": "vertical"},
        {"fwhm_mrad": 1, "turbidity": "custom", "scatter_depth": 1},
        {"turbidity": "custom", "scattering_per_km": 1, "view": "vertical"},
    ],
    "exit_pupil_mtf": [BAND, {**BAND, "method": "autocorrelation"}, {**BAND, "wavelengths": 3}],
    "gaussian_mtf": [{"sigma_x_mrad": 1, "sigma_y_mrad": 1}],
    "crosstrack_mtf": [{"dwell_time_s": 1e-4}],
    "alongtrack_mtf": [{"integration_time_s": 0.01}],
    "relative_motion_mtf": [
        {"image_velocity_x": 3, "platform_velocity_y": 4, "integration_time_s": 0.1, "model": m}
        for m in ("published", "line")
    ],
    "vibration_mtf": [
        {"amplitude_x_mrad": 1, "amplitude_y_mrad": 2, "frequency_Hz": 9, "integration_time_s": t}
        for t in (0.1, 1.0)
    ],
    "charge_eff_mtf": [{"efficiency": 0.9, "model": m} for m in ("exact", "published")],
    "charge_eff_phase": [{"efficiency": 0.9, "model": m} for m in ("exact", "published")],
    "poisson_noise": [{"percent": 10}, {"mode": "photon", "photons_per_unit": 10}],
    "electronics_noise": [
        GIVEN["electronics_noise"],
        {**BAND, "region": "LWIR", "scan_mirror_rate_Hz": 1},
        {
            **GIVEN["electronics_noise"], "amplifier_snr": 9, "gain_percent": 2,
            "bias_percent": 2, "noise_variability_percent": 5, "use_mtf": True,
            "post_filter": "boost", "post_corner_Hz": 1000, "bits": 8,
        },
        {
            **GIVEN["electronics_noise"], "gain_percent": 2, "bias_percent": 2, "bits": 64,
            "gain_model": "literal", "post_filter": "lowpass", "post_corner_Hz": 1000,
        },
    ],
    "periodic_noise": [{"amplitude": 1, "modulation": 0.5}],
    "anti_alias": [{"factor": 3, "kernel": k} for k in ("box", "gaussian", "lanczos")],
    "init_trans": [SENSOR],
    "exit_pupil": [
        PUPIL,
        *({**PUPIL, "shape": s} for s in ("half_moon", "cassegrain", "cassegrain_slit", "spider")),
        {**PUPIL, "defocus_waves": 0.5},
        {**PUPIL, "shape": "cassegrain", "zernike_waves": [0, 0, 0, 0.1]},
    ],
}  # fmt: skip
LARGEST, SMALLEST = 1.7976931348623157e308, 5e-324


def extremes(parameter: Parameter) -> list[Any]:
    """The ends of a parameter's range, and what lies far out within it."""
    low, high = AFFORDABLE.get(parameter.name, (parameter.param.low, parameter.param.high))
    if parameter.kind == "choice":
        return list(parameter.choices)
    if parameter.kind == "switch":
        return [False, True]
    if parameter.kind not in ("number", "integer"):
        return []
    sizes = [SMALLEST, 1e-30, 1e9, 1e300, LARGEST]
    values = [*sizes, *(-v for v in sizes), 0.0]
    values += [end for end in (low, high) if end is not None]
    for end, step in ((low, math.inf), (high, -math.inf)):
        if end is not None and parameter.kind == "number":
            values.append(math.nextafter(end, step))
    if parameter.kind == "integer":
        values = [int(v) for v in values if abs(v) < 2**62 and v == int(v)]
        values = [v for v in values if (low is None or v >= low) and (high is None or v <= high)]
    return [v for v in dict.fromkeys(values) if parameter._in_range(v)]


def fixed_chain(key: str, values: dict[str, Any]) -> Chain:
    """Init, the module (of spectra), a pupil, back, the module (of pictures), in this order."""
    on_picture = key in PICTURE
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1}),
        "init": ("init_trans", SENSOR),
        "pupil": ("exit_pupil", PUPIL),
        "optics": ("exit_pupil_mtf", BAND),
        "back": ("back_transform", {}),
    }
    links = [
        ("file.image", "init.image"), ("init.context", "optics.context"),
        ("pupil.pupil", "optics.pupil"), ("init.phase", "optics.phase"),
        ("optics.magnitude", "back.magnitude"),
    ]  # fmt: skip
    phase = "optics.phase"
    name = {"init_trans": "init", "exit_pupil": "pupil", "exit_pupil_mtf": "optics"}.get(key, "it")
    nodes[name] = (key, values)
    last = "back"
    if on_picture:
        links.append(("back.image", "it.image"))
        last = "it"
    declared = declaration(LIBRARY[key])
    if name == "it" and declared.input("context"):
        links.append(("init.context", "it.context"))
    if name == "it" and declared.input("magnitude"):
        links += [("init.magnitude", "it.magnitude"), ("it.magnitude", "optics.magnitude")]
    else:
        links.append(("init.magnitude", "optics.magnitude"))
    if name == "it" and declared.input("phase"):
        links += [(phase, "it.phase")]
        phase = "it.phase"
    links.append((phase, "back.phase"))
    document = Network(
        nodes={n: Node(n, module, params) for n, (module, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )
    even = key not in ("charge_eff_phase", "exit_pupil") and values.get("model") != "line"
    keeps = (not on_picture or key == "anti_alias") and even and not values.get("apply")
    return Chain(document, last, keeps)


def each_extreme(key: str):
    """Settings, and the precisions to try them in: samples overflow sooner in single."""
    for parameter in declaration(LIBRARY[key]).parameters:
        for base in ACTIVE.get(key, [{}]):
            for value in extremes(parameter):
                far = isinstance(value, float) and not 1e-200 < abs(value) < 1e200
                precisions = ("double",) if key not in PICTURE else ("single", "double")[: 1 + far]
                for precision in precisions:
                    yield {**base, parameter.name: value}, precision


@pytest.mark.parametrize("key", [*SPECTRUM, *PICTURE, "init_trans", "exit_pupil"])
def test_each_parameter_at_its_extremes(folder, key):
    picture = picture_of("scene", (3, 4))
    faults = []
    for values, precision in each_extreme(key):
        try:
            run(fixed_chain(key, values), picture, folder, precision)
        except (ArithmeticError, AssertionError, ValueError, Warning) as fault:
            reason = str(fault).splitlines()[0] if str(fault) else ""
            faults.append(f"{precision} {values}: {type(fault).__name__} {reason}")
    assert not faults, "\n".join([f"{len(faults)} settings fail", *faults[:8]])
