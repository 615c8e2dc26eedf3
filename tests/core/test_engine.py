"""Planning, evaluating and the store: what is computed, how often, and where errors go."""

from __future__ import annotations

import itertools
import pickle
import threading
import time
from dataclasses import replace
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pytest

from core.declaration import Here, Module, readout
from core.delivered import back_transform, combine_pixels
from core.engine import Engine
from core.errors import Cancelled, DataError, NetworkError, ParameterError
from core.factors import Law, Separable
from core.network import Link, Network, Node
from core.parameters import Param
from core.policy import Policy
from core.recipes import Step
from core.store import Store
from core.values import Context, Image, Magnitude, Phase, Transfer
from core.work import Work

# ---------------------------------------------------------------- a small library


class ImageOut(NamedTuple):
    image: Image


class TwoOut(NamedTuple):
    image: Image
    noise: Image


class InitOut(NamedTuple):
    context: Context
    magnitude: Magnitude
    phase: Phase


class MtfOut(NamedTuple):
    magnitude: Magnitude
    mtf: Transfer


def ramp(work: Work, *, rows: int, columns: int, level: float) -> np.ndarray:
    return (np.arange(rows * columns, dtype=work.policy.dtype) + level).reshape(rows, columns)


def scaled(work: Work, image: np.ndarray, *, factor: float) -> np.ndarray:
    if factor == 13:
        raise DataError("thirteen brings bad luck")
    return np.asarray(image * image.dtype.type(factor))


