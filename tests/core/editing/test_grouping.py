"""Parameters that follow others, in and around macros: whatever is grouped, the values stay."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.document import Document
from core.editing.macros import at_level, expose, group, hide, rename_exposed, ungroup
from core.editing.operations import keeping_values, rename_node, set_node_field, set_parameter
from core.editing.wiring import dissolved
from core.errors import NetworkError
from core.network.file import format_network, parse_network
from core.network.linked_values import expression, resolved
from core.network.macro import path_of
from core.network.validation import problems

LIMITS = settings(
    deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
LINKS = {
    ("aberration", "sigma_x_mrad"): "init.f_number * 2 / 1000",
    ("aberration", "sigma_y_mrad"): "aberration.sigma_x_mrad * 10",
    ("optics", "size_x_cm"): "aberration.sigma_y_mrad + init.focal_length_mm * 0.064",
    ("electronics", "bias_percent"): "init.focal_length_mm / 100 + optics.size_x_cm",
}


@pytest.fixture
def linked(shipped):
    """The Kodak's network with parameters that follow others, across most of the chain."""
    network = shipped["kodak_kir310"]
    for (node, name), text in LINKS.items():
        network = network.with_parameter(node, name, expression(text))
    return network


def values(network, library):
    """Value of every parameter that follows others, or did, by the node's own id."""
    plain = resolved(network, library=library)
    assert not plain.faults
    found = {}
    for name, node in plain.network.nodes.items():
        own = path_of(network, name)[-1]
        for place, value in node.params.items():
            if (own, place) in LINKS:
                found[own, place] = value
    return found


def truth(network):
    """The same by hand: one formula each."""
    init = network.nodes["init"].params
    sigma_x = init["f_number"] * 2 / 1000
    sigma_y = sigma_x * 10
    optics = sigma_y + init["focal_length_mm"] * 0.064
    bias = init["focal_length_mm"] / 100 + optics
    return dict(zip(LINKS, (sigma_x, sigma_y, optics, bias), strict=True))


def same(found, wanted):
    assert found.keys() == wanted.keys()
    for place, value in wanted.items():
        assert found[place] == pytest.approx(value, rel=1e-14)


@LIMITS
@given(data=st.data())
def test_grouping_any_nodes_changes_no_value_and_comes_undone(data, linked, library):
    names = list(linked.nodes)
    members = data.draw(st.lists(st.sampled_from(names), min_size=1, unique=True))
    wanted = truth(linked)
    same(values(linked, library), wanted)
    try:
        name, step = group(linked, library, members, "camera")
    except NetworkError:  # a way leads out of them and back in
        return
    macro = step.apply(linked)
    same(values(macro, library), wanted)
    assert not problems(macro, library=library)
    text = format_network(macro, library=library)
    assert json.loads(text)["version"] == 2
    assert parse_network(text, library=library) == macro
    # From outside it still follows.
    lens = "init" if "init" in macro.nodes else "camera/init"
    other = Document(macro, library=library)
    other.do(set_parameter(lens, "f_number", 7.0))
    same(values(other.network, library), truth(linked.with_parameter("init", "f_number", 7.0)))
    _, back = ungroup(macro, library, name)
    assert back.apply(macro) == linked


@LIMITS
@given(data=st.data())
def test_a_macro_in_a_macro_changes_no_value(data, linked, library):
    members = ["init", "aberration", "jitter", "electronics"]
    inner = data.draw(st.lists(st.sampled_from(members), min_size=1, max_size=3, unique=True))
    wanted = truth(linked)
    try:
        macro = group(linked, library, members, "camera")[1].apply(linked)
        body = macro.nodes["camera"].macro
        step = at_level(("camera",), group(body, library, inner, "lens", "camera/")[1])
        deeper = step.apply(macro)
    except NetworkError:
        return
    same(values(deeper, library), wanted)
    renamed = at_level(("camera",), rename_node("lens", "front lens")).apply(deeper)
    renamed = rename_node("camera", "the camera").apply(renamed)
    same(values(renamed, library), wanted)
    body = renamed.nodes["the camera"].macro
    step = at_level(("the camera",), ungroup(body, library, "front lens", "the camera/")[1])
    flat = step.apply(renamed)
    same(values(flat, library), wanted)
    _, back = ungroup(flat, library, "the camera")
    assert back.apply(flat) == linked


@pytest.fixture
def camera(linked, library):
    """Aberration and optics in a macro: they follow nodes outside, the electronics follow them."""
    made = group(linked, library, ["aberration", "optics"], "camera")[1].apply(linked)
    return Document(made, library=library)


