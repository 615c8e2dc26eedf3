"""Named sets of parameters: kept in a file of the module, taken again in one step."""

import json

import pytest

from app.run.preset_files import given, remove_set, save_set, sets_of
from core.editing.document import Document
from core.errors import ImagechainError
from core.modules.declaration import declaration
from core.network.network import Network, Node
from nodes.library import standard_library

LIBRARY = standard_library()
MODULE = "gaussian_mtf"
SHARP = {"sigma_x_mrad": 0.25, "sigma_y_mrad": 0.5}


def node(params):
    return Node("blur", MODULE, params)


def document(params):
    return Document(Network(nodes={"blur": node(params)}), library=LIBRARY)


def take(made, values, name="sharp"):
    old = made.network.nodes["blur"]
    return made.do(given(name, values, old, declaration(LIBRARY[MODULE]), "blur"))


def test_a_set_is_kept_and_taken_again(tmp_path):
    folder = tmp_path / "sets"
    assert sets_of(MODULE, folder) == {}
    save_set("sharp", node(SHARP), folder)
    save_set("plain", node({}), folder)
    assert json.loads((folder / f"{MODULE}.json").read_text())["sets"] == {
        "sharp": SHARP,
        "plain": {},
    }
    made = document({"sigma_x_mrad": 2.0, "apply": "filter_only"})
    before = made.text()
    assert take(made, sets_of(MODULE, folder)["sharp"])
    assert dict(made.network.nodes["blur"].params) == SHARP  # what it leaves out has its default
    made.undo()
    assert made.text() == before
    assert made.redo_text == "Set blur to sharp"
    take(made, sets_of(MODULE, folder)["plain"])
    assert dict(made.network.nodes["blur"].params) == {}
    remove_set("sharp", MODULE, folder)
    assert list(sets_of(MODULE, folder)) == ["plain"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"sigma": 1}, "the saved parameters sharp include sigma, but Gaussian MTF has no"),
        ({"sigma_x_mrad": -1}, "sigma_x_mrad = -1 mrad is not allowed"),
    ],
)
def test_a_set_that_does_not_fit_changes_nothing(values, message):
    made = document(SHARP)
    with pytest.raises(ImagechainError, match=message):
        take(made, values)
    assert not made.undo_text
