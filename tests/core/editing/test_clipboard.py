"""Copied nodes and values, pasted and duplicated."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.clipboard import copied, copied_values, duplicated, pasted, pasted_values
from core.editing.document import Document
from core.errors import NetworkError
from core.modules.declaration import declaration
from core.network.file import format_network
from core.network.linked_values import expression
from core.network.network import Link, Network, Node
from thorough import examples

NAMES = ("detector", "charge", "back")


def test_pasting_into_another_network_keeps_the_names(kodak, library):
    text = copied(kodak, NAMES, library)
    names, operation = pasted(text, Network(), library)
    after = operation.apply(Network())
    assert names == NAMES
    assert after.nodes == {name: kodak.nodes[name] for name in NAMES}
    assert set(after.links) == {
        Link("detector", "magnitude", "charge", "magnitude"),
        Link("charge", "magnitude", "back", "magnitude"),
    }
    assert after.layout == {name: kodak.layout[name] for name in NAMES}
    assert operation.text == "Paste 3 nodes"


def test_pasting_beside_the_original(kodak, library):
    names, operation = pasted(copied(kodak, NAMES, library), kodak, library)
    after = operation.apply(kodak)
    assert names == ("detector_2", "charge_2", "back_2")
    assert set(after.links) - set(kodak.links) == {
        Link("detector_2", "magnitude", "charge_2", "magnitude"),
        Link("charge_2", "magnitude", "back_2", "magnitude"),
    }
    assert after.nodes["charge_2"].params == kodak.nodes["charge"].params
    assert after.extra == kodak.extra
    assert after.seed == kodak.seed


@pytest.mark.parametrize("by", [0, 1])
def test_the_middle_of_what_is_pasted_is_where_one_asks(kodak, library, by):
    x, y = 100 + by, -50 + by
    _, operation = pasted(copied(kodak, NAMES, library), Network(), library, (float(x), float(y)))
    after = operation.apply(Network())
    assert after.layout == {"detector": (x - 240, y), "charge": (x, y), "back": (x + 240, y)}


def test_duplicates_are_fed_by_the_same_wires(kodak, library):
    names, operation = duplicated(kodak, ["detector", "charge"], library)
    after = operation.apply(kodak)
    assert names == ("detector_2", "charge_2")
    assert set(after.links) - set(kodak.links) == {
        Link("aberration", "magnitude", "detector_2", "magnitude"),
        Link("init", "context", "detector_2", "context"),
        Link("detector_2", "magnitude", "charge_2", "magnitude"),
        Link("init", "context", "charge_2", "context"),
    }
    assert set(kodak.links) <= set(after.links)
    assert operation.text == "Duplicate 2 nodes"
    assert len(set(after.layout.values())) == 17


def hostile(**changes):
    fields = {
        "format": "imagechain-nodes",
        "version": 1,
        "nodes": {"a": {"module": "jitter_mtf"}, "b": {"module": "jitter_mtf"}},
        "links": [["a.magnitude", "b.magnitude"]],
    }
    return json.dumps({**fields, **changes})


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "contains neither copied nodes"),
        ("[1, 2]", "contains neither copied nodes"),
        (hostile(format="something else"), "contains neither copied nodes"),
        (hostile(nodes={}), "contains no nodes"),
        (hostile(version=99), "newer Imagechain"),
        (hostile(links=[["a.mtf", "b.magnitude"]]), "gives transfer, but"),
        (
            hostile(links=[["a.magnitude", "b.magnitude"], ["b.magnitude", "a.magnitude"]]),
            "form a cycle",
        ),
        ("{" + " " * (17 << 20), "larger than 16 MiB"),
    ],
)
def test_what_is_no_copy_is_refused_in_one_line(kodak, library, text, reason):
    with pytest.raises(NetworkError, match=reason) as caught:
        pasted(text, kodak, library)
    assert str(caught.value).startswith("the clipboard")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_duplicates_of_what_lies_far_away_come_to_an_end(library):
    """So far that a step aside is less than a number there can tell."""
    network = Network(nodes={"a": Node("a", "gone")}, layout={"a": (1e300, 1e300)})
    assert duplicated(network, ["a"], library)[0] == ("a_2",)


@settings(max_examples=examples(150), deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_a_damaged_clipboard_pastes_soundly_or_not_at_all(data, kodak, library):
    text = copied(kodak, NAMES, library)
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 40)))
        new = data.draw(
            st.sampled_from(['"', "}", "[", "1e999", "init", "null", "back", ".", "\0"])
        )
        text = text[:start] + new + text[end:]
    document = Document(kodak, library=library)
    try:
        names, operation = pasted(text, kodak, library)
    except NetworkError:
        return
    assert document.do(operation)
    assert set(names) == set(document.network.nodes) - set(kodak.nodes)
    document.undo()
    assert document.text() == format_network(kodak, library=library)


def network_of(*nodes):
    return Network(nodes={node.id: node for node in nodes})


@pytest.fixture
def declared_in(library):
    def of(network):
        return lambda name: (
            declaration(library[network.nodes[name].module])
            if network.nodes[name].module in library
            else None
        )

    return of


@pytest.fixture
def paste(declared_in):
    def do(network, source, *targets, text=None):
        of = declared_in(network)
        if text is None:
            text = copied_values(network.nodes[source], of(source))
        operation, left_out = pasted_values(text, targets, of)
        return operation.apply(network), left_out

    return do


BLUR = Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.5})


def moved_from_default(parameter):
    """A number that the parameter may have, and has not by default."""
    low = parameter.param.low if parameter.param.low is not None else 0.0
    high = parameter.param.high if parameter.param.high is not None else low + 8.0
    return next(
        v for share in (0.375, 0.625) if (v := low + share * (high - low)) != parameter.default
    )


def test_every_module_gives_its_values_to_another_of_its_kind(library, paste):
    for key, module in library.items():
        values = {
            parameter.name: moved_from_default(parameter)
            for parameter in declaration(module).parameters
            if parameter.kind == "number"
        }
        if values:
            network = network_of(Node("one", key, values), Node("two", key))
            after, left_out = paste(network, "one", "two")
            assert not left_out, key
            assert after.nodes["two"].params == values, key


def test_parameters_of_the_same_key_go_to_other_modules(paste):
    network = network_of(Node("one", "focal_plane", {"bits": 12}), Node("two", "electronics_noise"))
    after, left_out = paste(network, "one", "two")
    assert after.nodes["two"].params["bits"] == 12
    assert any("integration_time_s" in reason for reason in left_out)


def test_a_value_that_is_not_allowed_there_is_left_out_with_the_reason(paste):
    text = json.dumps({
        "format": "imagechain-values", "version": 1, "module": "gaussian_mtf",
        "values": {"sigma_x_mrad": -3.0, "sigma_y_mrad": 0.25},
    })  # fmt: skip
    after, (reason,) = paste(network_of(BLUR), "", "blur", text=text)
    assert "sigma_x_mrad = -3.0 mrad is not allowed" in reason
    assert dict(after.nodes["blur"].params) == {"sigma_x_mrad": 0.3, "sigma_y_mrad": 0.25}


def test_expressions_are_pasted_as_expressions(library, paste):
    init = Node("init", "init_trans", {"f_number": 2.0})
    linked = Node("blur", "gaussian_mtf", {"sigma_x_mrad": expression("init.f_number * 0.1")})
    network = network_of(init, linked, Node("other", "gaussian_mtf"))
    after, _ = paste(network, "blur", "other")
    assert after.nodes["other"].params["sigma_x_mrad"] == {"expression": "init.f_number * 0.1"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "contains no parameter values"),
        ('{"format": "imagechain-values", "values": {}}', "contains no parameter values"),
        ('{"format": "imagechain-values", "values": [1]}', "contains no parameter values"),
    ],
)
def test_what_holds_no_values_is_refused_in_one_line(text, message, paste):
    with pytest.raises(NetworkError, match=message) as caught:
        paste(network_of(BLUR), "", "blur", text=text)
    assert "\n" not in str(caught.value)
