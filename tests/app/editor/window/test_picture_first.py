"""The picture has the most room: by default, in windows of any size, and by one key all of it."""

import itertools

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QFontInfo, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QInputDialog, QMenu, QMessageBox, QPushButton

from app.editor.canvas.node_item import OVERVIEW
from window_hands import show_small

SIZES = [(1366, 768), (1920, 1080), (3840, 2160)]
SHARE = 0.4


@pytest.fixture
def opened(window, idle):
    """The window with the network of the thesis' sensor."""
    show_small(window, "kodak_kir310")
    idle(window)
    return window


def canvas(window, number=1):
    return window.viewers.images[number].canvas


def share(window):
    """What the picture with its axes has of the window."""
    shown = canvas(window)
    return shown.width() * shown.height() / (window.width() * window.height())


def drawn(window, number=1):
    """Width and height of the picture itself on the screen, as it is drawn."""
    view = canvas(window, number).view
    corners = view.mapViewToScene(QPointF(0, 0)), view.mapViewToScene(QPointF(1, 1))
    across, down = (abs(b - a) for a, b in zip(*(p.toTuple() for p in corners), strict=True))
    facts = window.viewers.images[number].picture.facts
    return across * facts.columns, down * facts.rows


def test_the_picture_has_two_fifths_of_the_window(opened, idle):
    for size in SIZES:
        opened.resize(*size)
        idle(opened)
        assert (opened.width(), opened.height()) == size
        assert share(opened) >= SHARE, size
        for part in (opened.canvas, opened.panels, opened.library_view, opened.viewers.plot):
            assert part.isVisible(), size
            assert part.height() >= 0.12 * opened.height(), size


def test_the_names_of_fifteen_nodes_are_read_as_large_as_the_windows_text(opened, idle):
    opened.resize(1600, 900)
    idle(opened)
    opened.canvas.frame_all()
    view, nodes = opened.canvas.view, opened.canvas.content.nodes
    assert len(nodes) == 15
    assert view.relative_zoom < OVERVIEW
    plates = []
    for name, node in nodes.items():
        title = node.title_at(view.zoom)
        assert title is not None, name
        assert title.text.replace("\N{ZERO WIDTH SPACE}", "") == name
        assert title.font.pixelSize() * view.zoom >= QFontInfo(opened.font()).pixelSize(), name
        plate = node.plate(view.zoom).translated(node.pos())
        assert view.visible_rect().contains(plate), name
        assert node.sceneBoundingRect().contains(plate), name
        plates.append(plate)
    for one, other in itertools.combinations(plates, 2):
        assert not one.intersects(other)


def drag_separator(window, dx):
    """Drag the line left of the panels as a person does."""
    start, bench = QPoint(window.panel_dock.x() - 3, window.panel_dock.y() + 200), window.workbench
    left = Qt.MouseButton.LeftButton
    QTest.mousePress(bench, left, Qt.KeyboardModifier.NoModifier, start)
    for step in (4, dx // 2, dx):
        QTest.mouseMove(bench, start + QPoint(step, 0))
        QTest.qWait(30)
    QTest.mouseRelease(bench, left, Qt.KeyboardModifier.NoModifier, start + QPoint(dx, 0))


def test_what_is_dragged_keeps_its_share_when_the_window_grows(opened, idle):
    before = opened.panel_dock.width()
    drag_separator(opened, -120)
    idle(opened)
    wide = opened.panel_dock.width()
    assert wide == pytest.approx(before + 120, abs=8)
    opened.resize(2400, 1350)
    idle(opened)
    assert opened.panel_dock.width() == pytest.approx(1.5 * wide, abs=3)


def test_each_named_layout_can_be_chosen_and_left(opened, idle):
    for name in ("picture_beside", "canvas_first", "picture_below"):
        opened.actions_by_name[name].trigger()
        idle(opened)
        for part in (opened.canvas, opened.panels, opened.library_view, opened.viewers.plot):
            assert part.isVisible(), name
        assert (share(opened) >= SHARE) == (name != "canvas_first"), name
        opened.actions_by_name["reset_layout"].trigger()
        idle(opened)
        assert share(opened) >= SHARE, name
        below = canvas(opened).mapTo(opened, QPoint()).y()
        assert below > opened.canvas.mapTo(opened, QPoint()).y(), name


def entries(window):
    """The actions of the menu of saved layouts by their texts, opened as by the mouse."""
    window.layout_menu.aboutToShow.emit()
    found = window.layout_menu.actions()
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
    again.files.open_now("kodak_kir310")
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
    again.files.open_now("first_steps")
    idle(again)
    assert share(again) >= SHARE  # and no word of the empty canvas


# --- over the whole screen ---------------------------------------------------------------------


def page_of(window):
    return window.full_screen.page


def test_a_key_shows_the_viewer_over_the_whole_screen_and_back(opened, qtbot, idle):
    viewer = opened.viewers.images[1]
    viewer.canvas.setFocus()
    before = viewer.canvas.size()
    QTest.keyClick(opened, Qt.Key.Key_F11)
    idle(opened)
    page = page_of(opened)
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


# --- the picture in its viewer -----------------------------------------------------------------


def test_it_cannot_be_dragged_out_of_sight(opened, idle):
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
    facts = opened.viewers.images[1].picture.facts
    seen = shown.view.viewRect().center()
    assert -0.5 - 1e-6 <= seen.x() <= facts.columns - 0.5 + 1e-6
    assert -0.5 - 1e-6 <= seen.y() <= facts.rows - 0.5 + 1e-6
    assert not shown.fitted


def test_pixels_have_their_shape(window, idle):
    """486 rows are read off a square picture of 512: its pixels are higher than wide."""
    window.files.open_now("kodak_kir310")
    idle(window)
    facts = window.viewers.images[1].picture.facts
    image = window.evaluator.plan.output(window.viewers.images[1].choices.port)
    across, down = drawn(window)
    angle_across = facts.columns * image.interval_x_mrad
    angle_down = facts.rows * image.interval_y_mrad
    assert across / down == pytest.approx(angle_across / angle_down, rel=1e-3)


def opened_menu(qtbot):
    qtbot.waitUntil(lambda: isinstance(QApplication.activePopupWidget(), QMenu))
    return QApplication.activePopupWidget()


def test_a_right_click_opens_the_menu_of_the_picture(opened, qtbot, idle):
    shown = canvas(opened)
    QTest.mouseClick(shown.viewport(), Qt.MouseButton.RightButton, pos=shown.rect().center())
    menu = opened_menu(qtbot)
    texts = [action.text().replace("&", "").partition("\t")[0] for action in menu.actions()]
    assert [text for text in texts if text] == [
        *("Fit", "One Sample per Screen Pixel", "Copy Picture", "Copy Histogram as Numbers"),
        *("Display", "Compare", "Full Screen", "Export…"),
    ]
    copied = next(action for action in menu.actions() if "Copy" in action.text())
    copied.trigger()
    menu.close()
    image = QApplication.clipboard().image().convertToFormat(QImage.Format.Format_Grayscale8)
    grey = opened.viewers.images[1].picture.grey
    assert (image.width(), image.height()) == (grey.shape[1], grey.shape[0])
    assert image.pixelColor(100, 37).red() == grey[37, 100]