def test_a_node_renamed_inside_is_followed_outside(camera, library):
    wanted = values(camera.network, library)["electronics", "bias_percent"]
    camera.do(rename_node("camera/optics", "glass"))
    text = camera.network.nodes["electronics"].params["bias_percent"]["expression"]
    assert text == "init.focal_length_mm / 100 + 'camera/glass'.size_x_cm"
    assert values(camera.network, library)["electronics", "bias_percent"] == wanted


def test_a_name_that_a_macro_shows_is_followed_and_renamed(camera, library):
    camera.do(expose(camera.network, "camera/aberration", "sigma_y_mrad"))
    camera.do(rename_exposed(camera.network, "camera", "sigma_y_mrad", "spot"))
    camera.do(set_parameter("electronics", "bias_percent", expression("camera.spot * 1000")))
    width = values(camera.network, library)["electronics", "bias_percent"]
    assert width == pytest.approx(truth(camera.network)["aberration", "sigma_y_mrad"] * 1000)
    with pytest.raises(NetworkError, match=r"camera.spot cannot be hidden, because electronics"):
        hide(camera.network, "camera", "spot", resolved(camera.network, library=library).value)
    with pytest.raises(NetworkError, match=r"one word of letters, digits and _, not size of"):
        camera.do(rename_exposed(camera.network, "camera", "spot", "size of spot"))
    camera.do(rename_exposed(camera.network, "camera", "spot", "blur"))
    assert camera.network.nodes["electronics"].params["bias_percent"] == expression(
        "camera.blur * 1000"
    )
    assert values(camera.network, library)["electronics", "bias_percent"] == width
    back = ungroup(camera.network, library, "camera")[1].apply(camera.network)
    assert back.nodes["electronics"].params["bias_percent"] == expression(
        "aberration.sigma_y_mrad * 1000"
    )


def test_hiding_what_follows_leaves_the_value(camera, library):
    before = values(camera.network, library)
    shown = next(
        n
        for n, raw in camera.network.nodes["camera"].params.items()
        if raw["expression"].startswith("init.f_number")
    )
    value_of = resolved(camera.network, library=library).value
    camera.do(hide(camera.network, "camera", shown, value_of))
    inside = camera.network.nodes["camera"].macro.nodes["aberration"]
    assert inside.params["sigma_x_mrad"] == before["aberration", "sigma_x_mrad"]
    same(values(camera.network, library), before)


def test_taking_out_what_is_followed_inside_leaves_the_value_in_force(linked, library):
    """Also one that the macro sets from outside, which the inside alone does not know."""
    network = group(linked, library, ["init", "optics", "aberration"], "camera")[1].apply(linked)
    network = expose(network, "camera/init", "f_number").apply(network)
    network = network.with_parameter("camera", "f_number", 8.0)
    body = network.nodes["camera"].macro
    value = resolved(network, library=library).value
    step, kept = keeping_values(
        network=body,
        names=("init",),
        taking=dissolved(body, library, ("init",)),
        value_of=lambda node, name: value(f"camera/{node}", name),
    )
    assert kept == ("optics.size_x_cm = 12.96", "aberration.sigma_x_mrad = 0.016")
    after = at_level(("camera",), step).apply(network)
    assert after.nodes["camera"].macro.nodes["aberration"].params["sigma_x_mrad"] == 0.016


def test_a_disabled_macro_still_gives_its_parameters(camera, library):
    before = values(camera.network, library)["electronics", "bias_percent"]
    camera.do(set_node_field("camera", "disabled", True))
    plain = resolved(camera.network, library=library)
    assert not plain.faults
    assert "camera/optics" not in plain.network.nodes
    assert plain.value("electronics", "bias_percent") == before
    assert not problems(camera.network, library=library, unfinished=True)


def test_faults_name_the_node_inside_and_the_macro(camera, library):
    network = camera.network
    for text, why in (
        ("init.f_numbr", "Init Trans|init"),
        ("'camera/optics'.nothing", "has no parameter"),
        ("camera.nothing", "the macro camera shows no parameter camera.nothing"),
        ("camra.spot", "camra, which is not a node"),
    ):
        wrong = network.with_parameter("electronics", "bias_percent", expression(text))
        (fault,) = problems(wrong, library=library)
        assert fault.node == "electronics"
        assert why.split("|")[0] in fault.message or why.split("|")[-1] in fault.message
    inside = set_parameter("camera/aberration", "sigma_y_mrad", expression("init.f_number")).apply(
        network
    )
    (fault,) = (f for f in problems(inside, library=library) if f.node == "camera/aberration")
    assert "camera/init" in fault.message  # the lens lies outside, and cannot be named from inside


def test_a_cycle_through_a_macros_border_is_refused_with_its_way(camera, library):
    network = camera.network.with_parameter(
        "init", "f_number", expression("'camera/aberration'.sigma_x_mrad")
    )
    faults = problems(network, library=library)
    assert any("follows itself" in fault.message for fault in faults)
