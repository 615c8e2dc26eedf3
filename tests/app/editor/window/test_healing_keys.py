"""Del and Ctrl+X in mid-chain lead the wire past what is taken out."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest


def links_of(window):
    return {str(link) for link in window.session.network.links}


@pytest.mark.parametrize(
    ("key", "keys"),
    [
        (Qt.Key.Key_Delete, Qt.KeyboardModifier.NoModifier),
        (Qt.Key.Key_X, Qt.KeyboardModifier.ControlModifier),
    ],
)
def test_a_key_takes_a_node_out_and_heals_the_wire(kodak, key, keys):
    before = links_of(kodak)
    kodak.session.select(["detector"])
    kodak.canvas.setFocus()
    QTest.keyClick(kodak.canvas.view, key, keys)
    assert "detector" not in kodak.session.network.nodes
    assert "aberration.magnitude → charge.magnitude" in links_of(kodak)
    if key == Qt.Key.Key_X:
        assert '"detector"' in QGuiApplication.clipboard().text()
    kodak.session.undo()
    assert links_of(kodak) == before
