"""What fits, what goes on from a node, nodes put into wires and taken out of them."""

import numpy as np
import pytest

from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.editing.operations import add_nodes, keeping_values, remove_nodes, rewire, set_node_field
from core.editing.wiring import (
    Candidate,
    continued,
    detached,
    dissolved,
    inserted,
    new_node,
    refusal,
    wired_to,
)
from core.errors import NetworkError
from core.evaluation.work import Policy
from core.network.linked_values import resolved
from core.network.network import Link, Network, Node
from core.network.validation import problems
from linked_network import linked_network


def link_of(text):
    return Link.between(*text.split(" → "))


def links_of(*texts):
    return set(map(link_of, texts))


def new_links(network, operation):
    return set(operation.apply(network).links) - set(network.links)


def test_a_new_node_is_named_after_its_module(kodak, library):
    name, operation = new_node(kodak, library, "jitter_mtf", (3, 4))
    assert name == "jitter_mtf"
    network = operation.apply(kodak)
    assert (network.nodes[name].module, network.layout[name]) == ("jitter_mtf", (3, 4))
    assert new_node(network, library, "jitter_mtf", None)[0] == "jitter_mtf_2"
    assert operation.text == "Add jitter_mtf"


def wired(network, library, end, module, port):
    name, operation = wired_to(network, library, end, Candidate(module, port), (0, 0))
    assert name == module
    return new_links(network, operation)


@pytest.mark.parametrize(
    ("end", "module", "port", "others"),
    [
        ("detector.magnitude", "jitter_mtf", "magnitude", {"context": "init.context"}),
        (
            "init.magnitude", "exit_pupil_mtf", "magnitude",
            {"phase": "init.phase", "context": "init.context", "pupil": "pupil.pupil"},
        ),
        # The phase left the magnitude further up, and is led beside the detector's MTFs since.
        ("detector.magnitude", "back_transform", "magnitude", {"phase": "charge_phase.phase"}),
        ("scene.image", "electronics_noise", "image", {"context": "init.context"}),
        # Which of many magnitudes is left open.
        ("init.context", "jitter_mtf", "context", {}),
    ],
)  # fmt: skip
def test_a_new_node_takes_what_is_certain(kodak, library, end, module, port, others):
    found = wired(kodak, library, (*end.split("."), "output"), module, port)
    wires = {port: end, **others}
    assert found == links_of(*(f"{start} → {module}.{to}" for to, start in wires.items()))


def test_a_dropped_phase_finds_its_magnitude(inframetrics, library):
    network = remove_nodes(("back",)).apply(inframetrics)
    found = wired(network, library, ("optics", "phase", "output"), "back_transform", "phase")
    assert found == links_of(
        "optics.phase → back_transform.phase", "optics.magnitude → back_transform.magnitude"
    )


def test_two_contexts_are_none(kodak, library):
    network = new_node(kodak, library, "init_trans", None)[1].apply(kodak)
    found = wired(network, library, ("detector", "magnitude", "output"), "jitter_mtf", "magnitude")
    assert found == links_of("detector.magnitude → jitter_mtf.magnitude")


def test_a_wire_from_an_occupied_input_is_led_through(kodak, library):
    name, operation = wired_to(
        kodak, library, ("back", "magnitude", "input"), Candidate("jitter_mtf", "magnitude"), (1, 2)
    )
    after = operation.apply(kodak)
    assert new_links(kodak, operation) == links_of(
        "charge.magnitude → jitter_mtf.magnitude",
        "jitter_mtf.magnitude → back.magnitude",
        "init.context → jitter_mtf.context",
    )
    assert set(kodak.links) - set(after.links) == links_of("charge.magnitude → back.magnitude")
    assert after.layout[name] == (1, 2)


def test_what_does_not_fit_is_refused(kodak, library):
    for end, candidate in (
        (("init", "phase", "output"), Candidate("jitter_mtf", "magnitude")),
        (("nobody", "phase", "output"), Candidate("jitter_mtf", "magnitude")),
        (("nobody", "phase", "input"), Candidate("charge_eff_phase", "phase")),
        (("init", "image", "input"), Candidate("jitter_mtf", "mtf")),
        (("init", "image", "input"), Candidate("no_module", "image")),
    ):
        with pytest.raises(NetworkError):
            wired_to(kodak, library, end, candidate, (0, 0))


def test_what_does_not_fit_is_left_to_be_added_plainly(kodak, library):
    assert continued(kodak, library, "picture", "test_scene", None) is None
    strange = Network("n", nodes={"s": Node("s", "of another version")})
    assert continued(strange, library, "s", "jitter_mtf", None) is None
    with pytest.raises(NetworkError, match="no module"):
        continued(kodak, library, "scene", "jitter", None)


def test_whatever_is_added_to_whatever_the_network_stays_sound(kodak, library):
    for node in kodak.nodes:
        for module in library:
            onward = continued(kodak, library, node, module, None)
            if onward is not None:
                after = onward[1].apply(kodak)
                assert not problems(after, library=library, unfinished=True), (node, module)
                assert any(
                    {link.source, link.target} == {node, onward[0]} for link in after.links
                ), (node, module)


