"""Macros in a network file: read, written, written out, and what is wrong with bad ones."""

import copy
import json
from pathlib import Path

import pytest

from core.errors import NetworkError
from core.network.file import format_network, parse_network
from core.network.macro import expanded
from core.network.network import Link
from core.network.validation import problems
from nodes.library import standard_library

LIBRARY = standard_library()


@pytest.fixture
def document():
    """A scene into a camera, whose inside was written by hand."""
    return {
        "format": "imagechain-network",
        "version": 2,
        "name": "with a camera",
        "seed": 7,
        "nodes": {
            "scene": {"module": "test_scene", "params": {"width": 64, "height": 64}},
            "camera": {
                "module": "macro",
                "params": {"blur": 0.5},
                "macro": {
                    "title": "Small camera",
                    "description": "Blurs.",
                    "nodes": {
                        "init": {"module": "init_trans"},
                        "jitter": {"module": "jitter_mtf", "params": {"sigma_mrad": 0.125}},
                        "back": {"module": "back_transform"},
                    },
                    "links": [
                        ["init.context", "jitter.context"],
                        ["init.magnitude", "jitter.magnitude"],
                        ["init.phase", "back.phase"],
                        ["jitter.magnitude", "back.magnitude"],
                    ],
                    "layout": {"init": [0, 0], "jitter": [200, 0], "back": [400, 0]},
                    "inputs": {"image": "init.image"},
                    "outputs": {"image": "back.image"},
                    "parameters": {"blur": "jitter.sigma_mrad"},
                },
            },
            "save": {"module": "write_image", "params": {"path": "out.npy"}},
        },
        "links": [["scene.image", "camera.image"], ["camera.image", "save.image"]],
    }


def read(document):
    return parse_network(json.dumps(document), library=LIBRARY)


def inside(document):
    return document["nodes"]["camera"]["macro"]


def faults(document):
    return [str(fault) for fault in problems(read(document), library=LIBRARY)]


def test_a_macro_is_written_as_it_was_read(document):
    network = read(document)
    text = format_network(network, library=LIBRARY)
    assert json.loads(text) == document
    assert read(json.loads(text)) == network


def test_shipped_networks_stay_of_version_1_but_where_a_parameter_follows_another():
    shipped = Path(__file__).parents[3] / "networks"
    files = sorted(shipped.glob("*.json"))
    assert files
    for file in files:
        text = file.read_text()
        assert json.loads(text)["version"] == (2 if '"expression"' in text else 1)
        assert format_network(parse_network(text, library=LIBRARY), library=LIBRARY) == text


def test_a_macro_is_written_out_as_plain_nodes(document):
    network = expanded(read(document), LIBRARY)
    assert list(network.nodes) == ["scene", "camera/init", "camera/jitter", "camera/back", "save"]
    assert network.nodes["camera/jitter"].params == {"sigma_mrad": 0.5}
    assert set(network.links) == {
        Link("scene", "image", "camera/init", "image"),
        Link("camera/init", "context", "camera/jitter", "context"),
        Link("camera/init", "magnitude", "camera/jitter", "magnitude"),
        Link("camera/jitter", "magnitude", "camera/back", "magnitude"),
        Link("camera/init", "phase", "camera/back", "phase"),
        Link("camera/back", "image", "save", "image"),
    }
    assert network.port_names == {"camera.image": "camera/back.image"}
    assert network.parameter_names == {"camera.blur": "camera/jitter.sigma_mrad"}


def test_a_disabled_macro_passes_its_picture_through(document):
    document["nodes"]["camera"]["disabled"] = True
    assert not faults(document)
    network = expanded(read(document), LIBRARY)
    assert list(network.nodes) == ["scene", "save"]
    assert network.links == (Link("scene", "image", "save", "image"),)
    assert network.port_names == {"camera.image": "scene.image"}


def test_a_disabled_macro_with_nothing_to_pass_on(document):
    document["nodes"]["camera"]["disabled"] = True
    inside(document)["outputs"]["spectrum"] = "init.magnitude"
    document["nodes"]["slices"] = {"module": "mtf_slices"}
    document["links"].append(["camera.spectrum", "slices.transfer"])
    assert faults(document)[0] == (
        "camera: the link camera.spectrum → slices.transfer carries nothing: the macro is "
        "disabled, and none of its inputs is passed on as spectrum"
    )


def nested(document, deep):
    """The camera inside of `deep` macros that each show all it shows."""
    for number in range(deep):
        inner = document["nodes"].pop("camera")
        document["nodes"]["camera"] = {
            "module": "macro",
            "macro": {
                "nodes": {"inner": inner},
                "inputs": {"image": "inner.image"},
                "outputs": {"image": "inner.image"},
                "parameters": {"blur": "inner.blur"},
            },
        }
        document["nodes"]["camera"]["params"] = {"blur": 0.25 + number}
    return document


