import json
import sys

import pytest

from core.network.file import parse_network
from core.network.network import Link, Network, Node
from core.network.validation import problems


def _lines(document, library, **options):
    network = parse_network(json.dumps(document), library=library)
    found = problems(network, library=library, **options)
    assert all(error.exit_code == 2 for error in found)
    assert found == [] or not any("\n" in str(error) for error in found)
    return [str(error) for error in found]


def test_a_sound_network_has_none(document, small_library):
    assert _lines(document, small_library) == []


def _set(*path_and_value):
    """What sets the field at a path of the document."""
    *path, last, value = path_and_value

    def spoil(document):
        target = document
        for step in path:
            target = target[step]
        target[last] = value

    return spoil


def _more(*links, **modules):
    """What adds nodes and links."""

    def spoil(document):
        document["nodes"] |= {name: {"module": key} for name, key in modules.items()}
        document["links"] += [list(link) for link in links]

    return spoil


def _without(*ends):
    """What takes the links into these inputs away."""

    def spoil(document):
        document["links"] = [link for link in document["links"] if link[1] not in ends]

    return spoil


def _both(*spoils):
    def spoil(document):
        for one in spoils:
            one(document)

    return spoil


OF_JITTER = ("nodes", "jitter", "params")
BELOW_RANGE = _set(*OF_JITTER, "sigma_mrad", -1)
CHOICE = _set("nodes", "scene", "params", "kind", "dormitry")
CYCLE = _more(
    ("more.image", "again.image"), ("again.image", "more.image"), more="noise", again="noise"
)
DISABLED_SOURCE = _set("nodes", "scene", "disabled", True)
MISSING_INPUT = _without("jitter.magnitude")
SECOND_OUTPUT = _set("links", -1, 0, "add noise.noise")
TO_NOWHERE = _more(("scene.image", "gone.image"))
UNKNOWN_MODULE = _set("nodes", "jitter", "module", "jiter_mtf")

FAULTS = [
    (UNKNOWN_MODULE, "jitter: there is no module jiter_mtf; did you mean jitter_mtf?"),
    (
        _set(*OF_JITTER, {"sigma_mrd": 0.1}),
        "jitter: sigma_mrd = 0.1 is not allowed: Jitter MTF has",
    ),
    (BELOW_RANGE, "jitter: sigma_mrad = -1 mrad is not allowed: must be a number of at least 0"),
    (CHOICE, "scene: kind = 'dormitry' is not allowed: must be one of dormitory, point"),
    (
        _set("nodes", "init", "params", "near_m", 3),
        "init: near_m = 3.0 m is not allowed: must be at most",
    ),
    (_set("nodes", "look", "params", {}), "look: level is empty: must be a number"),
    (_set("links", 2, 0, "init.magnitud"), "init: Init & Trans has no output magnitud (the link"),
    (
        _both(
            _set("nodes", "more", {"module": "look", "params": {"level": 1}}),
            _more(("look.zzz", "more.picture")),
        ),
        "look: Examine has no output zzz (the link look.zzz → more.picture); allowed: none",
    ),
    (
        _both(_set("links", 0, ["init.phase", "look.other"]), _more(("scene.image", "init.image"))),
        "look: the link init.phase → look.other does not fit: the output gives phase, but the "
        "input takes image",
    ),
    (
        _more(("scene.image", "look.picture")),
        "look: the input picture has 2 links (add noise.image, scene.image); only one is allowed",
    ),
    (_more(("scene.image", "init.image")), "init: the input image has 2 links (scene.image, scene"),
    (CYCLE, "more: the links form a cycle: more → again → more; remove one of these links"),
    (MISSING_INPUT, "jitter: the input magnitude needs a link that carries magnitude"),
    (
        _both(
            _set("nodes", "jitter", "disabled", True),
            _without("jitter.magnitude", "jitter.context"),
        ),
        "jitter: the input magnitude needs a link that carries magnitude",
    ),
    (
        DISABLED_SOURCE,
        "scene: the link scene.image → init.image carries nothing: Scene is disabled; it passes "
        "on nothing and gives no image",
    ),
    (SECOND_OUTPUT, "add noise: the link add noise.noise → look.picture carries nothing: Noise is"),
    (_set("links", 0, 0, "scen.image"), "init: the link scen.image → init.image names scen, which"),
]


@pytest.mark.parametrize(("spoil", "begins"), FAULTS)
def test_one_fault_gives_one_line(spoil, begins, document, small_library):
    spoil(document)
    (line,) = _lines(document, small_library)
    assert line.startswith(begins)


def test_every_fault_is_found_in_order(document, small_library):
    for spoil in (MISSING_INPUT, TO_NOWHERE, CHOICE, BELOW_RANGE, CYCLE):
        spoil(document)
    document["nodes"]["scene"]["params"]["width"] = 0.5
    lines = _lines(document, small_library)
    assert [line.split()[:2] for line in lines] == [
        ["scene:", "kind"],
        ["scene:", "width"],
        ["jitter:", "sigma_mrad"],
        ["scene:", "the"],
        ["more:", "the"],
        ["jitter:", "the"],
    ]
    assert lines == _lines(document, small_library)


def test_unfinished_networks_may_be_worked_on(document, small_library):
    for spoil in (MISSING_INPUT, DISABLED_SOURCE, SECOND_OUTPUT):
        spoil(document)
    assert len(_lines(document, small_library)) == 3
    assert _lines(document, small_library, unfinished=True) == []


def test_a_disabled_module_needs_only_what_it_passes_on(document, small_library):
    document["nodes"]["jitter"]["disabled"] = True
    _without("jitter.context")(document)
    assert _lines(document, small_library) == []


def test_the_work_grows_with_a_hostile_number_of_faults_and_no_faster(small_library):
    def calls(size):
        nodes = {f"n{k}": Node(f"n{k}", f"nois{k}") for k in range(size)}
        nodes["s"] = Node("s", "scene_maker", {f"widt{k}": 0 for k in range(size)})
        links = tuple(Link(f"n{k}", "image", f"n{k ^ 1}", "image") for k in range(size))
        network, counted = Network(nodes=nodes, links=links), [0]

        def count(_frame, event, _argument):
            counted[0] += event in ("call", "c_call")

        sys.setprofile(count)
        try:
            found = problems(network, library=small_library)
        finally:
            sys.setprofile(None)
        assert len(found) == size * 2 + size // 2
        return counted[0]

    few, many = calls(2_000), calls(20_000)
    assert many < 12 * few
