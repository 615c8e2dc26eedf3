"""Information, warnings and errors: told apart by colour and mark, each closed by a click."""

import re

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMainWindow, QStatusBar, QWidget

from app.editor.messages import ROLES, Mark, Notice, NoticeList
from app.editor.theme import THEMES
from core.editing.document import Document
from core.editing.operations import set_parameter
from core.network.network import Network
from user_texts import user_texts
from window_hands import add

KINDS = {"note": "information", "warning": "warning", "error": "error"}


def click(window, name):
    button = window.findChild(QWidget, name)
    assert button.isVisible(), name
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


def ink_of(mark):
    """The places of a mark's drawing, and its colour there."""
    picture = mark.grab().toImage()
    ink = mark.palette().color(ROLES[mark.severity]).name()
    places = {
        (x, y)
        for x in range(picture.width())
        for y in range(picture.height())
        if picture.pixelColor(x, y).name() == ink
    }
    return ink, frozenset(places)


def test_severities_are_told_apart_and_each_is_closed_by_a_click(window, idle):
    mark = window.findChild(QWidget, "status.message").findChild(Mark)
    for look, theme in THEMES.items():
        window.set_theme(theme)
        drawn = {}
        for kind, severity in KINDS.items():
            window.session.message.emit(kind, f"a {kind}")
            assert mark.severity == severity
            drawn[severity] = ink_of(mark)
            click(window, "status.message.close")
            assert not window.findChild(QWidget, "status.message").isVisible()
        assert len({ink for ink, _ in drawn.values()}) == 3, look
        assert len({shape for _, shape in drawn.values()}) == 3, look
        assert all(len(shape) > 20 for _, shape in drawn.values())
        hues = {severity: QColor(ink) for severity, (ink, _) in drawn.items()}
        assert hues["information"].hsvSaturation() < 60
        assert hues["error"].hsvHue() < 12
        assert 25 < hues["warning"].hsvHue() < 50
    # A warning outlives an edit.
    window.session.message.emit("warning", "another program has the file")
    window.session.message.emit("error", "not saved")
    assert window.status.said("error") == "not saved"
    assert window.status.said("warning") == "another program has the file"
    click(window, "status.message.close")
    label = window.findChild(QWidget, "status.message.text")
    assert label.text() == "another program has the file"
    add(window, "test_scene")
    window.session.do(set_parameter("test_scene", "width", 300))
    assert label.text() == "another program has the file"
    window.session.open(Document(Network(), library=window.session.library))
    assert window.status.said("warning") == ""
    # No band is kept for messages, and nothing moves.
    window.resize(1366, 768)
    window.show_canvas()
    idle(window)
    assert not QMainWindow.findChildren(window, QStatusBar)
    parts = [window.canvas, window.viewers.images[1].canvas, window.panels]
    before = [part.geometry() for part in parts]
    window.session.message.emit("error", "not opened: " + "a_long_name/" * 40)
    idle(window)
    assert [part.geometry() for part in parts] == before
    said = window.findChild(QWidget, "status.message")
    menus = window.menuBar()
    assert said.isVisible()
    assert menus.rect().contains(said.geometry().translated(window.status.pos()))
    assert window.status.x() >= menus.actionGeometry(menus.actions()[-1]).right()


def test_a_list_has_the_gravest_first_and_is_gone_once_all_are_closed(qtbot):
    shown = NoticeList("some", "Warnings", None)
    qtbot.addWidget(shown)
    shown.resize(300, 200)
    said = [("information", "a"), ("error", "c"), ("warning", "b " * 100), ("warning", "d")]
    shown.show_notices(said)
    assert [severity for severity, _ in shown.left] == [
        "error", "warning", "warning", "information",
    ]  # fmt: skip
    seen = [one.text for one in shown.findChildren(Notice) if one.isVisible()]
    assert seen == ["c", "b " * 100]
    assert shown.more.text() == "2 More"
    QTest.mouseClick(shown.more, Qt.MouseButton.LeftButton)
    assert [one.text for one in shown.findChildren(Notice) if one.isVisible()] == [
        *seen, "d", "a",
    ]  # fmt: skip
    for _ in said:
        assert shown.isVisible()
        first = next(one for one in shown.findChildren(Notice) if one.isVisible())
        QTest.mouseClick(first.away, Qt.MouseButton.LeftButton)
    assert not shown.isVisible()
    shown.show_notices([("warning", "d")])
    assert shown.isVisible()


SHARED = ("app/fit/", "app/measure/picture", "app/run/transfer_chain", "core/", "nodes/")


def test_no_text_of_the_window_names_an_option_of_the_command_line():
    """Those of errors are in `hint`; commands that have no window part name their own."""
    texts = list(user_texts())
    window = [text for text in texts if text.kind in ("window", "docstring")]
    modules = [text for text in window if text.place.startswith(("app/editor/", "nodes/"))]
    assert len(modules) > 300
    named = [text for text in modules if re.search(r"(?<![\w-])--[a-z]{2,}", text.words)]
    assert not named, named
    named = [
        text
        for text in texts
        if text.place.startswith(SHARED)
        and text.kind == "message"
        and re.search(r"(?<![\w-])--[a-z]{2,} ?", text.words)
        and not re.match(r"(or )?(give|leave out|raise)\b.{0,30}--", text.words)  # a hint
    ]
    assert [text for text in named if "photon_transfer" not in text.place] == []