def test_macros_inside_of_macros(document):
    network = expanded(read(nested(document, 2)), LIBRARY)
    name = "camera/inner/inner/jitter"
    assert network.nodes[name].params == {"sigma_mrad": 1.25}  # of the outermost
    assert network.port_names["camera.image"] == "camera/inner/inner/back.image"
    assert network.parameter_names["camera.blur"] == f"{name}.sigma_mrad"
    assert network.parameter_names["camera/inner.blur"] == f"{name}.sigma_mrad"
    assert Link("scene", "image", "camera/inner/inner/init", "image") in network.links
    assert not faults(document)


def test_macros_lie_so_deep_at_most(document):
    assert not faults(nested(copy.deepcopy(document), 7))
    with pytest.raises(NetworkError, match="macros are nested more than 8 levels deep"):
        read(nested(document, 8))


def change(path, value):
    def changed(document):
        target = document
        for step in path[:-1]:
            target = target[step]
        target[path[-1]] = value
        return document

    return changed


MACRO = ("nodes", "camera", "macro")


@pytest.mark.parametrize(
    ("path", "value", "begins"),
    [
        ((*MACRO, "outputs", "image"), "back.picture",
         "camera: the macro's output image names back.picture, but Back Transform has no output"),
        ((*MACRO, "parameters", "other"), "jitter.sigma",
         "camera: the macro's parameter other names jitter.sigma, but Jitter MTF has no parameter "
         "sigma"),
        ((*MACRO, "inputs", "other"), "jiter.context",
         "camera: the macro's input other names jiter.context, but there is no node jiter inside; "
         "did you mean jitter?"),
        ((*MACRO, "parameters", "again"), "jitter.sigma_mrad",
         "camera: the inner parameter jitter.sigma_mrad is set by 2 parameters of the macro"),
        ((*MACRO, "inputs", "again"), "init.image",
         "camera: the inner input init.image is fed by 2 inputs of the macro; only one is allowed"),
        ((*MACRO, "inputs", "phase"), "back.phase",
         "camera: the macro's input phase feeds back.phase, which already has a link inside the "
         "macro"),
        (("nodes", "camera", "params"), {"blurr": 1},
         "camera: blurr = 1 is not allowed: Small camera shows no such parameter; did you mean"),
        (("links", 1, 0), "camera.picture",
         "camera: the macro has no output picture (the link camera.picture → save.image); allowed"),
        (("nodes", "camera/back"), {"module": "back_transform"},
         "camera/back is the id of 2 nodes, one of them inside a macro. Give each node an id"),
    ],
)  # fmt: skip
def test_bad_macros_give_one_clear_line(path, value, begins, document):
    found = faults(change(path, value)(document))
    assert any(line.startswith(begins) for line in found)
    assert not any("\n" in line for line in found)


def test_a_cycle_of_disabled_macros_comes_to_an_end(document):
    """Each passes on what the other does: there is no picture to be had."""
    document["nodes"]["other"] = copy.deepcopy(document["nodes"]["camera"])
    for name, feeds in (("camera", "other"), ("other", "camera")):
        document["nodes"][name]["disabled"] = True
        document["links"].append([f"{name}.image", f"{feeds}.image"])
    del document["links"][0]
    assert any("the links form a cycle" in line for line in faults(document))
    assert not expanded(read(document), LIBRARY).links


def test_a_cycle_through_a_macro(document):
    document["nodes"]["camera"]["macro"]["inputs"]["light"] = "pixels.image"
    inside(document)["nodes"]["pixels"] = {"module": "combine_pixels"}
    inside(document)["outputs"]["other"] = "pixels.image"
    document["nodes"]["between"] = {"module": "combine_pixels"}
    document["links"] += [["camera.other", "between.image"], ["between.image", "camera.light"]]
    assert (
        "camera: the links form a cycle: camera → between → camera; remove one of these links"
        in (faults(document))
    )


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("nodes", "camera"), {"module": "macro"}, "has the module macro but no field macro"),
        (("nodes", "scene", "macro"), {}, "nodes.scene is not a macro but has a field macro"),
        ((*MACRO, "outputs", "image"), 3, "macro.outputs.image must be a string, NODE.NAME, not 3"),
        (
            (*MACRO, "parameters", "a.b"),
            "jitter.sigma_mrad",
            "parameters has the name 'a.b': a name",
        ),
    ],
)
def test_what_is_no_macro_is_refused_when_read(path, value, message, document):
    with pytest.raises(NetworkError) as refused:
        read(change(path, value)(document))
    assert message in refused.value.message
