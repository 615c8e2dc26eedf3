"""Networks whose parameters follow others: values, refusals, files."""

import json

import pytest

from child_process import ROOT
from core.chain.engine import Engine
from core.errors import ParameterError
from core.network.file import VERSION, format_network, load_network, parse_network
from core.network.linked_values import expression, with_values
from core.network.network import Network, Node
from core.network.validation import problems
from nodes.library import standard_library


def linked(document, small_library, **params):
    """The document with expressions, by ``node__parameter``."""
    for name, text in params.items():
        node, _, parameter = name.partition("__")
        document["nodes"][node].setdefault("params", {})[parameter] = (
            {"expression": text} if isinstance(text, str) else text
        )
    return parse_network(json.dumps(document), library=small_library)


def refusals(network, small_library):
    found = problems(network, library=small_library, unfinished=True)
    assert all("\n" not in str(one) for one in found)
    return [str(one) for one in found]


def test_values_take_the_place_of_expressions(document, small_library):
    network = linked(
        document,
        small_library,
        jitter__sigma_mrad="init.focal_length_mm / 400 + look.level",
        look__level="init.near_m * 2",
        scene__width="2 * init.focal_length_mm",
        init__far_m="5 km",
    )
    resolved = with_values(network, library=small_library)
    assert not resolved.faults
    # By hand: near_m is left at its default, 1.
    nodes = resolved.network.nodes
    assert nodes["look"].params["level"] == 2.0
    assert nodes["jitter"].params["sigma_mrad"] == 2.5
    assert nodes["init"].params == {"focal_length_mm": 200, "far_m": 5000.0}
    assert nodes["scene"].params["width"] == 400
    assert type(nodes["scene"].params["width"]) is int


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("int.near_m", "int.near_m names int, which is not a node; did you mean init?"),
        ("init.nearm", "Init & Trans has no parameter init.nearm; did you mean near_m?"),
        ("scene.kind", "scene.kind is point; an expression needs numbers"),
        ("scene.path", "scene.path is empty"),
        ("jitter.sigma_mrad", "follows itself: jitter.sigma_mrad → jitter.sigma_mrad"),
    ],
)
def test_one_line_says_what_is_wrong(text, part, document, small_library):
    network = linked(document, small_library, jitter__sigma_mrad=text)
    (line,) = refusals(network, small_library)
    assert line.startswith("jitter: sigma_mrad = ")
    assert part in line
    assert line.endswith(" The result must be a number of at least 0 (mrad)")
    assert len(line) < 400


def test_a_cycle_is_refused_with_the_way_round(document, small_library):
    network = linked(
        document,
        small_library,
        jitter__sigma_mrad="init.near_m",
        init__near_m="look.level",
        look__level="jitter.sigma_mrad + 1",
        init__far_m="init.near_m + 1",
    )
    found = refusals(network, small_library)
    way = "init.near_m → jitter.sigma_mrad → look.level → init.near_m"
    assert sum(way in line for line in found) == 3
    assert any(
        "far_m = init.near_m + 1" in line
        and "has no value until its own error is corrected" in line
        for line in found
    )


@pytest.mark.parametrize(
    ("place", "allowed"),
    [
        ("scene__kind", "one of dormitory, point"),
        ("scene__path", "a file name"),
        ("scene__spots", "a list of numbers"),
    ],
)
def test_only_numbers_follow(place, allowed, document, small_library):
    network = linked(document, small_library, **{place: "init.near_m"})
    (line,) = refusals(network, small_library)
    assert (
        "only a numeric parameter can follow other parameters, but this parameter must be "
        + allowed
        in line
    )


def test_what_is_no_expression_is_refused(document, small_library):
    for raw, part in (
        ({"expression": 5}, "an expression must be text"),
        ({"expression": "1", "more": 2}, "only the field expression is allowed; remove more"),
        ({"other": "1"}, "a number of at least 0"),
    ):
        network = linked(document, small_library, jitter__sigma_mrad=raw)
        (line,) = refusals(network, small_library)
        assert part in line


def test_what_each_combination_gives_is_checked(document, small_library):
    """`check` of a module sees the values: here that the nearest is not beyond the farthest."""
    network = linked(document, small_library, init__near_m="init.far_m + 3")
    (line,) = refusals(network, small_library)
    assert "near_m = 5" in line
    assert "at most far_m = 2" in line


def test_the_file_is_of_the_version_that_it_needs(document, small_library):
    plain = parse_network(json.dumps(document), library=small_library)
    assert json.loads(format_network(plain, library=small_library))["version"] == 1
    network = linked(document, small_library, jitter__sigma_mrad="init.near_m * 2")
    text = format_network(network, library=small_library)
    assert json.loads(text)["version"] == 2 == VERSION
    assert '        "sigma_mrad": {"expression": "init.near_m * 2"}\n' in text
    assert parse_network(text, library=small_library) == network
    assert format_network(parse_network(text, library=small_library), library=small_library) == text


def test_a_long_way_of_links_needs_no_stack(small_library):
    nodes = {"n0": Node("n0", "jitter_mtf", {"sigma_mrad": 0.25})}
    for number in range(1, 3000):
        name = f"n{number}"
        nodes[name] = Node(
            name, "jitter_mtf", {"sigma_mrad": expression(f"n{number - 1}.sigma_mrad + 1")}
        )
    # Written down from the last to the first.
    network = Network(nodes=dict(reversed(nodes.items())))
    resolved = with_values(network, library=small_library)
    assert resolved.network.nodes["n2999"].params["sigma_mrad"] == 2999.25


def test_plans_keys_and_errors_meet_values(library_and_linked):
    library, plain, network = library_and_linked
    engine = Engine(library)
    one, other = engine.plan(plain), engine.plan(network)
    assert other.output("blur.magnitude").key == one.output("blur.magnitude").key
    assert other.nodes["blur"].node.params["sigma_x_mrad"] == 0.5
    again = engine.plan(network, previous=other)
    assert again.nodes["blur"] is other.nodes["blur"]
    moved = engine.plan(network.with_parameter("init", "f_number", 3.0), previous=other)
    assert moved.nodes["blur"].node.params["sigma_x_mrad"] == 0.75
    broken = network.with_parameter("blur", "sigma_x_mrad", expression("1/0"))
    plan = engine.plan(broken)
    assert isinstance(plan.nodes["blur"].error, ParameterError)
    assert plan.nodes["blur"].error.node == "blur"
    assert plan.nodes["init"].error is None


@pytest.fixture
def library_and_linked():
    library = standard_library()
    network = load_network(ROOT / "networks" / "first_steps.json", library=library)
    network = network.with_parameter("init", "f_number", 2.0)
    plain = network.with_parameter("blur", "sigma_x_mrad", 0.5)
    return (
        library,
        plain,
        network.with_parameter("blur", "sigma_x_mrad", expression("init.f_number / 4")),
    )
