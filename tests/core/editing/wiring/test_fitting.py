"""Modules that fit a loose wire, and how a new one is wired."""

from __future__ import annotations

from dataclasses import replace

import pytest

from core.editing.links import Rewire
from core.editing.nodes import Remove
from core.editing.wiring.fitting import Candidate, fitting, new_node, wired_to
from core.errors import NetworkError
from core.modules.declaration import declaration
from core.network.network import Link, Network, Node


def links_of(*texts):
    return {Link.between(*text.split(" → ")) for text in texts}


def new_links(network, operation):
    return set(operation.apply(network).links) - set(network.links)


def test_what_takes_a_pupil(library):
    assert fitting(library, ["pupil"], "input") == (Candidate("exit_pupil_mtf", "pupil"),)


def test_what_gives_a_context_or_a_phase(library):
    assert fitting(library, ["context"], "output") == (Candidate("init_trans", "context"),)
    assert fitting(library, ["phase"], "output") == (
        Candidate("init_trans", "phase"),
        Candidate("diffraction_mtf", "phase"),
        Candidate("exit_pupil_mtf", "phase"),
        Candidate("mtf_file", "phase"),
        Candidate("psf_file", "phase"),
        Candidate("line_of_sight", "phase"),
        Candidate("charge_eff_phase", "phase"),
    )


def test_what_takes_a_table_is_nothing(library):
    assert fitting(library, ["table"], "input") == ()
    assert fitting(library, [], "input") == ()


def test_inputs_of_several_types_take_each_of_them(library):
    found = fitting(library, ["transfer"], "input")
    assert [each.module for each in found] == ["write_matrix", "examine_image", "mtf_slices"]


@pytest.mark.parametrize("side", ["input", "output"])
def test_candidates_are_in_the_librarys_order_and_can_be_wired(library, side):
    order = list(library)
    for kind in ("image", "magnitude", "phase", "context", "pupil", "transfer", "curve"):
        found = fitting(library, [kind], side)
        places = [order.index(each.module) for each in found]
        assert places == sorted(places)
        for each in found:
            known = declaration(library[each.module])
            ports = known.inputs if side == "input" else known.outputs
            assert kind in next(port for port in ports if port.name == each.port).types


def test_a_new_node_is_named_after_its_module(kodak, library):
    name, operation = new_node(kodak, library, "jitter_mtf", (3, 4))
    assert name == "jitter_mtf"
    network = operation.apply(kodak)
    assert (network.nodes[name].module, network.layout[name]) == ("jitter_mtf", (3, 4))
    assert new_node(network, library, "jitter_mtf", None)[0] == "jitter_mtf_2"
    assert operation.text == "Add jitter_mtf"


def test_a_module_that_is_not_there(kodak, library):
    with pytest.raises(NetworkError, match="there is no module jiter_mtf; did you mean"):
        new_node(kodak, library, "jiter_mtf", (0, 0))


def wired(network, library, end, module, port):
    name, operation = wired_to(network, library, end, Candidate(module, port), (0, 0))
    assert name == module
    return new_links(network, operation)


def test_an_mtf_module_at_a_magnitude_gets_its_context(kodak, library):
    found = wired(kodak, library, ("detector", "magnitude", "output"), "jitter_mtf", "magnitude")
    assert found == links_of(
        "detector.magnitude → jitter_mtf.magnitude", "init.context → jitter_mtf.context"
    )


def test_the_pupil_module_gets_its_pupil_and_the_phase_beside_its_magnitude(kodak, library):
    found = wired(kodak, library, ("init", "magnitude", "output"), "exit_pupil_mtf", "magnitude")
    assert found == links_of(
        "init.magnitude → exit_pupil_mtf.magnitude",
        "init.phase → exit_pupil_mtf.phase",
        "init.context → exit_pupil_mtf.context",
        "pupil.pupil → exit_pupil_mtf.pupil",
    )


def test_back_transform_gets_the_phase_that_left_the_magnitude_further_up(kodak, library):
    """In this network it is led from `optics` through `charge_phase` beside the detector's MTFs."""
    found = wired(
        kodak, library, ("detector", "magnitude", "output"), "back_transform", "magnitude"
    )
    assert found == links_of(
        "detector.magnitude → back_transform.magnitude", "charge_phase.phase → back_transform.phase"
    )


def test_a_dropped_phase_finds_its_magnitude(inframetrics, library):
    network = Remove(("back",)).apply(inframetrics)
    found = wired(network, library, ("optics", "phase", "output"), "back_transform", "phase")
    assert found == links_of(
        "optics.phase → back_transform.phase", "optics.magnitude → back_transform.magnitude"
    )


def test_two_contexts_are_none(kodak, library):
    network = new_node(kodak, library, "init_trans", None)[1].apply(kodak)
    found = wired(network, library, ("detector", "magnitude", "output"), "jitter_mtf", "magnitude")
    assert found == links_of("detector.magnitude → jitter_mtf.magnitude")


def test_a_context_alone_leaves_open_which_of_many_magnitudes(kodak, library):
    found = wired(kodak, library, ("init", "context", "output"), "jitter_mtf", "context")
    assert found == links_of("init.context → jitter_mtf.context")


def test_a_context_finds_the_one_magnitude(library):
    network = Network(nodes={"init": Node("init", "init_trans")})
    found = wired(network, library, ("init", "context", "output"), "jitter_mtf", "context")
    assert found == links_of(
        "init.context → jitter_mtf.context", "init.magnitude → jitter_mtf.magnitude"
    )


def test_an_image_for_the_electronics(kodak, library):
    found = wired(kodak, library, ("scene", "image", "output"), "electronics_noise", "image")
    assert found == links_of(
        "scene.image → electronics_noise.image", "init.context → electronics_noise.context"
    )


def test_a_wire_from_an_empty_input_takes_nothing_from_behind_it(kodak, library):
    """The one context there is lies behind the new node: no cycle is made."""
    cut = Rewire(remove=(Link("scene", "image", "photons", "image"),)).apply(kodak)
    found = wired(cut, library, ("photons", "image", "input"), "electronics_noise", "image")
    assert found == links_of("electronics_noise.image → photons.image")


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


def test_a_wire_from_an_occupied_input_is_replaced_by_what_passes_nothing_on(kodak, library):
    name, operation = wired_to(
        kodak, library, ("init", "image", "input"), Candidate("read_image", "image"), None
    )
    after = operation.apply(kodak)
    assert [str(link) for link in after.links_into("init")] == ["read_image.image → init.image"]
    assert name not in after.layout


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


def test_a_wire_from_an_unknown_module_fits_anything(kodak, library):
    nodes = {**kodak.nodes, "optics": replace(kodak.nodes["optics"], module="gone")}
    network = replace(kodak, nodes=nodes)
    found = wired(network, library, ("optics", "magnitude", "output"), "jitter_mtf", "magnitude")
    assert found == links_of(
        "optics.magnitude → jitter_mtf.magnitude", "init.context → jitter_mtf.context"
    )
