"""Planning: nothing is computed, and errors go to their nodes."""

import pickle
import threading
from dataclasses import replace

import numpy as np
import pytest

from core.chain.engine import Engine
from core.chain.wires import MOST_STAGES, Magnitude
from core.errors import Cancelled, DataError, NetworkError, ParameterError, UnconnectedError
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.network.file import load_network
from core.transfer.factors import Grid, Law, Separable
from engine_bench import CHAIN, CHAIN_LINKS, LINE, Bench, network
from nodes.library import standard_library

FITTING = [("make.image", "a.image")]


class TestPlan:
    def test_an_error_stays_on_its_node_and_the_rest_runs(self, bench):
        document = network(
            {**LINE, "bad": ("maker", {"level": -13}), "c": ("scale", {}), "d": ("sum", {}),
             "e": ("scale", {})},
            [("make.image", "a.image"), ("bad.image", "c.image"), ("c.image", "d.image"),
             ("make.image", "d.other"), ("a.image", "b.image"), ("make.image", "e.image")],
        )  # fmt: skip
        plan = bench.engine.plan(document)
        assert [(error.node, type(error)) for error in plan.errors()] == [("bad", ParameterError)]
        for hung in ("bad", "c", "d"):
            with pytest.raises(ParameterError, match="-13") as caught:
                plan.output(f"{hung}.image")
            assert caught.value.node == "bad"
        assert bench.engine.value(plan, "b.image", bench.work())[0, 1] == 6
        assert bench.engine.value(plan, "e.image", bench.work())[0, 1] == 2

    @pytest.mark.parametrize(
        ("key", "params", "links", "node"),
        [
            ("nothing_like_it", {}, FITTING, "a"),
            ("scale", {"facto": 1}, FITTING, "a"),
            ("scale", {"factor": "x"}, FITTING, "a"),
            ("scale", {}, [], "a"),
            ("scale", {}, [("make.picture", "a.image")], "a"),
            ("scale", {}, [*FITTING, ("make.image", "a.no")], "a"),
            ("scale", {}, [("ghost.image", "a.image")], "a"),
            ("blur", {}, [("make.image", "a.context"), ("make.image", "a.magnitude")], "a"),
            ("scale", {}, [*FITTING, ("make.image", "ghost.image")], None),
        ],
        ids=["unknown module", "unknown parameter", "wrong kind", "missing input", "unknown output",
             "unknown input", "unknown source", "wrong port type", "unknown target"],
    )  # fmt: skip
    def test_a_network_that_does_not_fit_is_an_error_of_its_node(
        self, bench, key, params, links, node
    ):
        """The editor plans what is on the canvas, fitting or not: no other exception may escape."""
        nodes = {"make": ("maker", {}), "a": (key, params), "own": ("maker", {})}
        document = network(nodes, links)
        plan = bench.engine.plan(document)
        found = [error.node for error in plan.errors()]
        assert found == ([node] if node else [])
        assert bench.engine.value(plan, "own.image", bench.work()).shape == (4, 6)

    @pytest.mark.parametrize("port", ["ghost.image", "make.ghost", "make", "", "make.image.x"])
    def test_asking_for_what_is_not_there(self, bench, port):
        plan = bench.engine.plan(network(LINE))
        with pytest.raises(NetworkError):
            bench.engine.value(plan, port, bench.work())

    def test_errors_in_computing_carry_their_node(self, bench):
        document = network({**LINE, "a": ("scale", {"factor": 13})})
        plan = bench.engine.plan(document)
        assert plan.errors() == []
        for port in ("a.image", "b.image", "b.noise"):
            with pytest.raises(DataError, match="thirteen") as caught:
                bench.engine.value(plan, port, bench.work())
            assert caught.value.node == "a"
        with pytest.raises(DataError) as caught:
            bench.engine.readouts(plan, "b", bench.work())
        assert caught.value.node == "a"
        assert bench.engine.value(plan, "make.image", bench.work()).shape == (4, 6)

    def test_errors_of_factors_carry_the_factor_s_node(self, bench):
        document = network(CHAIN, CHAIN_LINKS).with_parameter("blur", "sigma", 101)
        plan = bench.engine.plan(document)
        for port in ("back.image", "bin.image", "blur.mtf", "blur.magnitude"):
            with pytest.raises(ParameterError, match="101") as caught:
                bench.engine.value(plan, port, bench.work())
            assert caught.value.node == "blur"

    def test_an_error_is_not_kept(self, bench):
        document = network({**LINE, "a": ("scale", {"factor": 13})})
        for _ in range(2):
            with pytest.raises(DataError):
                bench.get(document, "a.image")
        assert bench.get(document.with_parameter("a", "factor", 14), "a.image")[0, 1] == 14


