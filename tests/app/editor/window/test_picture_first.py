"""The picture has the most room: by default, in windows of any size, and by one key all of it."""

import itertools

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QContextMenuEvent, QFontInfo, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QInputDialog, QMenu, QMessageBox, QPushButton

from app.editor.canvas.node_item import OVERVIEW
from app.editor.window.main_window import MainWindow
from core.editing.operations import set_parameter
from window_hands import show_small

SIZES = [(1366, 768), (1600, 900), (1920, 1080), (2560, 1440), (3840, 2160)]
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


@pytest.mark.parametrize("size", [(1600, 900), (2560, 1440)])
def test_the_names_of_fifteen_nodes_are_read_as_large_as_the_windows_text(opened, idle, size):
    opened.resize(*size)
    idle(opened)
    opened.canvas.frame_all()
    view, nodes = opened.canvas.view, opened.canvas.content.nodes
    assert len(nodes) == 15
    assert view.relative_zoom < OVERVIEW
    plates = []
    for name, node in nodes.items():
        title = node.title_at(view.zoom)
        assert title is not None, name
        assert "".join(title.lines).replace(" ", "") == name
        assert title.font.pixelSize() * view.zoom >= QFontInfo(opened.font()).pixelSize(), name
        plate = node.plate(view.zoom).translated(node.pos())
        assert view.visible_rect().contains(plate), name
        assert node.sceneBoundingRect().contains(plate), name
        plates.append(plate)
    for one, other in itertools.combinations(plates, 2):
        assert not one.intersects(other)


def test_there_and_back_it_has_the_size_it_had(opened, idle):
    before = canvas(opened).size()
    for size in [(1000, 700), (2560, 1440), (1600, 900)]:
        opened.resize(*size)
        idle(opened)
    assert abs(canvas(opened).width() - before.width()) <= 2
    assert abs(canvas(opened).height() - before.height()) <= 2


