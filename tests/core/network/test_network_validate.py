from __future__ import annotations

import json
import pickle
import sys

import pytest

from core.errors import NetworkError, ParameterError
from core.network.network import Link, Network, Node
from core.network.parsing import parse_network
from core.network.validation import NetworkProblems, check_network, problems


def _lines(document, library, **options):
    network = parse_network(json.dumps(document), library=library)
    found = problems(network, library=library, **options)
    assert all(error.exit_code == 2 for error in found)
    assert found == [] or not any("\n" in str(error) for error in found)
    return [str(error) for error in found]


def test_a_sound_network_has_none(document, small_library):
    assert _lines(document, small_library) == []


def _drop(document, *ends):
    document["links"] = [link for link in document["links"] if link[1] not in ends]


def _unknown_module(document):
    document["nodes"]["jitter"]["module"] = "jiter_mtf"


def _unknown_module_like_none(document):
    document["nodes"]["jitter"]["module"] = "zzz\x1b"


def _unknown_parameter(document):
    document["nodes"]["jitter"]["params"] = {"sigma_mrd": 0.1}


def _unknown_parameter_like_none(document):
    document["nodes"]["jitter"]["params"] = {"\x1b[2J": 1}


def _below_range(document):
    document["nodes"]["jitter"]["params"]["sigma_mrad"] = -1


def _wrong_kind(document):
    document["nodes"]["jitter"]["params"]["sigma_mrad"] = {"a": [1]}


def _choice(document):
    document["nodes"]["scene"]["params"]["kind"] = "dormitry"


def _combination(document):
    document["nodes"]["init"]["params"]["near_m"] = 3


def _required_parameter(document):
    document["nodes"]["look"]["params"] = {}


def _unknown_output(document):
    document["links"][2][0] = "init.magnitud"


def _unknown_input(document):
    document["links"][2][1] = "jitter.zzz"


def _output_of_a_sink(document):
    document["nodes"]["more"] = {"module": "look", "params": {"level": 1}}
    document["links"].append(["look.zzz", "more.picture"])


def _types(document):
    document["links"][0] = ["init.phase", "look.other"]
    document["links"].append(["scene.image", "init.image"])


def _two_links(document):
    document["links"].append(["scene.image", "look.picture"])


def _the_same_link_twice(document):
    document["links"].append(document["links"][0])


def _cycle(document):
    document["nodes"]["more"] = {"module": "noise"}
    document["links"] += [["more.image", "again.image"], ["again.image", "more.image"]]
    document["nodes"]["again"] = {"module": "noise"}


def _itself(document):
    document["nodes"]["more"] = {"module": "noise"}
    document["links"].append(["more.image", "more.image"])


def _missing_input(document):
    _drop(document, "jitter.magnitude")


def _missing_either(document):
    _drop(document, "look.picture")


def _disabled_without_its_main_input(document):
    document["nodes"]["jitter"]["disabled"] = True
    _drop(document, "jitter.magnitude", "jitter.context")


def _disabled_source(document):
    document["nodes"]["scene"]["disabled"] = True


def _disabled_second_output(document):
    document["links"][-1][0] = "add noise.noise"


def _link_from_nowhere(document):
    document["links"][0][0] = "scen.image"


def _link_to_nowhere(document):
    document["links"].append(["scene.image", "gone.image"])


