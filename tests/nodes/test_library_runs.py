"""Every registered module runs, and passes its input on where it says so."""

import pickle

import numpy as np
import pytest

from battery_settings import EXAMPLES, NEUTRAL
from core.chain.engine import Engine
from core.chain.wires import transfer_plane
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.modules.declaration import NodeContext
from core.network.network import Network, Node, passed_through
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