def drag_separator(window, dx):
    """Drag the line left of the panels as a person does."""
    start = QPoint(window.panel_dock.x() - 3, window.panel_dock.y() + 200)
    left = Qt.MouseButton.LeftButton
    QTest.mousePress(window, left, Qt.KeyboardModifier.NoModifier, start)
    for step in (4, dx // 2, dx):
        QTest.mouseMove(window, start + QPoint(step, 0))
        QTest.qWait(30)
    QTest.mouseRelease(window, left, Qt.KeyboardModifier.NoModifier, start + QPoint(dx, 0))


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


def test_beside_the_chain_a_square_picture_is_larger(opened, idle):
    below = drawn(opened)
    opened.actions_by_name["picture_beside"].trigger()
    idle(opened)
    assert drawn(opened)[1] > 1.15 * below[1]


def test_reset_brings_back_what_was_closed_and_floats(opened, idle):
    opened.panel_dock.close()
    opened.viewers.docks[1].setFloating(True)
    opened.library_dock.close()
    opened.actions_by_name["reset_layout"].trigger()
    idle(opened)
    assert opened.panel_dock.isVisible()
    assert opened.library_dock.isVisible()
    assert not opened.viewers.docks[1].isFloating()
    assert share(opened) >= SHARE


def test_a_window_made_anew_is_as_it_was_left(opened, make_window, idle):
    opened.actions_by_name["picture_beside"].trigger()
    idle(opened)
    places = [dock.geometry() for dock in (opened.panel_dock, opened.viewers.docks[1])]
    opened.close()
    again = make_window()
    again.files.open_now("kodak_kir310")
    idle(again)
    now = [dock.geometry() for dock in (again.panel_dock, again.viewers.docks[1])]
    for before, after in zip(places, now, strict=True):
        for a, b in zip(before.getRect(), after.getRect(), strict=True):
            assert abs(a - b) <= 4


def test_a_layout_chosen_beside_the_first_page_is_that_of_the_network(make_window, idle):
    window = make_window()
    window.actions_by_name["picture_beside"].trigger()
    idle(window)
    assert window.welcome.isVisible()
    assert not window.panels.isVisible()
    window.files.open_now("kodak_kir310")
    idle(window)
    assert share(window) >= SHARE
    assert canvas(window).mapTo(window, QPoint()).x() < window.canvas.mapTo(window, QPoint()).x()


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
    again.files.new()
    idle(again)
    assert not entries(again)["&Save Current as…"].isEnabled()  # its docks are put away
    (delete,) = entries(again)["&Delete"].menu().actions()
    delete.trigger()
    assert list(entries(again)) == ["&Save Current as…", "&Delete"]


def test_an_empty_network_has_a_large_canvas_until_there_is_a_picture(make_window, idle):
    window = make_window()
    window.files.new()
    idle(window)
    shown = window.canvas.width() * window.canvas.height()
    assert shown >= 0.5 * window.width() * window.height()
    assert window.library_view.isVisible()
    assert not canvas(window).isVisible()
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


def test_a_click_on_the_first_page_does_not_undo_what_was_dragged(opened, idle):
    drag_separator(opened, -120)
    idle(opened)
    wide = opened.panel_dock.width()
    opened.show_welcome()
    idle(opened)
    QTest.mouseClick(opened.welcome, Qt.MouseButton.LeftButton, pos=QPoint(4, 4))
    opened.show_canvas()
    opened.resize(2400, 1350)
    idle(opened)
    assert opened.panel_dock.width() == pytest.approx(1.5 * wide, abs=3)


def test_a_first_window_that_is_not_maximised_lies_within_its_screen(library, settings, tmp_path):
    window = MainWindow(library=library, settings=settings, recovery=tmp_path)
    room, first = window.screen().availableSize(), window.size()
    window.close_for_good()
    assert first.width() < room.width()
    assert first.height() < room.height()
    assert first.width() * first.height() >= 0.55 * room.width() * room.height()


# --- over the whole screen ---------------------------------------------------------------------


def page_of(window):
    return window.full_screen.page


@pytest.mark.parametrize("way_back", [Qt.Key.Key_F11, Qt.Key.Key_Escape])
def test_a_key_shows_the_viewer_over_the_whole_screen_and_back(opened, qtbot, idle, way_back):
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
    QTest.keyClick(page, way_back)
    qtbot.waitUntil(lambda: not viewer.window().isFullScreen())
    idle(opened)
    assert viewer.window() is opened
    assert opened.viewers.docks[1].widget() is viewer
    assert viewer.canvas.size() == before


def test_the_curves_go_over_the_whole_screen_where_they_were_used_last(opened, idle):
    opened.viewers.plot.canvas.setFocus()
    QTest.keyClick(opened, Qt.Key.Key_F11)
    idle(opened)
    assert page_of(opened) is opened.viewers.plot


def test_all_windows_close_at_the_end_of_the_desktop_with_one_over_the_whole_screen(opened, idle):
    """Qt stops closing, and the desktop's end with it, at the first window that refuses."""
    opened.actions_by_name["full_screen"].trigger()
    idle(opened)
    assert page_of(opened).close()
    idle(opened)
    assert opened.viewers.images[1].window() is opened
    assert opened.viewers.images[1].isVisible()


def test_the_keyboard_stays_with_the_viewer_over_the_whole_screen_and_back(opened, qtbot, idle):
    shown = canvas(opened)
    shown.setFocus()
    opened.actions_by_name["full_screen"].trigger()
    qtbot.waitUntil(lambda: QApplication.focusWidget() is shown)
    shown.zoom_by(6)
    QTest.keyClick(page_of(opened).windowHandle(), Qt.Key.Key_F)
    assert shown.zoom is None
    QTest.keyClick(page_of(opened).windowHandle(), Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: QApplication.focusWidget() is shown)
    assert shown.window() is opened


def test_the_window_is_resized_while_its_picture_is_over_the_whole_screen(opened, idle):
    opened.actions_by_name["full_screen"].trigger()
    idle(opened)
    opened.resize(1400, 900)
    idle(opened)
    opened.actions_by_name["full_screen"].trigger()
    idle(opened)
    assert share(opened) >= SHARE


def test_there_is_no_viewer_to_show_over_the_first_page(make_window, idle, qtbot):
    window = make_window()
    with qtbot.waitSignal(window.session.message) as message:
        window.actions_by_name["full_screen"].trigger()
    assert message.args == ["note", "no viewer is open to show in full screen"]
    assert page_of(window) is None


def test_the_window_ends_while_a_viewer_is_over_the_whole_screen(opened, idle):
    opened.actions_by_name["full_screen"].trigger()
    idle(opened)
    assert opened.close()
    assert not page_of(opened) or not page_of(opened).isVisible()


def test_the_viewer_is_back_in_its_place_when_the_window_asks(opened, idle):
    """The question brings the window to the front, where the viewer would be missing."""
    opened.session.do(set_parameter("scene", "width", 256))
    opened.actions_by_name["full_screen"].trigger()
    idle(opened)
    assert not opened.close()
    (question,) = opened.findChildren(QMessageBox, "save_changes")
    assert opened.full_screen.page is None
    assert question.isVisible()
    QTest.keyClick(question, Qt.Key.Key_Escape)
    idle(opened)
    assert canvas(opened).isVisible()
    assert canvas(opened).window() is opened


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
    window.viewers.images[1].bar.display.shape.trigger()
    idle(window)
    across, down = drawn(window)
    assert across / down == pytest.approx(facts.columns / facts.rows, rel=1e-3)


def opened_menu(qtbot):
    qtbot.waitUntil(lambda: isinstance(QApplication.activePopupWidget(), QMenu))
    return QApplication.activePopupWidget()


def test_a_right_click_opens_the_menu_of_the_picture(opened, qtbot, idle):
    shown = canvas(opened)
    QTest.mouseClick(shown.viewport(), Qt.MouseButton.RightButton, pos=shown.rect().center())
    menu = opened_menu(qtbot)
    texts = [action.text().replace("&", "").partition("\t")[0] for action in menu.actions()]
    assert [text for text in texts if text] == [
        *("Fit", "One Sample, One Dot", "Copy Picture", "Copy Histogram as Numbers"),
        *("Display", "Compare", "Full Screen", "Export…"),
    ]
    copied = next(action for action in menu.actions() if "Copy" in action.text())
    copied.trigger()
    menu.close()
    image = QApplication.clipboard().image().convertToFormat(QImage.Format.Format_Grayscale8)
    grey = opened.viewers.images[1].picture.grey
    assert (image.width(), image.height()) == (grey.shape[1], grey.shape[0])
    assert image.pixelColor(100, 37).red() == grey[37, 100]


def test_the_key_for_menus_opens_it_too(opened, qtbot):
    shown = canvas(opened)
    middle = shown.rect().center()
    reason = QContextMenuEvent.Reason.Keyboard
    QApplication.sendEvent(shown, QContextMenuEvent(reason, middle, shown.mapToGlobal(middle)))
    menu = opened_menu(qtbot)
    assert menu.objectName() == "picture_menu"
    menu.close()


def test_a_narrow_plot_has_its_legend_below(opened, idle):
    plot = opened.viewers.plot
    assert plot.list.geometry().top() > plot.canvas.geometry().center().y()
    assert plot.canvas.width() > 0.9 * plot.width()
    opened.actions_by_name["canvas_first"].trigger()
    idle(opened)
    assert plot.list.geometry().left() > plot.canvas.geometry().center().x()