def dropped(network, library, module, wire):
    """The network with a new node on a wire, or None; and what changed: new links, gone ones."""
    name, adding = new_node(network, library, module, (0, 0))
    grown = adding.apply(network)
    operation = inserted(grown, library, link_of(wire), name)
    if operation is None:
        return None
    after = operation.apply(grown)
    assert not problems(after, library=library, keep_unknown=True, unfinished=True)
    new, gone = set(after.links) - set(grown.links), set(grown.links) - set(after.links)
    return {str(link) for link in new}, {str(link) for link in gone}


@pytest.mark.parametrize("module", ["jitter_mtf", "detector_mtf"])
def test_an_mtf_module_on_a_magnitude_gets_its_context(kodak, inframetrics, library, module):
    for network, wire in (
        (kodak, "detector.magnitude → charge.magnitude"),
        (inframetrics, "aberration.magnitude → jitter.magnitude"),
    ):
        start, end = wire.split(" → ")
        name = f"{module}_2" if module in network.nodes else module
        assert dropped(network, library, module, wire) == (
            {f"{start} → {name}.magnitude", f"{name}.magnitude → {end}",
             f"init.context → {name}.context"},
            {wire},
        )  # fmt: skip


@pytest.mark.parametrize(
    ("magnitude", "phase"),
    [
        ("init.magnitude → optics.magnitude", "init.phase → optics.phase"),
        ("optics.magnitude → aberration.magnitude", "optics.phase → charge_phase.phase"),
        ("charge.magnitude → back.magnitude", "charge_phase.phase → back.phase"),
    ],
)
def test_the_pupil_module_leads_the_phase_through_too(kodak, library, magnitude, phase):
    """The same whether it is dropped on the magnitude or on the phase beside it."""
    (m_start, m_end), (p_start, p_end) = magnitude.split(" → "), phase.split(" → ")
    for wire in (magnitude, phase):
        assert dropped(kodak, library, "exit_pupil_mtf", wire) == (
            {f"{m_start} → exit_pupil_mtf.magnitude", f"exit_pupil_mtf.magnitude → {m_end}",
             f"{p_start} → exit_pupil_mtf.phase", f"exit_pupil_mtf.phase → {p_end}",
             "init.context → exit_pupil_mtf.context", "pupil.pupil → exit_pupil_mtf.pupil"},
            {magnitude, phase},
        )  # fmt: skip


def test_of_two_phases_the_one_that_goes_all_the_way_beside(kodak, library):
    aside = Link("init", "phase", "charge_eff_phase", "phase")
    network = add_nodes(((Node("charge_eff_phase", "charge_eff_phase"), None),), (aside,)).apply(
        kodak
    )
    found = dropped(network, library, "exit_pupil_mtf", "init.magnitude → optics.magnitude")
    assert found is not None
    assert found[1] == {"init.magnitude → optics.magnitude", "init.phase → optics.phase"}


@pytest.mark.parametrize(
    ("module", "wire"),
    [
        ("jitter_mtf", "scene.image → photons.image"),
        ("jitter_mtf", "init.context → optics.context"),
        ("test_scene", "scene.image → photons.image"),
        ("examine_image", "scene.image → photons.image"),
        ("init_trans", "scene.image → photons.image"),
        ("back_transform", "charge.magnitude → back.magnitude"),
        ("jitter_mtf", "init.magnitude → nobody.magnitude"),
    ],
)
def test_what_does_not_fit(kodak, library, module, wire):
    assert dropped(kodak, library, module, wire) is None


def test_only_a_node_that_feeds_nothing_and_whose_input_is_empty(kodak, library):
    wire = link_of("scene.image → photons.image")
    assert inserted(kodak, library, wire, "pixels") is None
    assert inserted(kodak, library, wire, "nobody") is None
    assert inserted(kodak, library, wire, "photons") is None
    name, adding = new_node(kodak, library, "interpolate", None)
    fed = rewire(add=(Link("back", "image", name, "image"),)).apply(adding.apply(kodak))
    assert inserted(fed, library, wire, name) is None


def test_no_cycle_is_made_with_what_the_node_has(kodak, library):
    name, adding = new_node(kodak, library, "electronics_noise", None)
    network = adding.apply(kodak)
    network = rewire(add=(Link("init", "context", name, "context"),)).apply(network)
    assert inserted(network, library, link_of("scene.image → photons.image"), name) is None
    assert inserted(network, library, link_of("back.image → pixels.image"), name) is not None


