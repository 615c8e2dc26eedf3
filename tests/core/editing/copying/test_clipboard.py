"""Copying and pasting nodes as text, and what a strange clipboard does: nothing."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.editing.copying.clipboard import copied, duplicated, pasted
from core.editing.document import Document
from core.errors import NetworkError
from core.network.file import format_network
from core.network.network import Link, Network, Node
from thorough import examples

NAMES = ("detector", "charge", "back")


def test_the_text_is_readable_json(kodak, library):
    found = json.loads(copied(kodak, NAMES, library))
    assert (found["format"], found["version"]) == ("imagechain-nodes", 1)
    assert found["nodes"] == {
        "detector": {"module": "detector_mtf"},
        "charge": {
            "module": "charge_eff_mtf",
            "params": {"detectors_per_line": 640, "efficiency": 0.99999},
        },
        "back": {"module": "back_transform"},
    }
    assert found["links"] == [
        ["detector.magnitude", "charge.magnitude"],
        ["charge.magnitude", "back.magnitude"],
    ]
    assert found["layout"] == {"detector": [1200, 0], "charge": [1440, 0], "back": [1680, 0]}
    assert found.keys() == {"format", "version", "nodes", "links", "layout"}


def test_nodes_are_copied_in_the_networks_order(kodak, library):
    assert copied(kodak, reversed(NAMES), library) == copied(kodak, NAMES, library)


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


def test_pasted_again_and_again_nothing_lies_on_anything(kodak, library):
    text = copied(kodak, NAMES, library)
    network = kodak
    for _ in range(12):
        for at in (None, (1440.0, 0.0)):
            network = pasted(text, network, library, at)[1].apply(network)
    points = list(network.layout.values())
    assert len(set(points)) == len(points) == 15 + 72


def test_the_middle_of_what_is_pasted_is_where_one_asks(kodak, library):
    _, operation = pasted(copied(kodak, NAMES, library), Network(), library, (100.0, -50.0))
    after = operation.apply(Network())
    assert after.layout == {"detector": (-140, -50), "charge": (100, -50), "back": (340, -50)}


def test_a_whole_network_file_pastes(inframetrics, library):
    text = format_network(inframetrics, library=library)
    names, operation = pasted(text, Network("mine", seed=4), library)
    after = operation.apply(Network("mine", seed=4))
    assert names == tuple(inframetrics.nodes)
    assert (after.nodes, after.links) == (inframetrics.nodes, inframetrics.links)
    assert (after.name, after.seed, dict(after.extra)) == ("mine", 4, {})


def test_nodes_without_points_are_laid_out(kodak, library):
    text = copied(replace(kodak, layout={}), NAMES, library)
    after = pasted(text, Network(), library, (0.0, 0.0))[1].apply(Network())
    xs = [after.layout[name][0] for name in NAMES]
    assert xs == sorted(set(xs))


def test_unknown_modules_and_other_fields_are_pasted(library):
    node = Node("old", "gone", {"a": [1, {"b": 2}]}, auto=False, disabled=True, extra={"pinned": 1})
    text = copied(Network(nodes={"old": node}), ["old"], library)
    after = pasted(text, Network(), library)[1].apply(Network())
    assert after.nodes == {"old": node}


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


def test_nobody_cannot_be_copied(kodak, library):
    for function in (copied, duplicated):
        with pytest.raises(NetworkError, match="nobody is no node"):
            function(kodak, ["nobody"], library)


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
        ("", "holds no copied nodes"),
        ("a letter to somebody", "holds no copied nodes"),
        ("[1, 2]", "holds no copied nodes"),
        ("{}", "holds no copied nodes"),
        ('{"format": ["imagechain-nodes"]}', "holds no copied nodes"),
        (hostile(format="something else"), "holds no copied nodes"),
        (hostile(nodes={}), "holds no nodes"),
        (hostile()[:-9], "not JSON"),
        (hostile(version=99), "newer Imagechain"),
        (hostile(version="1"), "version must be a whole number"),
        (hostile(nodes=[1]), "nodes must be an object"),
        (hostile(nodes={"a": {}}), "nodes.a.module is missing"),
        (hostile(nodes={"a.b": {"module": "x"}}), "'a.b' is not allowed"),
        (hostile(links=[["a.magnitude", "c.magnitude"]]), "there is no node c"),
        (hostile(links=[["a.mtf", "b.magnitude"]]), "gives transfer, but"),
        (hostile(links=[["a.magnitude", "a.magnitude"]]), "cannot feed itself"),
        (
            hostile(links=[["a.magnitude", "b.magnitude"], ["b.magnitude", "a.magnitude"]]),
            "form a cycle",
        ),
        (
            hostile(
                nodes={name: {"module": "gone"} for name in "abc"},
                links=[["a.o", "b.i"], ["c.o", "b.i"]],
            ),
            "more than one link",
        ),
        (hostile(layout={"a": [1]}), "layout.a must be two numbers"),
        (hostile(nodes={"a": {"module": "x", "params": {"n": float("nan")}}}), "NaN is no number"),
        ("{" + '"a":[' * 100_000, "nested more than"),
        ('{"format": "imagechain-nodes", "format": "imagechain-nodes"}', "comes twice"),
        ("{" + " " * (17 << 20), "larger than the 16 MiB"),
    ],
)
def test_what_is_no_copy_is_refused_in_one_line(kodak, library, text, reason):
    with pytest.raises(NetworkError, match=reason) as caught:
        pasted(text, kodak, library)
    assert str(caught.value).startswith("the clipboard")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_points_far_away_are_given_up(kodak, library):
    for far in (1e300, -1e17):
        text = hostile(layout={"a": [far, 0], "b": [0, far]})
        after = pasted(text, kodak, library, (0.0, 0.0))[1].apply(kodak)
        assert all(
            abs(x) < 1000 and abs(y) < 1000 for x, y in (after.layout["a"], after.layout["b"])
        )


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