def added(work: Work, image: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(image + other)


def mean_of(work: Work, image: np.ndarray) -> float:
    return float(image.mean())


def gaussian(frequency: np.ndarray, sigma: float) -> np.ndarray:
    if sigma > 100:
        raise ParameterError("sigma", sigma, "at most 100")
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


class Maker(Module, key="maker", title="Maker", group="Test"):
    """Make a ramp."""

    level: Annotated[float, Param("lowest sample")] = 0.0
    columns: Annotated[int, Param("size", low=1)] = 6

    def run(self, here: Here) -> ImageOut:
        if self.level == -13:
            raise ParameterError("level", self.level, "anything but -13")
        rows = 4
        recipe = Step.of(ramp, node=here.node, rows=rows, columns=self.columns, level=self.level)
        return ImageOut(Image(recipe, rows, self.columns, 1.0, 1.0))


class Scale(Module, key="scale", title="Scale", group="Test"):
    """Multiply."""

    factor: Annotated[float, Param("factor")] = 2.0
    mode: Annotated[Literal["plain", "shown"], Param("no matter")] = "plain"

    def run(self, image: Image, here: Here) -> TwoOut:
        if self.factor == 1:
            return TwoOut(image, image)
        recipe = Step.of(scaled, image.recipe, node=here.node, factor=self.factor)
        noise = Step.of(added, recipe, image.recipe, node=here.node)
        return TwoOut(image.with_recipe(recipe), image.with_recipe(noise))

    @readout()
    def mean(self, outputs: TwoOut) -> Step:
        """Mean of the picture."""
        return Step.of(mean_of, outputs.image.recipe)

    @readout()
    def mean_in(self, image: Image) -> Step:
        """Mean of what comes in."""
        return Step.of(mean_of, image.recipe)


class Sum(Module, key="sum", title="Sum", group="Test"):
    """Add two pictures, or one to itself."""

    def run(self, image: Image, other: Image | None = None) -> ImageOut:
        second = other if other is not None else image
        return ImageOut(image.with_recipe(Step.of(added, image.recipe, second.recipe)))


class Init(Module, key="init", title="Init", group="Test"):
    """To the spectrum."""

    def run(self, image: Image) -> InitOut:
        grid = image.grid()
        context = Context(grid, "reflect", "line", None, None, None, None, None, 1.0, 1.0, 0.0, 0.0)
        return InitOut(context, Magnitude(image, grid), Phase(image, grid))


class Blur(Module, key="blur", title="Blur", group="Test"):
    """Gaussian."""

    sigma: Annotated[float, Param("width", low=0)] = 1.0

    def run(self, context: Context, magnitude: Magnitude, here: Here) -> MtfOut:
        law = Law.of(gaussian, sigma=self.sigma)
        factors = (Separable(law, law, node=here.node),) if self.sigma else ()
        return MtfOut(magnitude.times(*factors), Transfer(context.grid, "mtf", factors))


class Back(Module, key="back", title="Back", group="Test"):
    """To the picture."""

    def run(self, magnitude: Magnitude, phase: Phase, here: Here) -> ImageOut:
        return ImageOut(back_transform(magnitude, phase, node=here.node))


class Bin(Module, key="bin", title="Bin", group="Test"):
    """Two by two."""

    def run(self, image: Image, here: Here) -> ImageOut:
        return ImageOut(combine_pixels(image, factor_x=2, factor_y=2, node=here.node))


MODULES: tuple[type[Module], ...] = (Maker, Scale, Sum, Init, Blur, Back, Bin)
LIBRARY: dict[str, type[Module]] = {module.key: module for module in MODULES}


def network(nodes: dict[str, Any], links: list[tuple[str, str]] | None = None) -> Network:
    """Nodes by name as ``(key, parameters)``; without links each follows the one before."""
    names = list(nodes)
    if links is None:
        links = [(f"{a}.image", f"{b}.image") for a, b in itertools.pairwise(names)]
    return Network(
        nodes={name: Node(name, key, params) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )


LINE = {"make": ("maker", {}), "a": ("scale", {}), "b": ("scale", {"factor": 3})}
CHAIN = {
    "make": ("maker", {}), "init": ("init", {}), "blur": ("blur", {}), "back": ("back", {}),
    "bin": ("bin", {}),
}  # fmt: skip
CHAIN_LINKS = [
    ("make.image", "init.image"), ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"), ("blur.magnitude", "back.magnitude"),
    ("init.phase", "back.phase"), ("back.image", "bin.image"),
]  # fmt: skip


class Bench:
    """An engine that counts what it computes."""

    def __init__(self, store: Store | None = None) -> None:
        self.engine = Engine(LIBRARY, store)
        self.computed: list[str | None] = []

    def work(self, **how: Any) -> Work:
        policy = Policy(precision="double", threads=1)
        return self.engine.work(policy, progress=self.computed.append, **how)

    def get(self, document: Network, port: str, work: Work | None = None) -> Any:
        return self.engine.value(self.engine.plan(document), port, work or self.work())


@pytest.fixture
def bench():
    return Bench()


# ---------------------------------------------------------------- planning


FITTING = [("make.image", "a.image")]


class TestPlan:
    def test_planning_computes_nothing(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        assert plan.errors() == []
        assert bench.computed == []
        assert len(bench.engine.store) == 0

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

    def test_two_links_into_one_input_are_an_error_or_refused(self, bench):
        document = network({"make": ("maker", {}), "more": ("maker", {"level": 5}),
                            "a": ("scale", {})},
                           [("make.image", "a.image"), ("more.image", "a.image")])  # fmt: skip
        assert [error.node for error in bench.engine.plan(document).errors()] == ["a"]

    def test_a_cycle_is_one_error(self, bench):
        document = network({"a": ("scale", {}), "b": ("scale", {})},
                           [("a.image", "b.image"), ("b.image", "a.image")])  # fmt: skip
        with pytest.raises(NetworkError, match="cycle"):
            bench.engine.plan(document)

    @pytest.mark.parametrize("port", ["ghost.image", "make.ghost", "make", "", "make.image.x"])
    def test_asking_for_what_is_not_there(self, bench, port):
        plan = bench.engine.plan(network(LINE))
        with pytest.raises(NetworkError):
            bench.engine.value(plan, port, bench.work())

    def test_readouts_of_an_unknown_node(self, bench):
        with pytest.raises(NetworkError, match="ghost"):
            bench.engine.readouts(bench.engine.plan(network(LINE)), "ghost", bench.work())

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


# ---------------------------------------------------------------- disabled nodes


def disabled(document: Network, name: str) -> Network:
    return replace(
        document, nodes={**document.nodes, name: replace(document.nodes[name], disabled=True)}
    )


class TestDisabled:
    def test_passes_its_main_input_through(self, bench):
        document = network(LINE)
        plan = bench.engine.plan(disabled(document, "a"))
        assert plan.output("a.image").key == plan.output("make.image").key
        assert np.array_equal(
            bench.engine.value(plan, "b.image", bench.work())[0], 3.0 * np.arange(6)
        )
        assert (
            "noise" not in plan.nodes["a"].outputs
        )  # a module's noise is no picture to go on with

    def test_a_filter_becomes_the_identity(self, bench):
        document = network(CHAIN, CHAIN_LINKS)
        plan = bench.engine.plan(disabled(document, "blur"))
        assert plan.errors() == []
        assert plan.output("blur.magnitude").key == plan.output("init.magnitude").key
        assert np.all(bench.engine.value(plan, "blur.mtf", bench.work()) == 1)
        picture = bench.engine.value(plan, "back.image", bench.work())
        assert np.allclose(picture, np.arange(24.0).reshape(4, 6), atol=1e-13)

    def test_what_hangs_on_an_output_that_has_gone_says_so(self, bench):
        plan = bench.engine.plan(disabled(network(CHAIN, CHAIN_LINKS), "init"))
        assert plan.errors()
        assert {error.node for error in plan.errors()} <= {"blur", "back"}
        with pytest.raises(NetworkError, match="init"):
            plan.output("bin.image")

    def test_readouts_of_a_disabled_node_do_not_fail(self, bench):
        plan = bench.engine.plan(disabled(network(LINE), "a"))
        found = bench.engine.readouts(plan, "a", bench.work())
        assert found.get("mean") in (None, 11.5)

    def test_wrong_parameters_of_a_disabled_node_are_still_errors(self, bench):
        document = disabled(network(LINE), "a").with_parameter("a", "factor", "x")
        assert [error.node for error in bench.engine.plan(document).errors()] == ["a"]


# ---------------------------------------------------------------- once and no more


class TestOnce:
    def test_an_unchanged_network_computes_nothing_again(self, bench):
        document = network(CHAIN, CHAIN_LINKS)
        ports = ("bin.image", "back.image", "blur.mtf", "blur.magnitude", "init.phase")
        for port in ports:
            bench.get(document, port)
        count = len(bench.computed)
        assert count > 0
        for port in ports:
            bench.get(document, port)
        assert len(bench.computed) == count

    def test_a_change_computes_what_follows_it_and_no_more(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        assert bench.computed == ["b", "a", "make"]
        bench.computed.clear()
        bench.get(document.with_parameter("b", "factor", 4), "b.image")
        assert bench.computed == ["b"]
        bench.computed.clear()
        bench.get(document.with_parameter("a", "factor", 7), "b.image")
        assert bench.computed == ["b", "a"]

    def test_going_back_computes_nothing(self, bench):
        document = network(LINE)
        bench.get(document, "b.image")
        bench.get(document.with_parameter("a", "factor", 7), "b.image")
        bench.computed.clear()
        bench.get(document, "b.image")
        assert bench.computed == []

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

    def test_a_new_blur_keeps_the_spectrum(self, bench):
        document = network(CHAIN, CHAIN_LINKS)
        bench.get(document, "bin.image")
        first = len(bench.computed)
        bench.computed.clear()
        bench.get(document.with_parameter("blur", "sigma", 2), "bin.image")
        assert len(bench.computed) == 1 < first
        bench.computed.clear()
        bench.get(document.with_parameter("blur", "sigma", 2), "back.image")
        assert "make" not in bench.computed

    def test_a_picture_shared_by_two_nodes_is_made_once(self, bench):
        document = network({**LINE, "c": ("scale", {"factor": 2.0}), "s": ("sum", {})},
                           [("make.image", "a.image"), ("make.image", "c.image"),
                            ("a.image", "s.image"), ("c.image", "s.other")])  # fmt: skip
        bench.get(document, "s.image")
        assert bench.computed.count("make") == 1
        assert len([node for node in bench.computed if node in ("a", "c")]) == 1

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


# ---------------------------------------------------------------- arrays, progress, cancelling


class TestHandedOut:
    @pytest.mark.parametrize("port", ["make.image", "back.image", "bin.image", "a.image"])
    def test_pictures_are_read_only(self, bench, port):
        nodes = {**CHAIN, "a": ("scale", {})}
        array = bench.get(network(nodes, [*CHAIN_LINKS, ("bin.image", "a.image")]), port)
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1

    def test_the_same_array_is_handed_out(self, bench):
        document = network(LINE)
        assert bench.get(document, "b.image") is bench.get(document, "b.image")

    def test_plans_pickle(self, bench):
        plan = bench.engine.plan(network(CHAIN, CHAIN_LINKS))
        again = pickle.loads(pickle.dumps(plan.output("bin.image")))
        assert again.key == plan.output("bin.image").key


class TestProgress:
    def test_is_told_each_node_before_it_is_computed(self, bench):
        bench.get(network(LINE), "b.image")
        assert bench.computed == ["b", "a", "make"]

    def test_chain_tells_its_nodes(self, bench):
        bench.get(network(CHAIN, CHAIN_LINKS), "bin.image")
        assert {"make", "back"} <= set(bench.computed)


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

        def progress(node: str | None) -> None:
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

        def one(item: int) -> None:
            calls.append(item)
            if len(calls) == 3:
                stop.set()

        with pytest.raises(Cancelled):
            work.each(one, range(1000))
        assert len(calls) < 1000

    def test_from_another_thread(self):
        stop = threading.Event()
        work = Work(Policy(), Store(), stop)
        threading.Timer(0.05, stop.set).start()

        def wait() -> None:
            begin = time.monotonic()
            while time.monotonic() - begin < 5:
                work.check()
                time.sleep(0.001)

        with pytest.raises(Cancelled):
            wait()

    def test_errors_in_threads_come_out(self):
        work = Work(Policy(threads=2), Store())

        def one(item: int) -> None:
            if item == 7:
                raise DataError("seven")

        with pytest.raises(DataError, match="seven"):
            work.each(one, range(20))


# ---------------------------------------------------------------- one store for all


class TestSharedStore:
    def test_engines_may_share_it(self):
        store = Store()
        one, two = Bench(store), Bench(store)
        one.get(network(LINE), "b.image")
        two.get(network(LINE), "b.image")
        assert two.computed == []

    def test_a_tiny_store_gives_the_same_pictures(self):
        document = network(CHAIN, CHAIN_LINKS)
        small = Bench(Store(capacity_bytes=1))
        assert np.array_equal(small.get(document, "bin.image"), Bench().get(document, "bin.image"))
        assert small.engine.store.used_bytes <= 1

    def test_many_threads_many_ports(self):
        document = network(CHAIN, CHAIN_LINKS)
        expected = {p: Bench().get(document, p) for p in ("bin.image", "back.image", "make.image")}
        bench, faults = Bench(Store(capacity_bytes=700)), []

        def ask(port: str) -> None:
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
