"""The library: every module by group, found by typing, chosen and dragged."""

import pytest
from PySide6.QtCore import QMimeData, Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest

from app.editor.library_view import MIME_TYPE, LibraryView, dragged_module
from app.editor.theme import DARK, LIGHT
from core.modules.declaration import declaration
from screen_places import place_of_module

NONE, LEFT = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton


@pytest.fixture
def view(qtbot, library):
    made = LibraryView(library)
    qtbot.addWidget(made)
    made.resize(240, 500)
    made.show()
    qtbot.waitExposed(made)
    made.activateWindow()
    made.setFocus()
    return made


@pytest.fixture
def chosen(view):
    found = []
    view.chosen.connect(found.append)
    return found


def visible(view):
    return [key for key, item in view.tree.modules.items() if not item.isHidden()]


def test_every_module_stands_under_its_group_in_the_librarys_order(view, library):
    groups = [view.tree.topLevelItem(n).text(0) for n in range(view.tree.topLevelItemCount())]
    assert groups == list(dict.fromkeys(declaration(module).group for module in library.values()))
    for group, item in view.tree.groups.items():
        there = [item.child(row).text(0) for row in range(item.childCount())]
        wanted = [declaration(m).listed for m in library.values() if declaration(m).group == group]
        assert there == wanted
    for key, module in library.items():
        assert view.tree.modules[key].toolTip(0) == declaration(module).text


def test_typing_leaves_what_fits(view):
    QTest.keyClicks(view.filter, "line transfer")
    assert visible(view) == []
    view.filter.setText("jitter")
    assert visible(view) == ["jitter_mtf"]
    assert [name for name, item in view.tree.groups.items() if not item.isHidden()] == ["Motion"]
    view.filter.setText("MOTION mtf")
    assert set(visible(view)) > {"jitter_mtf", "vibration_mtf"}
    view.filter.clear()
    assert len(visible(view)) == len(view.tree.modules)


def test_a_double_click_chooses_and_a_group_does_not(view, chosen):
    viewport = view.tree.viewport()
    pos = viewport.mapFromGlobal(place_of_module(view, "detector_mtf"))
    QTest.mouseClick(viewport, LEFT, NONE, pos)
    QTest.mouseDClick(viewport, LEFT, NONE, pos)
    assert chosen == ["detector_mtf"]
    group = view.tree.visualItemRect(view.tree.groups["Detector"]).center()
    QTest.mouseDClick(viewport, LEFT, NONE, group)
    assert chosen == ["detector_mtf"]


def test_what_is_dragged_is_the_modules_key(view):
    data = view.tree.mimeData([view.tree.modules["exit_pupil"]])
    assert bytes(data.data(MIME_TYPE).data()) == b"exit_pupil"
    assert dragged_module(data) == "exit_pupil"
    assert view.tree.mimeTypes() == [MIME_TYPE]
    assert not view.tree.groups["Optics"].flags() & Qt.ItemFlag.ItemIsDragEnabled
    assert dragged_module(QMimeData()) == ""


def test_words_of_the_trade_find_their_module(view, chosen):
    """What fits best is marked, so that Enter adds it; the others stay in sight."""
    for typed, best, also in (
        ("NETD", "figures_of_merit", {"electronics_noise"}),
        ("fixed pattern", "focal_plane", {"electronics_noise", "noise_3d"}),
        ("blur", "spatial_blur", {"gaussian_mtf", "jitter_mtf", "diffraction_mtf"}),
        ("gsmtf", "gaussian_mtf", set()),
    ):
        view.filter.clear()
        QTest.keyClicks(view.filter, typed)
        assert {best, *also} <= set(visible(view))
        QTest.keyClick(view.filter, Qt.Key.Key_Return)
        assert chosen[-1] == best


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_each_group_is_marked_in_its_colour(view, theme):
    view.setPalette(theme.palette())
    for name, item in view.tree.groups.items():
        mark = item.icon(0).pixmap(16).toImage().pixelColor(2, 2)
        assert mark == QColor(theme.groups.get(name, theme.line)), name
