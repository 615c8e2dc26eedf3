"""Networks with macros on the command line: the files are those of the plain network."""

import json

import numpy as np
import pytest

from app.run.shipped import find_network
from core.editing.macros import expose, group
from core.network.file import load_network, save_network
from nodes.library import standard_library

LIBRARY = standard_library()
MEMBERS = ("init", "pupil", "optics", "aberration", "detector", "charge", "charge_phase", "back")


@pytest.fixture
def networks(tmp_path):
    """The KIR-310 on a small scene, plain and with its camera as one node; the file names."""
    network = load_network(find_network("kodak_kir310").path, library=LIBRARY)
    for side in ("width", "height"):
        network = network.with_parameter("scene", side, 64)
    save_network(network, tmp_path / "plain.json", library=LIBRARY)
    members = (*MEMBERS, "pixels", "electronics", "frame_grabber")
    network = group(network, LIBRARY, members, "camera")[1].apply(network)
    network = expose(network, "camera/init", "f_number").apply(network)
    save_network(network, tmp_path / "grouped.json", library=LIBRARY)
    return "plain.json", "grouped.json"


@pytest.mark.parametrize("given", ["camera.f_number=3", "camera/init.f_number=3"])
def test_a_run_gives_the_same_picture_and_figures(given, networks, imagechain, tmp_path):
    plain, grouped = networks
    inner = "init.f_number=3"
    one = imagechain(
        *("run", plain, "--set", inner, "--save", "frame_grabber.image=one.npy"),
        *("--output-dir", "a"),
    )
    other = imagechain(
        *("run", grouped, "--set", given, "--save", "camera.image=other.npy"),
        *("--save", "camera/frame_grabber.image=third.npy", "--output-dir", "b"),
    )
    assert (one.returncode, other.returncode) == (0, 0), other.stderr
    first = np.load(tmp_path / "one.npy")
    assert np.array_equal(first, np.load(tmp_path / "other.npy"))
    assert np.array_equal(first, np.load(tmp_path / "third.npy"))
    assert (tmp_path / "a/final.png").read_bytes() == (tmp_path / "b/final.png").read_bytes()
    figures, others = (json.loads((tmp_path / each / "readouts.json").read_text()) for each in "ab")
    assert {name.removeprefix("camera/"): value for name, value in others.items()} == figures | {
        key: value for key, value in others.items() if key == "imagechain.warnings"
    }


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            "camera.f_numbr=2",
            "the macro has no such parameter on its panel; did you mean f_number?",
        ),
        ("camera/init.f_numbr=2", "Init & Trans has no parameter f_numbr; did you mean f_number?"),
        ("camera.f_number=-2", "camera/init: f_number = -2 is not allowed: a number of at least 0"),
    ],
)
def test_bad_settings(given, message, networks, fails):
    assert message in fails("run", networks[1], "--set", given)