# Planning again from an earlier plan: what has not changed is taken over.


@pytest.fixture
def opened(request):
    library = standard_library()
    folder = request.config.rootpath / "networks"
    network = load_network(folder / "kodak_kir310.json", library=library)
    network = network.with_parameter("scene", "width", 64).with_parameter("scene", "height", 64)
    return Engine(library), network


def test_an_edit_plans_what_hangs_on_it(opened):
    engine, network = opened
    first = engine.plan(network)
    edited = network.with_parameter("aberration", "sigma_x_mrad", 0.3)
    again = engine.plan(edited, previous=first)
    kept = {name for name in network.nodes if again.nodes[name] is first.nodes[name]}
    assert {"scene", "photons", "init", "pupil", "optics", "charge_phase"} <= kept
    assert not kept & {"aberration", "detector", "charge", "back", "pixels", "electronics"}


@pytest.mark.parametrize(
    "edit",
    [
        lambda n: n.with_parameter("electronics", "amplifier_snr", 7),
        lambda n: n.with_seed(5),
        lambda n: replace(n, links=tuple(k for k in n.links if k.target != "slices")),
        lambda n: replace(
            n, nodes={**n.nodes, "charge": replace(n.nodes["charge"], disabled=True)}
        ),
    ],
)
def test_the_result_is_that_of_planning_afresh(opened, edit):
    engine, network = opened
    first = engine.plan(network)
    edited = edit(network)
    afresh, again = engine.plan(edited), engine.plan(edited, previous=first)
    assert [str(e) for e in again.errors()] == [str(e) for e in afresh.errors()]
    if not afresh.errors():
        work = engine.work(Policy())
        port = "frame_grabber.image"
        assert again.output(port).key == afresh.output(port).key
        assert np.isfinite(engine.value(again, port, work)).all()


def test_files_are_looked_at_again(opened, tmp_path):
    engine, network = opened
    path = tmp_path / "in.npy"
    np.save(path, np.ones((4, 5)))
    scene = replace(network.nodes["scene"], module="read_image", params={"path": str(path)})
    reading = replace(network, nodes={**network.nodes, "scene": scene})
    first = engine.plan(reading)
    np.save(path, np.ones((6, 5)))
    again = engine.plan(reading, previous=first)
    assert again.output("scene.image").shape == (6, 5)


def test_nodes_held_back_stay_as_they_were_and_the_rest_builds_on_them(opened):
    engine, network = opened
    first = engine.plan(network)
    held = {"aberration": first.nodes["aberration"]}
    edited = network.with_parameter("aberration", "sigma_x_mrad", 0.3)
    again = engine.plan(edited, previous=first, held=held)
    assert again.network is edited
    assert all(again.nodes[name] is first.nodes[name] for name in network.nodes)
    further = engine.plan(
        edited.with_parameter("charge", "efficiency", 0.9), previous=again, held=held
    )
    assert further.nodes["aberration"] is first.nodes["aberration"]
    own = {factor.node for factor in further.output("back.image").recipe.magnitude.factors}
    assert own >= {"aberration", "charge"}
    assert further.output("back.image").key != first.output("back.image").key
    freed = engine.plan(edited, previous=further)
    assert freed.output("back.image").key == engine.plan(edited).output("back.image").key
    assert freed.output("back.image").key != first.output("back.image").key


