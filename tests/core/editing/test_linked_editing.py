"""What becomes of expressions when the nodes they name are renamed, copied or deleted."""

import json
from random import Random

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from core.editing.clipboard import copied, duplicated, pasted
from core.editing.document import Document
from core.editing.operations import keeping_values, remove_nodes, rename_node
from core.errors import NetworkError
from core.network.expressions import quoted
from core.network.file import parse_network
from core.network.linked_values import expression, resolved, with_values
from core.network.network import Network, Node

LIMITS = settings(
    deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


def linked(kodak):
    """σ = 2 F/1000 and, after it, 10 σ: 0.004 and 0.04 at F/2."""
    network = kodak.with_parameter(
        "aberration", "sigma_x_mrad", expression("init.f_number * 2 / 1000")
    )
    return network.with_parameter(
        "aberration", "sigma_y_mrad", expression("aberration.sigma_x_mrad * 10")
    )


def sigmas(network, library, node="aberration"):
    params = with_values(network, library=library).network.nodes[node].params
    return params["sigma_x_mrad"], params["sigma_y_mrad"]


def texts(network, node="aberration"):
    params = network.nodes[node].params
    return params["sigma_x_mrad"]["expression"], params["sigma_y_mrad"]["expression"]


def done_and_undone(network, operation, library):
    """The network after it; undo gives the file's text back, redo the same again."""
    document = Document(network, library=library)
    before = document.text()
    assert document.do(operation)
    after, text = document.network, document.text()
    document.undo()
    assert document.text() == before
    document.redo()
    assert document.text() == text
    assert parse_network(text, library=library) == after
    return after


def test_a_name_too_long_for_an_expression_is_refused(kodak, library):
    document = Document(linked(kodak), library=library)
    before = document.text()
    with pytest.raises(NetworkError, match=r"init cannot be renamed: .* at most 1000"):
        document.do(rename_node("init", "x" * 2000))
    assert document.text() == before


def taken_out(network, names, library):
    value_of = resolved(network, library=library).value
    return keeping_values(
        network=network, names=names, taking=remove_nodes(names), value_of=value_of
    )


def test_deleting_what_is_followed_leaves_the_value(kodak, library):
    network = linked(kodak)
    operation, kept = taken_out(network, ("init",), library)
    assert kept == ("aberration.sigma_x_mrad = 0.004",)
    after = done_and_undone(network, operation, library)
    assert after.nodes["aberration"].params["sigma_x_mrad"] == 0.004
    # What follows a node that stays is still linked.
    assert after.nodes["aberration"].linked == ("sigma_y_mrad",)
    assert sigmas(after, library) == (0.004, 0.04)


def test_copies_follow_copies_and_what_was_not_copied(kodak, library):
    network = linked(kodak)
    (one,), operation = duplicated(network, ("aberration",), library)
    after = done_and_undone(network, operation, library)
    assert texts(after, one) == ("init.f_number * 2 / 1000", f"{one}.sigma_x_mrad * 10")
    names, operation = duplicated(network, ("init", "aberration"), library)
    after = done_and_undone(network, operation, library)
    assert texts(after, names[1])[0] == f"{names[0]}.f_number * 2 / 1000"
    assert sigmas(after, library, names[1]) == (0.004, 0.04)


def test_a_pasted_copy_follows_what_it_followed(kodak, library):
    text = copied(linked(kodak), ("aberration",), library)
    assert json.loads(text)["version"] == 2
    (one,), operation = pasted(text, kodak, library)
    assert operation.apply(kodak).nodes[one].linked == ("sigma_x_mrad", "sigma_y_mrad")


NAMES = st.text(st.characters(exclude_characters=".=", exclude_categories=["Cc", "Cs", "Zl", "Zp"]),
                min_size=1, max_size=8).filter(str.strip)  # fmt: skip


@LIMITS
@given(
    names=st.lists(NAMES, min_size=5, max_size=5, unique=True),
    new=NAMES,
    seed=st.integers(0, 2**32),
)
def test_renaming_keeps_every_value(names, new, seed, library):
    """On random ways of links: none comes round, as each follows earlier ones alone."""
    assume(new not in names)
    random = Random(seed)
    nodes, values = {}, {}
    for number, name in enumerate(names):
        params = {"sigma_x_mrad": random.randint(1, 9)}
        values[name] = float(params["sigma_x_mrad"])
        if number:
            first, second = random.choice(names[:number]), random.choice(names[:number])
            text = f"{quoted(first)}.sigma_x_mrad + 2*{quoted(second)}.sigma_x_mrad"
            params["sigma_x_mrad"] = expression(text)
            values[name] = values[first] + 2 * values[second]
        nodes[name] = Node(name, "gaussian_mtf", params)
    network = Network(nodes=nodes)
    old = random.choice(names)
    after = done_and_undone(network, rename_node(old, new), library)
    resolved = with_values(after, library=library)
    assert not resolved.faults
    for name, value in values.items():
        node = resolved.network.nodes[new if name == old else name]
        assert node.params["sigma_x_mrad"] == value