FAULTS = [
    (_unknown_module, "jitter: there is no module jiter_mtf; did you mean jitter_mtf?"),
    (
        _unknown_module_like_none,
        "jitter: there is no module 'zzz\\x1b'; the command `imagechain modules` lists those "
        "there are",
    ),
    (
        _unknown_parameter,
        "jitter: sigma_mrd = 0.1 is not allowed: Jitter MTF has no such parameter; "
        "did you mean sigma_mrad?",
    ),
    (
        _unknown_parameter_like_none,
        "jitter: '\\x1b[2J' = 1 is not allowed: Jitter MTF has no such parameter: "
        "it has sigma_mrad",
    ),
    (
        _below_range,
        "jitter: sigma_mrad = -1 mrad is not allowed: a number of at least 0",
    ),
    (
        _wrong_kind,
        "jitter: sigma_mrad = {'a': [1]} mrad is not allowed: a number of at least 0",
    ),
    (_choice, "scene: kind = 'dormitry' is not allowed: one of dormitory, point"),
    (_combination, "init: near_m = 3.0 m is not allowed: at most far_m = 2.0"),
    (_required_parameter, "look: level is empty: a number"),
    (
        _unknown_output,
        "init: Init & Trans has no output magnitud (the link init.magnitud → jitter.magnitude); "
        "did you mean magnitude?",
    ),
    (
        _output_of_a_sink,
        "look: Examine has no output zzz (the link look.zzz → more.picture): it has none",
    ),
    (_types, "look: the link init.phase → look.other does not fit: phase into image"),
    (
        _two_links,
        "look: the input picture has 2 links (add noise.image, scene.image); it takes one",
    ),
    (
        _the_same_link_twice,
        "init: the input image has 2 links (scene.image, scene.image); it takes one",
    ),
    (_cycle, "more: the links form a cycle: more → again → more; take one of them away"),
    (_itself, "more: the links form a cycle: more → more; take one of them away"),
    (_missing_input, "jitter: the input magnitude needs a link that brings magnitude"),
    (_missing_either, "look: the input picture needs a link that brings image or transfer"),
    (
        _disabled_without_its_main_input,
        "jitter: the input magnitude needs a link that brings magnitude",
    ),
    (
        _disabled_source,
        "scene: the link scene.image → init.image brings nothing: Scene is disabled and passes "
        "nothing on, it makes no image",
    ),
    (
        _disabled_second_output,
        "add noise: the link add noise.noise → look.picture brings nothing: Noise is disabled "
        "and passes image on, it makes no noise",
    ),
    (
        _link_to_nowhere,
        "scene: the link scene.image → gone.image names gone, which is no node of this network",
    ),
]


@pytest.mark.parametrize(("spoil", "line"), FAULTS)
def test_one_fault_gives_one_line(spoil, line, document, small_library):
    spoil(document)
    assert _lines(document, small_library) == [line]


def test_a_link_from_nowhere_suggests_a_node(document, small_library):
    _link_from_nowhere(document)
    assert _lines(document, small_library) == [
        "init: the link scen.image → init.image names scen, which is no node of this network; "
        "did you mean scene?"
    ]


def test_a_wrong_input_leaves_the_right_one_open(document, small_library):
    _unknown_input(document)
    assert _lines(document, small_library) == [
        "jitter: Jitter MTF has no input zzz (the link init.magnitude → jitter.zzz): "
        "it has context, magnitude",
        "jitter: the input magnitude needs a link that brings magnitude",
    ]


def test_every_fault_is_found_in_order(document, small_library):
    for spoil in (_missing_input, _link_to_nowhere, _choice, _below_range, _cycle):
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
    for spoil in (_missing_input, _disabled_source, _disabled_second_output):
        spoil(document)
    assert len(_lines(document, small_library)) == 3
    assert _lines(document, small_library, unfinished=True) == []


def test_a_disabled_module_needs_only_what_it_passes_on(document, small_library):
    document["nodes"]["jitter"]["disabled"] = True
    _drop(document, "jitter.context")
    assert _lines(document, small_library) == []


def test_kept_unknown_modules_may_have_any_port(document, small_library):
    _unknown_module(document)
    assert len(_lines(document, small_library)) == 1
    assert _lines(document, small_library, keep_unknown=True) == []


def test_what_check_raises_knows_all_problems(document, small_library):
    _below_range(document)
    _missing_input(document)
    network = parse_network(json.dumps(document), library=small_library)
    with pytest.raises(NetworkProblems) as caught:
        check_network(network, library=small_library)
    error = caught.value
    assert isinstance(error, NetworkError)
    assert error.exit_code == 2
    assert error.more == 1
    assert [type(problem) for problem in error.problems] == [ParameterError, NetworkError]
    assert str(error) == str(error.problems[0])
    assert error.node == "jitter"
    assert error.__cause__ is error.problems[0]


def test_problems_can_be_pickled():
    error = NetworkProblems([NetworkError("first", node="a"), NetworkError("second")])
    again = pickle.loads(pickle.dumps(error))
    assert [str(problem) for problem in again.problems] == ["a: first", "second"]
    assert str(again.at("b")) == "a: first"


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
