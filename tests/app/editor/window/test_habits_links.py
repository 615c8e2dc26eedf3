"""What becomes of linked parameters when nodes are deleted and copied: with keys, in the window."""

import pytest

from core.editing.document import Document
from core.network.linked_values import expression
from linked_network import linked_network
from window_hands import KEY, WindowHands

CHAIN = linked_network(
    {
        "scene": ("test_scene", {"width": 64, "height": 64}),
        "init": ("init_trans", {"f_number": 2.0}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": expression("init.f_number * 0.2")}),
    }
)


@pytest.fixture
def session(window, library):
    hand = WindowHands(window)
    hand.begin()
    window.session.open(Document(CHAIN, library=library))
    window.canvas.frame_all()
    hand.focus()
    return window.session


def stored(session, node="blur"):
    return session.network.nodes[node].params["sigma_x_mrad"]


def test_what_a_deleted_node_was_followed_for_stays(window, session):
    said = []
    session.message.connect(lambda kind, text: said.append((kind, text)))
    before = session.document.text()
    session.select(["init"])
    WindowHands(window).key(KEY.Key_Delete)
    assert "init" not in session.network.nodes
    assert stored(session) == 0.4
    assert ("note", "no longer linked, but values kept: blur.sigma_x_mrad = 0.4") in said
    assert session.document.position == 1
    session.undo()
    assert session.document.text() == before
