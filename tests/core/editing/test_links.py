"""Why a link cannot be made, in words."""

import pytest

from core.editing.wiring import refusal
from core.network.network import Link, Network, Node


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
        ("init.magnitude", "picture.x", "picture has no input x: it has image"),
        ("picture.curve", "scene.image", "scene has no input image: it has none"),
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