def test_an_input_without_a_wire_is_an_error_of_its_own_kind(opened):
    engine, network = opened
    cut = replace(network, links=tuple(k for k in network.links if k.target != "back"))
    plan = engine.plan(cut)
    assert isinstance(plan.nodes["back"].error, UnconnectedError)
    assert str(plan.nodes["back"].error) == "back: input magnitude is not connected"


# What is computed, how often, and a store that engines share.


class TestOnce:
    def test_a_change_computes_what_follows_it_and_no_more(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        assert bench.computed == ["make", "a", "b"]
        bench.computed.clear()
        bench.get(document.with_parameter("b", "factor", 4), "b.image")
        assert bench.computed == ["b"]
        bench.computed.clear()
        bench.get(document.with_parameter("a", "factor", 7), "b.image")
        assert bench.computed == ["a", "b"]

    def test_what_is_no_part_of_the_key_computes_nothing(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        bench.computed.clear()
        renamed = network({"m2": LINE["make"], "x": LINE["a"], "y": LINE["b"]})
        whole = document.with_parameter("a", "factor", 2).with_parameter("make", "level", -0.0)
        for other in (renamed, whole, replace(document, name="x", layout={"a": (1.0, 2.0)})):
            bench.get(other, "y.image" if other is renamed else "b.image")
        bench.get(document.with_parameter("a", "mode", "shown"), "b.image")
        assert bench.computed == []

    def test_precisions_are_kept_apart(self, bench):
        plan = bench.engine.plan(network(LINE))
        for precision, dtype in (("single", np.float32), ("double", np.float64)) * 2:
            work = bench.engine.work(Policy(precision=precision), progress=bench.computed.append)
            assert bench.engine.value(plan, "b.image", work).dtype == dtype
        assert len(bench.computed) == 6

    def test_threads_are_no_part_of_the_key(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        for threads in (1, 2, 0):
            policy = Policy(precision="double", threads=threads)
            work = bench.engine.work(policy, progress=bench.computed.append)
            bench.engine.value(plan, "bin.image", work)
        assert len(bench.computed) == len(set(bench.computed)) + bench.computed.count("back") - 1

    def test_readouts_are_kept_too(self, bench):
        plan = bench.engine.plan(network(LINE))
        assert bench.engine.readouts(plan, "a", bench.work()) == {"mean": 23.0, "mean_in": 11.5}
        count = len(bench.computed)
        bench.engine.readouts(plan, "a", bench.work())
        assert len(bench.computed) == count

    def test_the_bits_do_not_depend_on_what_was_looked_at_before(self):
        ports = ["bin.image", "back.image", "make.image", "blur.magnitude", "init.phase"]
        document = network(CHAIN, CHAIN_LINKS)
        alone = {port: Bench().get(document, port) for port in ports}
        for order in (ports, ports[::-1], ports[2:] + ports[:2]):
            bench = Bench()
            for port in order:
                assert np.array_equal(bench.get(document, port), alone[port])


class TestSharedStore:
    def test_many_threads_many_ports(self):
        document = network(CHAIN, CHAIN_LINKS)
        expected = {p: Bench().get(document, p) for p in ("bin.image", "back.image", "make.image")}
        bench, faults = Bench(Store(capacity_bytes=700)), []

        def ask(port):
            try:
                for _ in range(10):
                    assert np.array_equal(bench.get(document, port), expected[port])
            except BaseException as fault:
                faults.append(fault)

        threads = [
            threading.Thread(target=ask, args=(port,)) for port in expected for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(20)
        assert not any(thread.is_alive() for thread in threads)
        assert faults == []


# What is handed out, what is told on the way, and cancelling.


class TestHandedOut:
    @pytest.mark.parametrize("port", ["make.image", "back.image", "bin.image", "a.image"])
    def test_pictures_are_read_only(self, bench, port):
        nodes = {**CHAIN, "a": ("scale", {})}
        array = bench.get(network(nodes, [*CHAIN_LINKS, ("bin.image", "a.image")]), port)
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1

    def test_plans_pickle(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        again = pickle.loads(pickle.dumps(plan.output("bin.image")))
        assert again.key == plan.output("bin.image").key


class TestCancel:
    def test_before_anything(self, bench):
        stop = threading.Event()
        stop.set()
        with pytest.raises(Cancelled):
            bench.get(network(LINE), "b.image", bench.work(cancel=stop))
        assert bench.computed == []

    @pytest.mark.parametrize("at", ["b", "a", "make"])
    def test_midway(self, bench, at):
        stop = threading.Event()
        seen: list[str | None] = []

        def progress(node):
            seen.append(node)
            if node == at:
                stop.set()

        work = bench.engine.work(Policy(precision="double"), cancel=stop, progress=progress)
        with pytest.raises(Cancelled) as caught:
            bench.get(network(LINE), "b.image", work)
        assert caught.value.exit_code == 1
        assert seen[-1] in (at, "make")
        # Nothing is left behind that keeps it from going on.
        assert bench.get(network(LINE), "b.image")[0, 1] == 6

    @pytest.mark.parametrize("threads", [1, 2])
    def test_within_a_long_step(self, threads):
        """Blocks of rows are the unit in which a filter can be stopped."""
        calls = []
        stop = threading.Event()
        work = Work(Policy(threads=threads), Store(), stop)

        def one(item):
            calls.append(item)
            if len(calls) == 3:
                stop.set()

        with pytest.raises(Cancelled):
            work.for_each(one, range(1000))
        assert len(calls) < 1000


# Disabled nodes pass their main input through.


def disabled(document, name):
    return replace(
        document, nodes={**document.nodes, name: replace(document.nodes[name], disabled=True)}
    )


class TestDisabled:
    def test_what_hangs_on_an_output_that_has_gone_says_so(self, bench):
        plan = bench.engine.plan(disabled(network(CHAIN, CHAIN_LINKS), "init"))
        assert plan.errors()
        assert {error.node for error in plan.errors()} <= {"blur", "back"}
        with pytest.raises(NetworkError, match="init"):
            plan.output("bin.image")

    def test_wrong_parameters_of_a_disabled_node_are_still_errors(self, bench):
        document = disabled(network(LINE), "a").with_parameter("a", "factor", "x")
        assert [error.node for error in bench.engine.plan(document).errors()] == ["a"]


# --- Chains of many stages on a wire: their keys, and how long they may be ---


GRID = Grid(8, 8, 0.1, 0.1)


def blur(frequency, sigma_mrad):
    return np.exp(-2 * (np.pi * sigma_mrad * frequency) ** 2)


def stage(number):
    law = Law.of(blur, sigma_mrad=0.001 * number)
    return Separable(x=law, y=law, node=f"n{number}")


def test_a_key_tells_of_the_stages_and_not_of_how_they_came_together():
    stages = tuple(stage(number) for number in range(4))
    whole = Magnitude(None, GRID, factors=stages)
    bare = Magnitude(None, GRID)
    assert bare.times(*stages).key == whole.key
    assert bare.times(*stages[:1]).times(*stages[1:3]).times(stages[3]).key == whole.key
    assert Magnitude(None, GRID, factors=stages[:3]).times(stages[3]).key == whole.key
    others = (stages[:3], stages[1:], (*stages[:2], stages[3], stages[2]), (*stages, stages[3]))
    assert len({Magnitude(None, GRID, factors=other).key for other in others} | {whole.key}) == 5


def test_a_chain_beyond_the_budget_is_refused():
    longest = Magnitude(None, GRID, factors=(stage(1),) * MOST_STAGES)
    with pytest.raises(
        NetworkError, match=r"^5,001 stages in one chain; at most 5,000 are allowed$"
    ):
        longest.times(stage(2))
