"""Nodes dropped on wires of the shipped networks."""

from __future__ import annotations

import pytest

from core.editing.fields import set_node_field
from core.editing.links import Rewire
from core.editing.nodes import Add, Placed
from core.editing.wiring.fitting import inserted, new_node
from core.network.network import Link, Network, Node
from core.network.validation import problems


def link_of(text):
    return Link.between(*text.split(" → "))


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


@pytest.mark.parametrize("module", ["jitter_mtf", "gaussian_mtf", "vibration_mtf", "detector_mtf"])
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


def test_no_phase_is_led_through_where_none_runs_beside(kodak, library):
    found = dropped(kodak, library, "exit_pupil_mtf", "aberration.magnitude → detector.magnitude")
    assert found is not None
    assert not [link for link in found[0] if "phase" in link]
    assert found[1] == {"aberration.magnitude → detector.magnitude"}


def test_of_two_magnitudes_beside_a_phase_none_is_taken(inframetrics, library):
    """One comes from the same node, the other goes to the same: neither is beyond doubt."""
    found = dropped(inframetrics, library, "exit_pupil_mtf", "optics.phase → back.phase")
    assert found is not None
    assert found[1] == {"optics.phase → back.phase"}


def test_of_two_phases_the_one_that_goes_all_the_way_beside(kodak, library):
    aside = Link("init", "phase", "charge_eff_phase", "phase")
    network = Add((Placed(Node("charge_eff_phase", "charge_eff_phase")),), (aside,)).apply(kodak)
    found = dropped(network, library, "exit_pupil_mtf", "init.magnitude → optics.magnitude")
    assert found is not None
    assert found[1] == {"init.magnitude → optics.magnitude", "init.phase → optics.phase"}


def test_two_pupils_are_none(kodak, library):
    network = new_node(kodak, library, "exit_pupil", None)[1].apply(kodak)
    found = dropped(network, library, "exit_pupil_mtf", "init.magnitude → optics.magnitude")
    assert found is not None
    assert not [link for link in found[0] if "pupil.pupil" in link]
    assert "init.context → exit_pupil_mtf.context" in found[0]


def test_electronics_on_a_picture_get_the_context(kodak, library):
    wire = "electronics.image → frame_grabber.image"
    assert dropped(kodak, library, "electronics_noise", wire) == (
        {"electronics.image → electronics_noise.image",
         "electronics_noise.image → frame_grabber.image",
         "init.context → electronics_noise.context"},
        {wire},
    )  # fmt: skip


def test_electronics_before_the_context_do_not_make_a_cycle(kodak, library):
    wire = "scene.image → photons.image"
    assert dropped(kodak, library, "electronics_noise", wire) == (
        {"scene.image → electronics_noise.image", "electronics_noise.image → photons.image"},
        {wire},
    )


def test_a_module_of_one_picture_input(inframetrics, library):
    wire = "scene.image → photons.image"
    assert dropped(inframetrics, library, "interpolate", wire) == (
        {"scene.image → interpolate.image", "interpolate.image → photons.image"},
        {wire},
    )


def test_a_module_whose_output_has_another_name_than_its_input(kodak, library):
    wire = "electronics.image → frame_grabber.image"
    new, gone = dropped(kodak, library, "compare_images", wire)
    assert "electronics.image → compare_images.image" in new
    assert "compare_images.difference → frame_grabber.image" in new
    assert gone == {wire}


@pytest.mark.parametrize(
    ("module", "wire"),
    [
        ("jitter_mtf", "scene.image → photons.image"),
        ("jitter_mtf", "init.phase → optics.phase"),
        ("jitter_mtf", "init.context → optics.context"),
        ("charge_eff_phase", "init.magnitude → optics.magnitude"),
        ("test_scene", "scene.image → photons.image"),
        ("write_image", "scene.image → photons.image"),
        ("examine_image", "scene.image → photons.image"),
        ("mtf_slices", "init.magnitude → optics.magnitude"),
        ("init_trans", "scene.image → photons.image"),
        ("back_transform", "charge.magnitude → back.magnitude"),
        ("exit_pupil", "pupil.pupil → optics.pupil"),
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
    fed = Rewire(add=(Link("back", "image", name, "image"),)).apply(adding.apply(kodak))
    assert inserted(fed, library, wire, name) is None


def test_what_the_node_has_at_its_other_inputs_stays(kodak, library):
    name, adding = new_node(kodak, library, "jitter_mtf", None)
    network = new_node(kodak, library, "init_trans", None)[1].apply(adding.apply(kodak))
    own = Link("init_trans", "context", name, "context")
    network = Rewire(add=(own,)).apply(network)
    operation = inserted(network, library, link_of("init.magnitude → optics.magnitude"), name)
    assert operation is not None
    assert own in operation.apply(network).links


def test_no_cycle_is_made_with_what_the_node_has(kodak, library):
    name, adding = new_node(kodak, library, "electronics_noise", None)
    network = adding.apply(kodak)
    network = Rewire(add=(Link("init", "context", name, "context"),)).apply(network)
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


def test_the_wires_of_unknown_modules_take_nodes(kodak, library):
    wire = Link("old", "output", "jitter", "magnitude")
    network = Add((Placed(Node("old", "gone")), Placed(Node("jitter", "jitter_mtf"))), (wire,))
    assert dropped(network.apply(kodak), library, "gaussian_mtf", str(wire)) == (
        {"old.output → gaussian_mtf.magnitude", "gaussian_mtf.magnitude → jitter.magnitude",
         "init.context → gaussian_mtf.context"},
        {str(wire)},
    )  # fmt: skip


def test_a_disabled_source_is_no_hindrance(kodak, library):
    network = set_node_field("detector", "disabled", True).apply(kodak)
    wire = "detector.magnitude → charge.magnitude"
    assert dropped(network, library, "jitter_mtf", wire) is not None
