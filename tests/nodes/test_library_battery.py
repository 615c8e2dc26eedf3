"""One battery for every registered module: declared, documented, runnable, and true to its kind."""

from __future__ import annotations

import json
import math
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.data import CurveData, TableData
from core.declaration import Here, declaration
from core.engine import Engine, Plan
from core.errors import ImagechainError, ParameterError
from core.keys import content_key
from core.network import Link, Network, Node, passed_through
from core.parameters import plain
from core.policy import Policy
from core.product import Product
from core.realize import transfer_plane
from core.values import Context
from nodes.library import standard_library

LIBRARY = standard_library()
DECLARED = {key: declaration(module) for key, module in LIBRARY.items()}
PORT_TYPES = {"image", "magnitude", "phase", "context", "pupil", "transfer", "curve", "table"}
FREQUENCY_OUTPUTS = ("mtf", "ptf")
FILTERS = [k for k, d in DECLARED.items() if any(d.output(name) for name in FREQUENCY_OUTPUTS)]
APPLIED = [k for k in FILTERS if DECLARED[k].parameter("apply")]

# Parameters of each module's small example; what they are linked to follows from their port types.
EXAMPLES: dict[str, dict[str, Any]] = {
    "read_image": {"path": "noise.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1},
    "test_scene": {"width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1},
    "write_image": {"path": "written.tif"},
    "write_matrix": {"path": "written.csv"},
    "examine_image": {"probe_x": 3, "probe_y": 4},
    "init_trans": {"detector_x_um": 30, "focal_length_mm": 50},
    "back_transform": {},
    "combine_pixels": {"factor_x": 3, "factor_y": 2},
    "anti_alias": {"factor": 3},
    "interpolate": {"width": 20, "height": 7},
    "atmosphere_mtf": {"fwhm_mrad": 2, "turbidity": "high"},
    "exit_pupil": {"size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4},
    "exit_pupil_mtf": {"size_x_cm": 3, "size_y_cm": 4, "wavelengths": 3},
    "gaussian_mtf": {"sigma_x_mrad": 1, "sigma_y_mrad": 2},
    "poisson_noise": {"percent": 50},
    "crosstrack_mtf": {"dwell_time_s": 1e-4},
    "alongtrack_mtf": {"integration_time_s": 0.01},
    "relative_motion_mtf": {
        "image_velocity_x": 5, "platform_velocity_y": 90, "integration_time_s": 0.01,
        "model": "line",
    },
    "jitter_mtf": {"sigma_mrad": 1},
    "vibration_mtf": {
        "amplitude_x_mrad": 1, "amplitude_y_mrad": 2, "frequency_Hz": 10,
        "integration_time_s": 0.13,
    },
    "detector_mtf": {},
    "charge_eff_mtf": {"efficiency": 0.999},
    "charge_eff_phase": {"efficiency": 0.999},
    "electronics_noise": {
        "region": "LWIR", "scan_mirror_rate_Hz": 1, "amplifier_snr": 30, "gain_percent": 1,
        "bias_percent": 1, "noise_variability_percent": 10, "use_mtf": True,
        "post_filter": "lowpass", "post_corner_Hz": 2000, "bits": 8,
    },
    "periodic_noise": {"amplitude": 2, "modulation": 0.5},
    "noise_file": {"path": "noise.npy", "scale": 0.1},
    "mtf_slices": {"direction": "both", "samples": 9},
    "compare_images": {},
}  # fmt: skip

# Settings at which a module passes its input on; several where there are several ways to say so.
NEUTRAL: dict[str, list[dict[str, Any]]] = {
    "combine_pixels": [{"factor_x": 1, "factor_y": 1}],
    "anti_alias": [{}, {"kernel": "lanczos", "factor": 1}],
    "interpolate": [{}, {"width": 15, "height": 11, "order": 3}],
    "atmosphere_mtf": [
        {}, {"turbulence": "none"}, {"turbidity": "custom"},
        {"turbidity": "custom", "absorption_per_km": 2},
    ],
    "exit_pupil_mtf": [{"interpolation": "none"}],
    "gaussian_mtf": [{}, {"sigma_x_mrad": 0, "sigma_y_mrad": 0.0}],
    "poisson_noise": [{"percent": 0}],
    "crosstrack_mtf": [{}, {"dwell_time_s": 0, "scan_velocity_mrad_per_s": 7}],
    "alongtrack_mtf": [{}, {"velocity_m_per_s": 30}],
    "relative_motion_mtf": [
        {},
        {"image_velocity_x": 5, "platform_velocity_x": 5, "integration_time_s": 1},
        {"image_velocity_x": 5, "model": "line"},
    ],
    "jitter_mtf": [{"sigma_mrad": 0}],
    "vibration_mtf": [{}, {"frequency_Hz": 5, "integration_time_s": 1}],
    "charge_eff_mtf": [{"efficiency": 1}, {"detectors_per_line": 0}],
    "charge_eff_phase": [{"efficiency": 1}, {"detectors_per_line": 0, "model": "published"}],
    "periodic_noise": [{"amplitude": 0}],
    "noise_file": [{"path": "noise.npy", "scale": 0}],
}  # fmt: skip
NEVER_NEUTRAL = {
    "detector_mtf": "a detector always has an area",
    "electronics_noise": "a detector always has noise",
    "compare_images": "what it gives is a difference",
}

# Numbers that count or share: no unit says more than their text.
PURE_NUMBERS = {
    "band", "scale", "width", "height", "frequency", "probe_x", "probe_y", "bins", "f_number",
    "fill_x", "fill_y", "factor_x", "factor_y", "alpha", "scatter_depth", "size_x", "size_y",
    "vanes", "wavelengths", "seed", "photons_per_unit", "detectors_per_line", "efficiency",
    "optics_transmission", "filter_transmission", "amplifier_snr", "post_poles", "post_gain",
    "amplitude", "modulation", "samples", "range_low", "range_high",
}  # fmt: skip
# Numbers of either sign without a natural limit.
UNBOUNDED = {
    "scale", "delta_K", "angle_deg", "range_low", "range_high", "velocity_m_per_s",
    "image_velocity_x", "image_velocity_y", "platform_velocity_x", "platform_velocity_y",
    "amplitude", "xi", "eta", "phase_deg", "modulation_xi", "modulation_eta",
    "modulation_phase_deg",
}  # fmt: skip

PUPILS: dict[str, dict[str, Any]] = {
    "clear": {},
    "half_moon": {"shape": "half_moon"},
    "cassegrain": {"shape": "cassegrain"},
    "hinged": {"shape": "hinged"},
    "cassegrain_slit": {"shape": "cassegrain_slit"},
    "spider": {"shape": "spider"},
    "defocus": {"defocus_waves": 0.7},
    "defocused ring": {"shape": "cassegrain", "defocus_waves": 1.2},
    "coma": {"zernike_waves": [0, 0, 0, 0.1, 0, 0, 0.2, 0.15]},
}
SMALL_PUPIL = {
    "size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4, "slit_width": 3,
    "vane_width": 2,
}  # fmt: skip
SCAN = {"region": "LWIR", "scan_mirror_rate_Hz": 1}
POST = {"post_corner_Hz": 1500}

# What every filter is tried with, beside its example and what hypothesis draws.
SETTINGS: dict[str, list[dict[str, Any]]] = {
    "atmosphere_mtf": [
        {"turbulence": "long_exposure", "fried_r0_m": 0.01},
        {"turbulence": "long_exposure", "cn2": 1e-13},
        {"turbulence": "long_exposure", "cn2": 1e-13, "view": "vertical"},
        {"turbulence": "short_exposure", "fried_r0_m": 0.01, "aperture_mm": 5, "alpha": 1},
        {"turbulence": "short_exposure", "fried_r0_m": 1e-6, "aperture_mm": 5},
        {"turbulence": "none", "turbidity": "custom", "scatter_depth": 700},
        {"turbulence": "none", "turbidity": "custom", "scattering_per_km": 3, "view": "vertical"},
        {"turbidity": "low", "turbidity_cutoff_cyc_per_mrad": 1e6},
    ],
    "exit_pupil_mtf": [
        {},
        *({"size_x_cm": 3, "size_y_cm": 2, "wavelengths": n} for n in (2, 3, 4, 5, 7, 11)),
        {"method": "autocorrelation", "size_x_cm": 3, "size_y_cm": 3},
        {"method": "autocorrelation", "interpolation": "linear", "wavelengths": 2},
    ],
    "gaussian_mtf": [{"sigma_y_mrad": 1e9}, {"sigma_x_mrad": 1e-9}],
    "crosstrack_mtf": [{"dwell_time_s": 1, "scan_velocity_mrad_per_s": 1e6}],
    "alongtrack_mtf": [{"velocity_m_per_s": -4000, "integration_time_s": 1, "range_m": 3}],
    "relative_motion_mtf": [
        {"image_velocity_x": 9, "platform_velocity_y": 4, "integration_time_s": 1},
        {
            "image_velocity_x": -9e4, "platform_velocity_y": 4, "integration_time_s": 1,
            "model": "line",
        },
        {"image_velocity_x": -9, "integration_time_s": 1, "model": "line"},
    ],
    "vibration_mtf": [
        {"amplitude_x_mrad": 3},
        {"amplitude_y_mrad": 3, "frequency_Hz": 1, "integration_time_s": 4},
        {"amplitude_x_mrad": 3, "frequency_Hz": 1, "integration_time_s": 1e-6},
        {"amplitude_x_mrad": 300, "frequency_Hz": 7, "integration_time_s": 1.23},
    ],
    "detector_mtf": [{"detector_x_um": 1e5, "fill_y": 1e-6}, {"focal_length_mm": 1e-3}],
    "charge_eff_mtf": [
        {"efficiency": 0, "detectors_per_line": 3},
        {"efficiency": 0.5, "detectors_per_line": 1000000},
        {"efficiency": 0.9, "model": "published", "nyquist": "detector"},
        {"efficiency": 0.9, "model": "leading"},
    ],
    "charge_eff_phase": [
        {"efficiency": 0, "detectors_per_line": 3},
        {"efficiency": 0.5, "detectors_per_line": 1000000},
        {"efficiency": 0.9, "model": "published", "nyquist": "detector"},
        {"efficiency": 0.9, "model": "leading"},
    ],
    "electronics_noise": [
        {**SCAN, "use_mtf": True},
        {**SCAN, "use_mtf": True, "time_constant_s": 10},
        {**SCAN, "post_filter": "lowpass", "post_poles": 4, **POST},
    ],
}  # fmt: skip
NOT_PASSIVE = [
    {**SCAN, "post_filter": "highpass", **POST},
    {**SCAN, "post_filter": "boost", "post_gain": 9, **POST},
]

SCENE = {"kind": "dormitory", "width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1}
SENSOR = {
    "detector_x_um": 30, "detector_y_um": 25, "focal_length_mm": 50, "f_number": 2, "range_m": 500,
    "velocity_m_per_s": 100, "scan_velocity_mrad_per_s": 5000,
}  # fmt: skip
BASE: dict[str, tuple[str, dict[str, Any]]] = {
    "scene": ("test_scene", SCENE),
    "other": ("test_scene", {**SCENE, "kind": "sine"}),
    "init": ("init_trans", SENSOR),
    "pupil": ("exit_pupil", SMALL_PUPIL),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 1}),
    "lag": ("charge_eff_phase", {"efficiency": 0.99}),
}
BASE_LINKS = (
    ("scene.image", "init.image"),
    ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"),
    ("init.context", "lag.context"),
    ("init.phase", "lag.phase"),
)
SOURCES = {
    "image": "scene.image", "context": "init.context", "magnitude": "blur.magnitude",
    "phase": "lag.phase", "pupil": "pupil.pupil", "transfer": "blur.mtf",
}  # fmt: skip


def network(key: str, params: dict[str, Any], pupil: dict[str, Any] | None = None) -> Network:
    """The module under test as node `it`, its inputs linked by their type."""
    nodes = {**BASE, "it": (key, params)}
    if pupil is not None:
        nodes["pupil"] = ("exit_pupil", {**SMALL_PUPIL, **pupil})
    links = list(BASE_LINKS)
    for port in DECLARED[key].inputs:
        source = "other.image" if port.name == "reference" else SOURCES[port.types[0]]
        links.append((source, f"it.{port.name}"))
    return Network(
        seed=1996,
        nodes={name: Node(name, module, values) for name, (module, values) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("battery")
    samples = np.random.default_rng(1).normal(size=(11, 15))
    np.save(place / "noise.npy", samples)
    return place


def planned(key, params, folder, pupil=None) -> Plan:
    plan = Engine(LIBRARY).plan(network(key, params, pupil), folder=folder)
    for node in plan.nodes.values():
        if node.error is not None:
            raise node.error
    return plan


def double():
    return Engine(LIBRARY).work(Policy(precision="double"))


def assert_clear(error: ImagechainError, node: str | None) -> None:
    assert error.exit_code == 2
    assert error.node == node
    assert "\n" not in str(error)


def finite(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.size > 0 and bool(np.isfinite(value).all())
    if isinstance(value, CurveData):
        return all(finite(s.x) and finite(s.y) and len(s.x) == len(s.y) for s in value.series)
    if isinstance(value, TableData):
        return all(finite(row.value) for row in value.rows)
    if isinstance(value, float):
        return math.isfinite(value)
    return isinstance(value, int | str | Context | None)


# ---------------------------------------------------------------- declarations


def test_tables_name_only_registered_modules():
    for table in (EXAMPLES, NEUTRAL, NEVER_NEUTRAL, SETTINGS):
        assert set(table) <= set(LIBRARY)


@pytest.mark.parametrize("key", LIBRARY)
class TestDeclared:
    def test_says_what_it_is(self, key):
        declared = DECLARED[key]
        assert declared.key == key == LIBRARY[key].key
        assert declared.title
        assert declared.group
        assert declared.version >= 1
        assert declared.summary.endswith(".")
        assert len(declared.summary) <= 120
        assert not declared.text.startswith(LIBRARY[key].__name__ + "(")  # dataclass' own words

    def test_has_its_own_example(self, key):
        assert key in EXAMPLES, f"{key} is registered without an example in this battery"

    def test_filters_name_their_source(self, key):
        if key in FILTERS:
            assert "Source" in DECLARED[key].text

    def test_ports_are_typed(self, key):
        declared = DECLARED[key]
        assert declared.inputs or declared.outputs
        for port in (*declared.inputs, *declared.outputs):
            assert port.types
            assert set(port.types) <= PORT_TYPES
        for port in declared.outputs:
            assert len(port.types) == 1
        names = [port.name for port in declared.inputs]
        assert len(set(names)) == len(names)
        assert declared.outputs or declared.sink

    def test_parameters_are_documented(self, key):
        for parameter in DECLARED[key].parameters:
            assert parameter.param.text.strip()
            assert not parameter.required
            if parameter.kind in ("number", "integer", "numbers"):
                assert parameter.param.unit or parameter.name in PURE_NUMBERS, parameter.name
                bounded = parameter.param.low is not None or parameter.param.high is not None
                assert bounded or parameter.name in UNBOUNDED, parameter.name

    def test_units_in_names_and_declarations_agree(self, key):
        endings = {
            "_mrad": "mrad", "_um": "µm", "_mm": "mm", "_m": "m", "_cm": "cm", "_K": "K",
            "_Hz": "Hz", "_s": "s", "_deg": "deg", "_percent": "%", "_per_km": "1/km",
            "_m_per_s": "m/s", "_mrad_per_s": "mrad/s", "_cyc_per_mrad": "cyc/mrad", "_px": "px",
            "_waves": None,
        }  # fmt: skip
        declared = DECLARED[key]
        named = [(p.name, p.param.unit) for p in declared.parameters]
        named += [(r.name, r.unit) for r in declared.readouts]
        for name, unit in named:
            ending = max((e for e in endings if name.endswith(e)), key=len, default=None)
            if ending is not None and endings[ending] is not None:
                assert unit == endings[ending], name

    def test_readouts_are_documented(self, key):
        declared = DECLARED[key]
        ports = {port.name for port in declared.inputs} | {"outputs"}
        names = [readout.name for readout in declared.readouts]
        assert len(set(names)) == len(names)
        for readout in declared.readouts:
            assert readout.meaning.endswith("."), readout.name
            assert set(readout.needs) <= ports

    def test_modules_of_one_folder_share_a_group(self, key):
        area = LIBRARY[key].__module__.split(".")[1]
        groups = {
            d.group for k, d in DECLARED.items() if LIBRARY[k].__module__.split(".")[1] == area
        }
        assert len(groups) == 1


# ---------------------------------------------------------------- parameters


@pytest.mark.parametrize("key", LIBRARY)
class TestParameters:
    def test_constructs_with_defaults(self, key):
        module = LIBRARY[key].build({})
        module.check()
        for parameter in DECLARED[key].parameters:
            default = getattr(module, parameter.name)
            assert parameter.coerce(plain(default)) == default
            if default is not None:
                assert type(parameter.coerce(plain(default))) is type(default)

    @pytest.mark.parametrize("given_values", ["defaults", "example"])
    def test_json_round_trip(self, key, given_values):
        module = LIBRARY[key].build({} if given_values == "defaults" else EXAMPLES[key])
        text = json.dumps({n: plain(v) for n, v in module.values().items()}, allow_nan=False)
        again = LIBRARY[key].build(json.loads(text))
        assert again == module
        assert content_key(again.values()) == content_key(module.values())

    def test_pickles(self, key):
        module = LIBRARY[key].build(EXAMPLES[key])
        assert pickle.loads(pickle.dumps(module)) == module
        assert pickle.loads(pickle.dumps(DECLARED[key])) == DECLARED[key]

    def test_whole_numbers_and_floats_are_one_value(self, key):
        for parameter in DECLARED[key].parameters:
            if parameter.kind not in ("number", "integer"):
                continue
            allowed = 0
            for whole in (0, 1, 2, 3, 8, 400):
                try:
                    module = LIBRARY[key].build({parameter.name: whole})
                except ParameterError:
                    with pytest.raises(ParameterError):
                        LIBRARY[key].build({parameter.name: float(whole)})
                    continue
                allowed += 1
                other = LIBRARY[key].build({parameter.name: float(whole)})
                minus = LIBRARY[key].build({parameter.name: -0.0}) if whole == 0 else other
                keys = {content_key(m.values()) for m in (module, other, minus)}
                assert len(keys) == 1, (parameter.name, whole)
            assert allowed, parameter.name

    @settings(max_examples=25, deadline=None, derandomize=True)
    @given(data=st.data())
    def test_any_value_is_taken_or_refused_in_one_line(self, key, data):
        anything = st.one_of(
            st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5),
            st.lists(st.floats() | st.integers(), max_size=3), st.integers(10**300, 10**400),
            st.sampled_from([1e308, -1e308, 5e-324, 2**63, -(2**63), "1", b"1", {}]),
        )  # fmt: skip
        for parameter in DECLARED[key].parameters:
            value = data.draw(anything)
            try:
                module = LIBRARY[key].build({parameter.name: value})
            except ParameterError as error:
                assert_clear(error, None)
                continue
            stored = json.loads(json.dumps(plain(getattr(module, parameter.name)), allow_nan=False))
            assert LIBRARY[key].build({parameter.name: stored}) == module

    def test_unknown_parameter_is_refused(self, key):
        with pytest.raises(ParameterError, match="no_such"):
            LIBRARY[key].build({"no_such": 1})


# ---------------------------------------------------------------- running


@pytest.mark.parametrize("key", LIBRARY)
class TestRuns:
    @pytest.mark.parametrize("precision", ["single", "double"])
    def test_example_gives_finite_outputs(self, key, precision, folder):
        engine = Engine(LIBRARY)
        plan = planned(key, EXAMPLES[key], folder)
        work = engine.work(Policy(precision=precision, threads=1))
        assert set(plan.nodes["it"].outputs) == {port.name for port in DECLARED[key].outputs}
        for name, value in plan.nodes["it"].outputs.items():
            found = engine.value(plan, f"it.{name}", work)
            assert finite(found), name
            assert value.port_type in DECLARED[key].output(name).types
            if isinstance(found, np.ndarray):
                assert not found.flags.writeable or value.port_type != "image"
                if value.port_type in ("image", "magnitude", "phase"):
                    assert found.dtype == work.policy.dtype
                    assert found.shape == (value.shape if value.port_type == "image" else (11, 15))

    def test_readouts_are_finite(self, key, folder):
        engine = Engine(LIBRARY)
        for params in ({}, EXAMPLES[key]):
            work = engine.work(Policy(precision="double"))
            try:
                plan = planned(key, params, folder)
                found = engine.readouts(plan, "it", work)
            except ImagechainError as error:
                if params:
                    raise
                assert_clear(error, "it")  # not every module can run without a setting
                continue
            assert set(found) == {readout.name for readout in DECLARED[key].readouts}
            assert all(finite(value) for value in found.values()), found

    def test_recipes_pickle(self, key, folder):
        plan = planned(key, EXAMPLES[key], folder)
        for value in plan.nodes["it"].outputs.values():
            assert pickle.loads(pickle.dumps(value)).key == value.key

    def test_planning_twice_gives_the_same_keys(self, key, folder):
        one, two = (planned(key, EXAMPLES[key], folder) for _ in range(2))
        for name, value in one.nodes["it"].outputs.items():
            assert two.nodes["it"].outputs[name].key == value.key

    def test_a_disabled_node_passes_on_and_shows_no_figures(self, key, folder):
        whole = network(key, EXAMPLES[key])
        node = Node("it", key, EXAMPLES[key], disabled=True)
        plan = Engine(LIBRARY).plan(
            Network(nodes={**whole.nodes, "it": node}, links=whole.links), folder=folder
        )
        planned_node = plan.nodes["it"]
        assert planned_node.error is None
        for output, source in passed_through(DECLARED[key]).items():
            if planned_node.inputs[source] is not None:
                assert planned_node.outputs[output].key == planned_node.inputs[source].key
        engine = Engine(LIBRARY)
        found = engine.readouts(plan, "it", double())  # must not raise: a panel asks for them
        assert all(finite(value) for value in found.values())

    def test_sinks_write_what_they_were_given(self, key, folder):
        if not DECLARED[key].sink:
            return
        plan = planned(key, EXAMPLES[key], folder)
        node = plan.nodes["it"]
        for path, write in node.module.files(node.inputs, Here("it", 0, folder), double()):
            assert path.parent == folder
            assert not path.exists()
            write(path)
            assert path.stat().st_size > 0


# ---------------------------------------------------------------- neutral settings


def passing() -> list[str]:
    """Modules that give on what they take, among them every filter."""
    return [key for key, declared in DECLARED.items() if passed_through(declared)]


@pytest.mark.parametrize("key", passing())
class TestNeutral:
    def test_has_a_neutral_setting(self, key):
        assert (key in NEUTRAL) != (key in NEVER_NEUTRAL)

    def test_passes_its_input_key_through(self, key, folder):
        for params in NEUTRAL.get(key, []):
            node = planned(key, params, folder).nodes["it"]
            for output, source in passed_through(DECLARED[key]).items():
                assert node.outputs[output].key == node.inputs[source].key, params

    def test_neutral_transfer_functions_are_the_identity(self, key, folder):
        for params in NEUTRAL.get(key, []):
            outputs = planned(key, params, folder).nodes["it"].outputs
            for name in FREQUENCY_OUTPUTS:
                if name in outputs and outputs[name].own is None:
                    plane = transfer_plane(double(), outputs[name])
                    assert np.all(plane == (1.0 if name == "mtf" else 0.0)), params


# ---------------------------------------------------------------- transfer functions

XI = np.concatenate([[0.0], np.geomspace(1e-6, 40.0, 23)])
ETA = np.concatenate([[0.0], np.geomspace(3e-6, 30.0, 17)])


def both_signs(positive):
    return np.concatenate([-positive[:0:-1], positive])


def check_transfer(plan: Plan, *, passive: bool = True) -> None:
    """H(0) = 1, |H| ≤ 1, H(−xi, −eta) = conj H; the MTF real, the PTF odd."""
    work, outputs = double(), plan.nodes["it"].outputs
    xi, eta = both_signs(XI), both_signs(ETA)
    centre = (len(ETA) - 1, len(XI) - 1)
    factors: tuple[Any, ...] = ()
    modulus: Any = 1.0
    if "mtf" in outputs:
        mtf = transfer_plane(work, outputs["mtf"], xi, eta)
        assert np.isrealobj(mtf)
        assert np.isfinite(mtf).all()
        if passive:
            assert mtf[centre] == 1.0
            assert np.abs(mtf).max() <= 1 + 1e-15
        assert np.abs(mtf - mtf[::-1, ::-1]).max() <= 1e-13
        factors += outputs["mtf"].factors
        modulus = mtf
    if "ptf" in outputs:
        ptf = transfer_plane(work, outputs["ptf"], xi, eta)
        assert np.isrealobj(ptf)
        assert np.isfinite(ptf).all()
        assert ptf[centre] == 0.0
        # Odd as an angle: where it is π, so is its opposite, and where H is 0 it means nothing.
        turn = modulus * (np.exp(1j * ptf) - np.exp(-1j * ptf[::-1, ::-1]))
        assert np.abs(turn).max() <= 1e-11
        factors += outputs["ptf"].factors
    h = Product(factors).total(work, xi, eta)
    assert np.isfinite(h).all()
    if passive:
        assert h[centre] == 1.0
        assert np.abs(h).max() <= 1 + 1e-15
        assert Product(factors).at_zero(work) == 1.0
    assert np.abs(h - h[::-1, ::-1].conj()).max() <= 1e-11


@pytest.mark.parametrize("key", FILTERS)
def test_transfer_functions_of_settings(key, folder):
    for params in ({}, EXAMPLES[key], *SETTINGS.get(key, [])):
        if params == {} and key == "electronics_noise":
            continue
        check_transfer(planned(key, params, folder))


@pytest.mark.parametrize("pupil", PUPILS)
def test_transfer_functions_of_pupils(pupil, folder):
    for params in SETTINGS["exit_pupil_mtf"]:
        check_transfer(planned("exit_pupil_mtf", params, folder, PUPILS[pupil]))


@pytest.mark.parametrize("params", NOT_PASSIVE, ids=lambda p: p["post_filter"])
def test_transfer_functions_that_amplify(params, folder):
    check_transfer(planned("electronics_noise", params, folder), passive=False)


def drawn_value(parameter) -> st.SearchStrategy[Any]:
    """Values over the parameter's declared range, ordinary and extreme."""
    low, high = parameter.param.low, parameter.param.high
    if parameter.kind == "choice":
        return st.sampled_from(parameter.choices)
    if parameter.kind == "switch":
        return st.booleans()
    if parameter.kind == "integer":
        return st.integers(int(low or 0), int(min(high or 10**6, 10**6)))
    if parameter.kind == "number":
        size = st.floats(-12, 12).map(lambda power: float(10.0**power)) | st.just(1.0)
        signed = size if low is not None and low >= 0 else st.one_of(size, size.map(lambda v: -v))
        fits = signed.filter(parameter._in_range)
        return st.one_of(st.none(), fits) if parameter.empty else fits
    return st.just(plain(parameter.default))


@pytest.mark.parametrize("key", [k for k in FILTERS if k != "exit_pupil_mtf"])
@settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.filter_too_much],
)
@given(data=st.data())
def test_transfer_functions_of_any_parameters(key, folder, data):
    params = {p.name: data.draw(drawn_value(p), p.name) for p in DECLARED[key].parameters}
    if key == "electronics_noise" and params["post_filter"] in ("highpass", "boost"):
        params["post_filter"] = "none"
    try:
        plan = planned(key, params, folder)
        check_transfer(plan)
    except ImagechainError as error:
        assert_clear(error, "it")


@pytest.mark.parametrize("key", APPLIED)
def test_filter_only_changes_the_wire_but_never_the_transfer_function(key, folder):
    engine = Engine(LIBRARY)
    work = engine.work(Policy(precision="double"))
    full = planned(key, EXAMPLES[key], folder)
    alone = planned(key, {**EXAMPLES[key], "apply": "filter_only"}, folder)
    for wire, transfer in (("magnitude", "mtf"), ("phase", "ptf")):
        if transfer not in full.nodes["it"].outputs:
            continue
        assert alone.output(f"it.{transfer}").key == full.output(f"it.{transfer}").key
        shown = engine.value(alone, f"it.{transfer}", work)
        assert np.array_equal(shown, engine.value(full, f"it.{transfer}", work))
        assert np.array_equal(engine.value(alone, f"it.{wire}", work), shown)
        assert alone.output(f"it.{wire}").key != full.output(f"it.{wire}").key
        before = engine.value(full, SOURCES[wire], work)
        after = engine.value(full, f"it.{wire}", work)
        expected = before * shown if wire == "magnitude" else before + shown
        assert np.allclose(after, expected, rtol=1e-13, atol=1e-13 * np.abs(before).max())
