"""Published cameras: every figure within its stated difference, every solved input solved again."""

import json

import pytest

from app.handbook.example_figures import PAGES, published_camera
from app.run.shipped import published_networks, shipped_networks
from command_line import run_here
from core.chain.engine import Engine
from core.network.file import format_network, load_network
from nodes.library import standard_library
from page_blocks import blocks_of

LIBRARY = standard_library()
FILES = published_networks()
DOCUMENTS = {name: json.loads(path.read_text(encoding="utf-8")) for name, path in FILES.items()}
SOLVED = [
    (name, entry["of"][0], entry["until"])
    for name, document in DOCUMENTS.items()
    for entry in document["inputs"]
    if "until" in entry
]
# Values that set up the computation and describe no instrument.
SET_UP = {
    "path", "unit", "fov_x_deg", "fov_y_deg", "kind", "width", "height", "temperature_K",
    "photon_weighting", "platform", "fill_x", "fill_y", "direction", "pixels_y", "reference_K",
}  # fmt: skip


@pytest.fixture(scope="module")
def engine():
    return Engine(LIBRARY)


def test_the_page_shows_each_once_in_five_families():
    words = [block.text.split() for block in blocks_of((PAGES / "published_cameras.md").read_text())
             if block.kind == "figure"]  # fmt: skip
    (overview, *listed), *families = words
    assert overview == "overview"
    assert {kind for kind, *_ in families} == {"published"}
    assert [name for _, *names in families for name in names] == listed
    assert sorted(listed) == sorted(FILES)
    assert not FILES.keys() & shipped_networks().keys()
    assert len(families) == 5
    assert len(listed) >= 14


@pytest.mark.parametrize("name", FILES)
def test_figures_are_within_their_stated_difference(name, engine):
    camera = published_camera(name, engine)
    for figure in camera["figures"]:
        assert figure["where"], figure["figure"]
        assert figure["reason"], figure["figure"]
        assert abs(figure["ours"] - figure["value"]) <= figure["within"], figure["figure"]


@pytest.mark.parametrize("name", FILES)
def test_a_network_is_sound_and_states_where_its_values_are_from(name, tmp_path):
    path, document = FILES[name], DOCUMENTS[name]
    network = load_network(path, library=LIBRARY)
    assert format_network(network, library=LIBRARY) == path.read_text(encoding="utf-8")
    assert set(network.layout) == set(network.nodes)
    done = run_here("check", name, folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert "warning" not in done.stdout
    given = {parameter for node in network.nodes.values() for parameter in node.params}
    stated = {port.partition(".")[2] for entry in document["inputs"] for port in entry["of"]}
    assert given - SET_UP <= stated


@pytest.mark.parametrize(("name", "parameter", "until"), SOLVED)
def test_solved_inputs_are_solved_again(name, parameter, until, tmp_path):
    """They are stored to four digits."""
    node, _, key = parameter.partition(".")
    words = "solve", name, "--for", parameter, "--until", until, "--json"
    done = run_here(*words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    stored = DOCUMENTS[name]["nodes"][node]["params"][key]
    assert json.loads(done.stdout)["value"] == pytest.approx(stored, rel=5e-4)
