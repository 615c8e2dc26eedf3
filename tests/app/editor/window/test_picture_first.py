"""The picture has the most room: by default, in windows of any size, and by one key all of it."""

import itertools
import re

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QFontInfo, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QInputDialog, QMenu, QMessageBox, QPushButton

from app.editor.canvas.node_item import OVERVIEW
from app.editor.window.viewer_docks import in_sight
from window_hands import show_small

SIZES = [(1366, 768), (1920, 1080), (3840, 2160)]
SHARE = 0.4


@pytest.fixture
def opened(window, idle):
    """The window with the network of the thesis' sensor."""
    show_small(window, "kodak_kir310")
    idle(window)
    return window


def canvas(window):
    return window.viewers.images[1].canvas


def share(window):
    """What the picture with its axes has of the window."""
    shown = canvas(window)
    return shown.width() * shown.height() / (window.width() * window.height())


def drawn(window):
    """Width and height of the picture itself on the screen, as it is drawn."""
    view = canvas(window).view
    corners = view.mapViewToScene(QPointF(0, 0)), view.mapViewToScene(QPointF(1, 1))
    across, down = (abs(b - a) for a, b in zip(*(p.toTuple() for p in corners), strict=True))
    facts = window.viewers.images[1].picture.facts
    return across * facts.columns, down * facts.rows


def test_the_picture_has_two_fifths_of_the_window_in_every_layout(opened, idle):
    def assert_all_seen(what):
        for part in (opened.canvas, opened.panels, opened.library_view, opened.viewers.plot):
            assert part.isVisible(), what
            assert part.height() >= 0.12 * opened.height(), what

    for size in SIZES:
        opened.resize(*size)
        idle(opened)
        assert (opened.width(), opened.height()) == size
        assert share(opened) >= SHARE, size
        assert_all_seen(size)
    opened.resize(1600, 900)
    for name in ("picture_beside", "canvas_first", "picture_below"):
        opened.actions_by_name[name].trigger()
        idle(opened)
        assert_all_seen(name)
        assert (share(opened) >= SHARE) == (name != "canvas_first"), name
        opened.actions_by_name["reset_layout"].trigger()
        idle(opened)
        assert share(opened) >= SHARE, name
        below = canvas(opened).mapTo(opened, QPoint()).y()
        assert below > opened.canvas.mapTo(opened, QPoint()).y(), name


def test_the_library_stands_behind_the_panels_where_the_window_is_narrow(opened, idle):
    def is_behind():
        return opened.library_dock in opened.workbench.tabifiedDockWidgets(opened.panel_dock)

    for size, behind in (((1600, 900), False), ((1366, 768), True), ((1600, 900), False)):
        opened.resize(*size)
        idle(opened)
        assert is_behind() == behind, size
        assert in_sight(opened.panel_dock), size
        nodes = opened.canvas.content.nodes.values()
        assert all(node.title_at(opened.canvas.view.zoom) is not None for node in nodes), size
    opened.resize(1366, 768)
    idle(opened)
    opened.library_dock.raise_()
    idle(opened)
    assert in_sight(opened.library_dock)
    opened.session.select(["pupil"])
    idle(opened)
    assert in_sight(opened.panel_dock)
    opened.actions_by_name["new"].trigger()
    idle(opened)
    assert is_behind()
    assert in_sight(opened.library_dock)  # beside an empty canvas


def test_the_names_of_fifteen_nodes_are_read_as_large_as_the_windows_text(opened):
    opened.canvas.frame_all()
    view, nodes = opened.canvas.view, opened.canvas.content.nodes
    assert len(nodes) == 15
    assert view.zoom / view.style_of_canvas.natural_zoom < OVERVIEW
    plates = []
    for name, node in nodes.items():
        title = node.title_at(view.zoom)
        assert title is not None, name
        assert re.sub("-?[\n\N{ZERO WIDTH SPACE}]", "", title.text) == name
        assert title.font.pixelSize() * view.zoom >= QFontInfo(opened.font()).pixelSize(), name
        plate = node.plate(view.zoom).translated(node.pos())
        assert view.visible_rect().contains(plate), name
        assert node.sceneBoundingRect().contains(plate), name
        plates.append(plate)
    for one, other in itertools.combinations(plates, 2):
        assert not one.intersects(other)


def entries(window):
    """The actions of the menu of saved layouts by their texts, opened as by the mouse."""
    window.layout_menu.aboutToShow.emit()
    found = window.layout_menu.actions()
    assert len(window.layout_menu.findChildren(QMenu)) == 1  # the one before it is not left
    return {action.text(): action for action in found if not action.isSeparator()}


def save_layout(window, name):
    entries(window)["&Save Current as…"].trigger()
    dialog = window.findChild(QInputDialog)
    dialog.setTextValue(name)
    dialog.accept()
    dialog.deleteLater()


