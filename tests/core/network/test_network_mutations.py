"""Whatever is done to a network file: it loads as it stands, or gives one clear line."""

import copy
import json

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from core.errors import ImagechainError
from core.network.file import format_network, load_network, parse_network, save_network
from core.network.network import Link, Network, Node
from thorough import examples

LIMITS = settings(
    max_examples=examples(200),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)

TEXTS = st.one_of(
    st.text(st.characters(), max_size=6),  # half surrogate pairs, too
    st.sampled_from(["", "noise", "a.b", "init.image", "init", "scene", "\0", "\ud800", "x" * 999]),
)
NUMBERS = st.one_of(
    st.integers(),
    st.floats(),
    st.sampled_from([10**400, -(10**400), 10**4299, 2**63, 10**308, 5e-324, -0.0]),
)
VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), NUMBERS, TEXTS),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(TEXTS, inner, max_size=3)),
    max_leaves=5,
)


def _loaded(path, library, **options):
    """The network, or None where there was one clear line."""
    try:
        return load_network(path, library=library, **options)
    except ImagechainError as error:
        fault = error
    line = str(fault)
    assert fault.exit_code == 2
    assert line.splitlines() == [line]
    assert len(line) < 2000
    assert line.encode()
    assert "\x1b" not in line
    return None


def _check(path, library):
    strict = _loaded(path, library)
    lenient = _loaded(path, library, keep_unknown=True, unfinished=True)
    assert strict is None or strict == lenient
    if lenient is not None:
        again = path.with_suffix(".again")
        save_network(lenient, again, library=library)
        loaded = load_network(again, library=library, keep_unknown=True, unfinished=True)
        assert loaded == lenient
        assert again.read_text("utf-8") == format_network(loaded, library=library)
    return lenient


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("networks") / "n.json"


@given(
    edits=st.lists(
        st.tuples(
            st.sampled_from(["replace", "insert", "delete", "repeat", "cut"]),
            st.integers(0, 10**4),
            st.integers(1, 40),
            st.one_of(
                st.binary(max_size=3),
                st.sampled_from([b'"', b"{", b"}", b"[", b",", b"1e999", b"NaN", b"\\ud800", b"-"]),
            ),
        ),
        min_size=1,
        max_size=3,
    )
)
@LIMITS
def test_changed_bytes(edits, sound_text, small_library, path):
    content = sound_text.encode()
    for kind, place, length, new in edits:
        start = place % (len(content) + 1)
        old = content[start : start + length]
        middle = {
            "replace": new + old[len(new) :],
            "insert": new + old,
            "delete": b"",
            "repeat": old + old,
            "cut": b"",
        }[kind]
        rest = b"" if kind == "cut" else content[start + length :]
        content = content[:start] + middle + rest
    path.write_bytes(content)
    _check(path, small_library)


def _places(value):
    """Every container of a tree with each of its keys or indices."""
    if isinstance(value, dict | list):
        for key in list(value) if isinstance(value, dict) else range(len(value)):
            yield value, key
            yield from _places(value[key])


def _plain(document):
    """What a document says, fields that say nothing left out."""
    silent = {"name": "", "description": "", "seed": 0, "links": [], "layout": {}}
    said = {k: v for k, v in document.items() if k not in silent or v != silent[k]}
    said["nodes"] = {
        name: {k: v for k, v in node.items() if (k, v) not in [("params", {}), ("disabled", False)]}
        for name, node in document["nodes"].items()
    }
    said["links"] = sorted(document.get("links", []))
    return said


@given(data=st.data())
@LIMITS
def test_changed_trees(data, sound_text, small_library, path):
    tree = json.loads(sound_text)
    for _ in range(data.draw(st.integers(1, 3))):
        places = list(_places(tree))
        assume(places)
        container, key = places[data.draw(st.integers(0, len(places) - 1))]
        kind = data.draw(st.sampled_from(["set", "delete", "add", "move", "copy"]))
        other, name = places[data.draw(st.integers(0, len(places) - 1))]
        if kind == "delete":
            del container[key]
        elif kind == "add" and isinstance(container, list):
            container.append(copy.deepcopy(container[key]))
        elif kind == "add":
            container[data.draw(TEXTS)] = data.draw(VALUES)
        elif kind == "move" and isinstance(container, dict):
            container[data.draw(TEXTS)] = container.pop(key)
        elif kind == "copy":
            container[key] = copy.deepcopy(other[name])
        else:
            container[key] = data.draw(VALUES)
    path.write_text(json.dumps(tree), "utf-8")
    network = _check(path, small_library)
    if network is not None:
        written = json.loads(format_network(network, library=small_library))
        assert _plain(written) == _plain(tree)


IDS = st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"], exclude_characters=".="))
PLAIN = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(-(2**70), 2**70),
        st.floats(allow_nan=False, allow_infinity=False),
        st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text("abµ ", max_size=4), inner, max_size=3)
    ),
    max_leaves=6,
)
NAMES = st.text("ab", min_size=1, max_size=3)
PARAMS = st.dictionaries(st.one_of(NAMES, st.just("sigma_mrad"), st.just("width")), PLAIN)


@st.composite
def networks(draw):
    ids = draw(st.lists(IDS.filter(str.strip), max_size=4, unique=True))
    keys = st.sampled_from(["noise", "scene_maker", "jitter_mtf", "unknown"])
    extra = st.dictionaries(NAMES, PLAIN, max_size=2)
    nodes = {
        name: Node(
            name,
            draw(keys),
            draw(PARAMS),
            draw(st.sampled_from([None, True, False])),
            draw(st.booleans()),
            draw(extra),
            draw(st.booleans()),
        )
        for name in ids
    }
    ends = st.sampled_from(ids or ["gone"])
    numbers = st.floats(allow_nan=False, allow_infinity=False)
    return Network(
        name=draw(st.text(max_size=9)),
        seed=draw(st.integers(0, 2**63 - 1)),
        nodes=nodes,
        links=tuple(draw(st.lists(st.builds(Link, ends, NAMES, ends, NAMES), max_size=4))),
        layout=draw(st.dictionaries(ends, st.tuples(numbers, numbers), max_size=3)),
        extra=draw(extra),
    )


@given(network=networks())
@LIMITS
def test_any_document_is_written_and_read_equal(network, small_library):
    text = format_network(network, library=small_library)
    again = parse_network(text, library=small_library)
    assert again == network
    assert list(again.nodes) == list(network.nodes)
    assert format_network(again, library=small_library) == text