def test_the_phase_stays_where_leading_it_through_would_be_a_cycle(library):
    """The node's context comes from behind the phase, not from behind the magnitude."""
    modules = {
        "init": "init_trans", "jitter": "jitter_mtf", "charge": "charge_eff_phase",
        "back": "back_transform", "again": "init_trans", "optics": "exit_pupil_mtf",
    }  # fmt: skip
    wires = (
        "init.magnitude → jitter.magnitude", "init.phase → charge.phase",
        "init.magnitude → back.magnitude", "charge.phase → back.phase",
        "back.image → again.image", "again.context → optics.context",
    )  # fmt: skip
    nodes = {name: Node(name, key) for name, key in modules.items()}
    network = Network(nodes=nodes, links=tuple(link_of(wire) for wire in wires))
    operation = inserted(network, library, link_of(wires[0]), "optics")
    assert operation is not None
    assert set(operation.apply(network).links) - set(network.links) == {
        link_of("init.magnitude → optics.magnitude"),
        link_of("optics.magnitude → jitter.magnitude"),
    }


def led_past_by(before, after):
    return set(after.links) - set(before.links)


def picture(network, library, port):
    engine = Engine(library)
    folder = shipped_networks()["kodak_kir310"].parent
    plan = engine.plan(network, folder=folder)
    return np.asarray(engine.value(plan, port, engine.work(Policy())))


@pytest.mark.parametrize(
    "gone",
    [("detector",), ("aberration", "detector"), ("electronics",), ("charge", "charge_phase")],
)
def test_the_picture_is_that_of_the_disabled_nodes(shipped, library, gone):
    """The engine passes a disabled node's input on; led past, the same wire does."""
    network = shipped["kodak_kir310"]
    small = network.with_parameter("scene", "width", 64).with_parameter("scene", "height", 64)
    disabled = small
    for name in gone:
        disabled = set_node_field(name, "disabled", True).apply(disabled)
    led_past = dissolved(small, library, gone).apply(small)
    assert not set(gone) & led_past.nodes.keys()
    apart = detached(small, library, gone).apply(small)
    assert apart.nodes == small.nodes
    assert set(apart.links) - set(led_past.links) == {
        link for link in small.links if {link.source, link.target} <= set(gone)
    }
    one, other = (picture(n, library, "pixels.image") for n in (disabled, led_past))
    np.testing.assert_array_equal(one, other)


@pytest.fixture
def compared():
    """The difference of two pictures, written: there are two ways through."""
    nodes = {
        "one": ("read_image", {}),
        "two": ("read_image", {}),
        "less": ("compare_images", {}),
        "last": ("write_image", {}),
    }
    return linked_network(
        nodes,
        [
            ("one.image", "less.image"),
            ("two.image", "less.reference"),
            ("less.difference", "last.image"),
        ],
    )


def test_of_two_ways_through_none_is_taken(library, compared):
    assert led_past_by(compared, dissolved(compared, library, ["less"]).apply(compared)) == set()


def test_every_node_of_every_network_leaves_a_sound_one(shipped, library):
    for network in shipped.values():
        before = {str(p) for p in problems(network, library=library, unfinished=True)}
        value_of = resolved(network, library=library).value
        for name in network.nodes:
            taking = dissolved(network, library, [name])
            step, _ = keeping_values(
                network=network, names=[name], taking=taking, value_of=value_of
            )
            after = step.apply(network)
            found = {str(p) for p in problems(after, library=library, unfinished=True)}
            assert found <= before, name


# Why a link cannot be made, in words.


@pytest.mark.parametrize(
    ("start", "end", "reason"),
    [
        ("init.phase", "detector.magnitude",
         "init.phase gives phase, but detector.magnitude takes magnitude"),
        ("init.context", "picture.image",
         "init.context gives context, but picture.image takes image or magnitude or phase or "
         "transfer"),
        ("nobody.image", "picture.image", "there is no node nobody"),
        ("frame_graber.image", "picture.image",
         "there is no node frame_graber; did you mean frame_grabber?"),
        ("init.magnitud", "detector.magnitude",
         "init has no output magnitud; did you mean magnitude?"),
        ("init.magnitude", "picture.x", "picture has no input x; its inputs: image"),
        ("picture.curve", "scene.image", "scene has no input image; it has no inputs"),
        ("charge.magnitude", "charge.magnitude", "charge cannot feed itself"),
        ("charge.magnitude", "aberration.magnitude",
         "this link would make a cycle: aberration → detector → charge → aberration"),
        ("frame_grabber.image", "photons.image",
         "this link would make a cycle: photons → init → electronics → frame_grabber → photons"),
    ],
)  # fmt: skip
def test_reasons(kodak, library, start, end, reason):
    assert refusal(kodak, library, Link.between(start, end)) == reason


def test_unknown_modules_take_and_give_anything(library):
    nodes = {"old": Node("old", "gone"), "back": Node("back", "back_transform")}
    network = Network(nodes=nodes)
    assert refusal(network, library, Link("old", "any", "back", "phase")) is None
    assert refusal(network, library, Link("back", "image", "old", "thing")) is None
    looped = Network(nodes=nodes, links=(Link("back", "image", "old", "thing"),))
    reason = refusal(looped, library, Link("old", "any", "back", "phase"))
    assert reason == "this link would make a cycle: back → old → back"