def test_a_layout_is_saved_chosen_in_another_window_and_deleted(opened, make_window, idle):
    assert list(entries(opened)) == ["&Save Current as…", "&Delete"]
    opened.actions_by_name["picture_beside"].trigger()
    opened.library_dock.close()
    idle(opened)
    place = opened.viewers.docks[1].geometry()
    save_layout(opened, "Mine & yours")
    save_layout(opened, " ")  # no name
    opened.actions_by_name["reset_layout"].trigger()
    idle(opened)
    assert opened.library_dock.isVisible()
    opened.close()
    again = make_window()
    show_small(again, "kodak_kir310")
    idle(again)
    entries(again)["Mine && yours"].trigger()
    idle(again)
    assert not again.library_dock.isVisible()
    now = again.viewers.docks[1].geometry()
    for before, after in zip(place.getRect(), now.getRect(), strict=True):
        assert abs(before - after) <= 4
    (delete,) = entries(again)["&Delete"].menu().actions()
    delete.trigger()
    assert list(entries(again)) == ["&Save Current as…", "&Delete"]


def test_an_empty_network_has_a_large_canvas_until_it_has_a_node(make_window, idle):
    window = make_window()
    window.files.new()
    idle(window)
    shown = window.canvas.width() * window.canvas.height()
    assert shown >= 0.5 * window.width() * window.height()
    assert window.library_view.isVisible()
    assert not canvas(window).isVisible()
    assert not entries(window)["&Save Current as…"].isEnabled()  # its docks are put away
    window.canvas.add_module("test_scene")
    idle(window)
    assert share(window) >= SHARE
    window.files.new(None)  # the scene was not saved: it asks
    window.findChild(QMessageBox).findChild(QPushButton, "discard").click()
    idle(window)
    assert not canvas(window).isVisible()
    window.close()
    again = make_window()
    show_small(again, "first_steps")
    idle(again)
    assert share(again) >= SHARE  # and no word of the empty canvas


# --- over the whole screen ---------------------------------------------------------------------


def test_the_viewer_keeps_its_picture_in_sight_in_shape_and_on_the_whole_screen(
    opened, qtbot, idle
):
    viewer = opened.viewers.images[1]
    # 486 rows are read off a square picture of 512: its pixels are higher than wide.
    facts, image = viewer.picture.facts, opened.evaluator.plan.output(viewer.choices.port)
    across, down = drawn(opened)
    angles = facts.columns * image.interval_x_mrad, facts.rows * image.interval_y_mrad
    assert angles[1] / angles[0] == pytest.approx(1.0, abs=0.02)
    assert facts.rows != facts.columns
    assert across / down == pytest.approx(angles[0] / angles[1], rel=1e-3)
    viewer.canvas.setFocus()
    before = viewer.canvas.size()
    QTest.keyClick(opened, Qt.Key.Key_F11)
    idle(opened)
    page = opened.full_screen.page
    assert page.isFullScreen()
    assert page is viewer
    assert viewer.isVisible()
    page.activateWindow()
    QTest.keyClick(page, Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: not viewer.window().isFullScreen())
    idle(opened)
    assert viewer.window() is opened
    assert opened.viewers.docks[1].widget() is viewer
    assert viewer.canvas.size() == before
    # It cannot be dragged out of sight.
    shown = canvas(opened)
    view = shown.viewport()
    middle = view.rect().center()
    for _ in range(4):
        QTest.mousePress(view, Qt.MouseButton.LeftButton, pos=middle)
        for x in range(0, 400, 50):
            QTest.mouseMove(view, middle + QPoint(x, x // 3))
            QTest.qWait(10)
        QTest.mouseRelease(view, Qt.MouseButton.LeftButton, pos=middle + QPoint(400, 133))
    idle(opened)
    seen = shown.view.viewRect().center()
    assert -0.5 - 1e-6 <= seen.x() <= facts.columns - 0.5 + 1e-6
    assert -0.5 - 1e-6 <= seen.y() <= facts.rows - 0.5 + 1e-6
    assert not shown.fitted
    # A right click opens its menu.
    QTest.mouseClick(shown.viewport(), Qt.MouseButton.RightButton, pos=shown.rect().center())
    qtbot.waitUntil(lambda: isinstance(QApplication.activePopupWidget(), QMenu))
    menu = QApplication.activePopupWidget()
    texts = [action.text().replace("&", "").partition("\t")[0] for action in menu.actions()]
    assert [text for text in texts if text] == [
        *("Fit", "One Sample per Screen Pixel", "Copy Picture", "Copy Histogram as Numbers"),
        *("Display", "Compare", "Full Screen", "Export…"),
    ]
    copied = next(action for action in menu.actions() if "Copy" in action.text())
    copied.trigger()
    menu.close()
    image = QApplication.clipboard().image().convertToFormat(QImage.Format.Format_Grayscale8)
    grey = viewer.picture.grey
    assert (image.width(), image.height()) == (grey.shape[1], grey.shape[0])
    assert image.pixelColor(100, 37).red() == grey[37, 100]
