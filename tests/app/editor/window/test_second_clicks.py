"""Double-clicks where one click is enough: the second one is not for what has come since."""

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton, QWidget

from app.editor.recovery_files import Autosave, recoverable
from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.network.file import load_network

LEFT, NO_BUTTON = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
NO_KEY = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def slow_hand():
    """However slow the machine is, two clicks in a row are a double-click."""
    before = QApplication.doubleClickInterval()
    QApplication.setDoubleClickInterval(60_000)
    yield
    QApplication.setDoubleClickInterval(before)


def double_click(window, spot):
    """The second press goes to what is under the mouse once the first click is done with."""
    QTest.mouseClick(window.windowHandle(), LEFT, NO_KEY, spot)
    for _ in range(5):
        QApplication.processEvents()
    kinds = (QEvent.Type.MouseButtonDblClick, LEFT), (QEvent.Type.MouseButtonRelease, NO_BUTTON)
    for kind, held in kinds:
        at, far = QPointF(spot), QPointF(window.mapToGlobal(spot))
        event = QMouseEvent(kind, at, far, LEFT, held, NO_KEY)
        QApplication.sendEvent(window.windowHandle(), event)


def is_module(window, spot):
    """Whether a module of the library is shown there."""
    tree = window.library_view.tree
    return tree.indexAt(tree.viewport().mapFrom(window, spot)).parent().isValid()


@pytest.fixture
def left_behind(tmp_path, library):
    """Work of two networks, as two windows that crashed leave it."""
    for name in ("first_steps", "pupils"):
        network = load_network(shipped_networks()[name], library=library)
        autosave = Autosave(Document(network, library=library, saved=False), tmp_path / "recovery")
        autosave.write_if_changed()
        autosave._let_go()  # its process is dead
    return tmp_path / "recovery"


def test_a_second_click_discards_no_second_work(left_behind, make_window, qtbot):
    assert len(recoverable(left_behind)) == 2
    window = make_window()
    qtbot.wait(50)
    button = window.findChild(QPushButton, "welcome.discard")
    spot = button.mapTo(window, button.rect().center())
    for _ in range(2):
        QTest.mouseClick(window.windowHandle(), LEFT, NO_KEY, spot)
        qtbot.wait(50)
    assert len(recoverable(left_behind)) == 1


def test_opening_by_double_clicks_changes_nothing(make_window, qtbot, tmp_path, slow_hand):
    path = tmp_path / "mine.json"
    path.write_text(shipped_networks()["first_steps"].read_text())
    window = make_window()
    window.files.open_now(str(path))
    qtbot.wait(50)
    modules = [QPoint(80, y) for y in range(window.height()) if is_module(window, QPoint(80, y))]
    for _ in range(3):  # the library remembers where it was pressed last
        window.show_welcome()
        qtbot.wait(50)
        row = window.findChild(QWidget, "welcome.recent.mine.json")
        under = (spot for spot in modules if row.rect().contains(row.mapFrom(window, spot)))
        double_click(window, next(under))
        assert window.canvas.isVisible()
        assert list(window.session.network.nodes) == ["scene", "init", "blur", "back", "picture"]
        assert not window.isWindowModified()
