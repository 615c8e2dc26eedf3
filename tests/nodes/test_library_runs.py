"""Every registered module runs, and passes its input on where it says so."""

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.run.shipped import shipped_networks
from battery_settings import EXAMPLES, NEUTRAL
from core.chain.engine import Engine
from core.chain.wires import Image, transfer_plane
from core.errors import ImagechainError, ParameterError
from core.evaluation.recipes import Step, content_key
from core.evaluation.work import Policy
from core.modules.declaration import NodeContext
from core.modules.parameters import plain
from core.network.network import Network, Node, passed_through
from core.transfer.factors import Law, Separable
from library_battery import (
    DECLARED,
    FREQUENCY_OUTPUTS,
    LIBRARY,
    assert_clear,
    double,
    finite,
    network,
    planned,
)
from node_bench import shipped_bench
from thorough import examples


@pytest.mark.parametrize("key", LIBRARY)
class TestRuns:
    @pytest.mark.thorough(but=52)
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

    def test_planned_again_or_sent_to_another_process_it_has_the_same_keys(self, key, folder):
        one, two = (planned(key, EXAMPLES[key], folder) for _ in range(2))
        for name, value in one.nodes["it"].outputs.items():
            assert two.nodes["it"].outputs[name].key == value.key
            assert pickle.loads(pickle.dumps(value)).key == value.key

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
        for path, write in node.module.files(node.inputs, NodeContext("it", 0, folder), double()):
            assert path.parent == folder
            assert not path.exists()
            write(path)
            assert path.stat().st_size > 0


@pytest.mark.parametrize("key", NEUTRAL)
class TestNeutral:
    def test_passes_its_input_key_through(self, key, folder):
        assert passed_through(DECLARED[key])
        for params in NEUTRAL[key]:
            node = planned(key, params, folder).nodes["it"]
            for output, source in passed_through(DECLARED[key]).items():
                assert node.outputs[output].key == node.inputs[source].key, params

    def test_neutral_transfer_functions_are_the_identity(self, key, folder):
        for params in NEUTRAL[key]:
            outputs = planned(key, params, folder).nodes["it"].outputs
            for name in FREQUENCY_OUTPUTS:
                if name in outputs and outputs[name].own is None:
                    plane = transfer_plane(double(), outputs[name])
                    assert np.all(plane == (1.0 if name == "mtf" else 0.0)), params


# --- Every registered module takes a parameter or refuses it in one line ---


@pytest.mark.parametrize("key", LIBRARY)
class TestParameters:
    @pytest.mark.parametrize("given_values", ["defaults", "example"])
    def test_json_round_trip(self, key, given_values):
        module = LIBRARY[key].build({} if given_values == "defaults" else EXAMPLES[key])
        text = json.dumps({n: plain(v) for n, v in module.values().items()}, allow_nan=False)
        again = LIBRARY[key].build(json.loads(text))
        assert again == module
        assert content_key(again.values()) == content_key(module.values())

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

    @settings(max_examples=examples(25), deadline=None, derandomize=True)
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


# --- Every step that makes a picture says what becomes of one in it ---


def of_plan(plan) -> set[object]:
    """Functions of the steps that pictures are made by, and of those that they stem from."""
    functions = set()
    for node in plan.nodes.values():
        for value in (node.outputs or {}).values():
            recipe = value.recipe if isinstance(value, Image) else None
            while recipe is not None:
                functions |= {recipe.function} if isinstance(recipe, Step) else set()
                recipe = recipe.lineage and recipe.lineage.picture
    return functions


def undeclared(functions) -> list[str]:
    return sorted(f"{f.__module__}.{f.__qualname__}" for f in functions if not _declares(f))


def _declares(function) -> bool:
    return callable(getattr(function, "lineage", None))


@pytest.mark.parametrize("key", LIBRARY)
def test_every_step_of_a_module(key, folder):
    plan = planned(key, EXAMPLES[key], folder)
    assert not undeclared(of_plan(plan))


@pytest.mark.parametrize("name", shipped_networks())
def test_every_step_of_a_shipped_network(name):
    functions = of_plan(shipped_bench(name).plan)
    assert functions
    assert not undeclared(functions)


# --- Arguments of transfer functions are refused when a network is planned, not when it is run ---


# Settings that the panel allows, and what they come to: beyond what a number can hold.
BEYOND = {
    "vibration_mtf": (
        {"amplitude_x_mrad": 1, "frequency_Hz": 1e300, "integration_time_s": 1e30},
        "it: vibration periods in one exposure = inf is not allowed: must be a finite number",
    ),
    "detector_mtf": (
        {"detector_x_um": 1e30, "focal_length_mm": 1e-300},
        "it: effective_ifov_mrad = inf mrad is not allowed: must be a finite number, zero or above",
    ),
    "electronics_noise": (
        {
            "scan_mirror_rate_Hz": 1e-30,
            "use_mtf": True,
            "post_filter": "lowpass",
            "post_corner_Hz": 1e300,
        },
        "it: corner_cyc_per_mrad = inf cyc/mrad is not allowed: must be a finite number above zero",
    ),
}


@pytest.mark.parametrize("key", BEYOND)
def test_it_is_refused_on_its_node_when_planned(key, folder):
    settings, line = BEYOND[key]
    params = {**EXAMPLES[key], **settings}
    plan = Engine(LIBRARY).plan(network(key, params), folder=folder)
    assert isinstance(plan.nodes["it"].error, ParameterError)
    assert [str(error) for error in plan.errors()] == [line]


def laws_of(plan):
    """Laws of a plan's factors that are bound to no recipe, each with a factor that has it."""
    found = {}
    for node in plan.nodes.values():
        for value in node.outputs.values():
            for factor in getattr(value, "factors", ()):
                found |= {law.function: (law, factor) for law in factor.laws if not law.inputs}
    return found.values()


def made_again(factor, law):
    if isinstance(factor, Separable):
        return replace(factor, x=law, y=None)
    return replace(factor, law=law)


def assert_each_number_is_checked(plan):
    for law, factor in laws_of(plan):
        assert made_again(factor, law).laws == (law,)
        for name, value in law.parameters:
            if isinstance(value, bool) or not isinstance(value, int | float):
                continue
            wrong = Law.of(law.function, **{**dict(law.parameters), name: math.nan})
            with pytest.raises(ParameterError, match="nan"):
                made_again(factor, wrong)


@pytest.mark.parametrize("key", LIBRARY)
def test_no_factor_of_a_module_is_made_of_what_is_no_number(key, folder):
    assert_each_number_is_checked(planned(key, EXAMPLES[key], folder))
