"""Nodes and wires added by the lists that float on the canvas, and by what is dropped on it."""

from dataclasses import replace

from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QAction, QDragEnterEvent, QDragLeaveEvent, QDragMoveEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.canvas.adding import possible_links
from app.editor.canvas.overlays import Choice, matching
from app.editor.library_view import module_data
from core.editing.grouping import group
from core.network.network import Link
from linked_network import linked_network

COPY = Qt.DropAction.CopyAction
NONE = Qt.KeyboardModifier.NoModifier
LEFT = Qt.MouseButton.LeftButton


def titles(canvas):
    rows = range(canvas.popup.list.count())
    return [canvas.popup.list.item(row).text() for row in rows]


def position(session):
    return session.document.history.position


def test_tab_opens_the_search_and_enter_adds_at_the_mouse(session, canvas, hand, library):
    hand.click(hand.at(120, 60))
    hand.key(Qt.Key.Key_Tab)
    assert canvas.popup.is_open
    assert len(titles(canvas)) == len(library)
    assert QApplication.activeModalWidget() is None
    hand.type("gauss")
    assert titles(canvas) == ["Gaussian MTF"]
    hand.key(Qt.Key.Key_Return)
    assert not canvas.popup.is_open
    assert session.network.nodes["gaussian_mtf"].module == "gaussian_mtf"
    assert session.network.layout["gaussian_mtf"] == (120.0, 60.0)
    assert session.selection == ("gaussian_mtf",)
    assert position(session) == 1
    assert canvas.view.hasFocus()


def test_double_click_on_empty_ground_opens_the_search(session, canvas, hand):
    hand.double_click(hand.at(-40, 80))
    assert canvas.popup.is_open
    hand.type("read image")
    hand.key(Qt.Key.Key_Return)
    assert session.network.layout["read_image"] == (-40.0, 80.0)


def test_the_arrows_and_the_mouse_choose_too(session, canvas, hand):
    canvas.open_search()
    hand.type("scene")
    hand.key(Qt.Key.Key_Down)
    hand.key(Qt.Key.Key_Up)
    hand.key(Qt.Key.Key_Return)
    assert "test_scene" in session.network.nodes
    canvas.open_search()
    listed = canvas.popup.list
    row = listed.visualItemRect(listed.item(2)).center()
    title = listed.item(2).text()
    QTest.mouseClick(listed.viewport(), LEFT, NONE, row)
    (added,) = set(session.network.nodes) - {"test_scene"}
    assert session.declared(added).title == title


def test_modules_are_found_by_title_key_and_group(session, canvas, hand):
    canvas.open_search()
    for typed, title in (
        ("zyx", None),
        ("turbul", "Atmosphere MTF"),  # of its summary
        ("roi", "Measured MTF"),
        ("netd", "Figures of Merit"),
        ("charge_eff_p", "Charge Transfer Phase"),
        ("motion", "Jitter MTF"),
        ("Electronics &", "Electronics & Noise"),
    ):
        canvas.popup.field.setText(typed)
        assert (title in titles(canvas)) if title else not titles(canvas)
    hand.key(Qt.Key.Key_Return)
    assert session.network.nodes


def test_escape_and_a_click_elsewhere_close_the_search(session, canvas, hand):
    canvas.open_search()
    hand.type("jitter")
    hand.key(Qt.Key.Key_Escape)
    assert not canvas.popup.is_open
    canvas.open_search()
    hand.click(hand.at(-300, 200))
    assert not canvas.popup.is_open
    assert not session.network.nodes
    assert canvas.view.hasFocus()


def test_the_list_stays_within_a_small_canvas(session, canvas, qtbot):
    canvas.resize(420, 260)
    canvas.open_search()
    popup = canvas.popup
    assert canvas.view.rect().contains(popup.geometry())
    assert popup.list.height() >= popup.list.sizeHintForRow(0)


def test_keys_typed_into_the_list_are_no_shortcuts(session, canvas, hand):
    fired = []
    for key in ("D", "1", "Tab", "Esc", "Del"):
        action = QAction(key, canvas)
        action.setShortcut(key)
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        action.triggered.connect(lambda *_, key=key: fired.append(key))
        canvas.addAction(action)
    canvas.open_search()
    hand.type("d1")
    hand.key(Qt.Key.Key_Tab)
    hand.key(Qt.Key.Key_Delete)
    hand.key(Qt.Key.Key_Escape)
    assert fired == []
    hand.key(Qt.Key.Key_D)
    assert fired == ["D"]


def test_another_document_closes_the_list(opened, canvas):
    canvas.open_search()
    opened("first_steps")
    assert not canvas.popup.is_open


def test_what_is_typed_ranks_what_begins_so_first():
    choices = [Choice("Exit Pupil MTF", 1), Choice("Test Scene", 2), Choice("MTF Slices", 3)]
    assert [each.value for each in matching(choices, "mtf")] == [3, 1]
    assert [each.value for each in matching(choices, "")] == [1, 2, 3]
    assert [each.value for each in matching(choices, "mtf exit")] == [1]
    assert matching(choices, "nothing") == []


# --- wiring by the keyboard -----------------------------------------------------------------------


def test_the_keyboard_wires_a_node(opened, canvas, hand):
    session = opened("first_steps")
    canvas.open_search()
    hand.type("jitter")
    hand.key(Qt.Key.Key_Return)
    canvas.adding.connect_selected()
    assert canvas.popup.is_open
    hand.type("init.context jitter_mtf")
    hand.key(Qt.Key.Key_Return)
    assert Link.between("init.context", "jitter_mtf.context") in session.network.links
    canvas.adding.connect_selected()
    hand.type("disconnect")
    hand.key(Qt.Key.Key_Return)
    assert not session.network.links_into("jitter_mtf")


def test_possible_wires_fit(opened, library):
    network = opened("first_steps").network
    found = possible_links(network, library, ["back"])
    links = [str(link) for link in found]
    assert "scene.image → back.magnitude" not in links
    assert "back.image → init.image" not in links  # a cycle
    assert "init.magnitude → back.magnitude" in links
    remark = found[Link.between("init.magnitude", "back.magnitude")]
    assert remark == "instead of blur.magnitude"
    assert "blur.magnitude → back.magnitude" not in links  # is there already


def test_wires_into_empty_inputs_that_need_one_come_first(library):
    """Then those into other empty inputs, then those that take another wire's place.

    The nodes stand in an order that is the other way round.
    """
    network = linked_network(
        {
            "taken": ("jitter_mtf", {}),
            "optional": ("exit_pupil_mtf", {}),
            "needing": ("jitter_mtf", {}),
            "init": ("init_trans", {}),
            "other": ("init_trans", {}),
        },
        [
            ("other.context", "taken.context"),
            ("other.magnitude", "taken.magnitude"),
            ("other.context", "optional.context"),
            ("other.magnitude", "optional.magnitude"),
            ("other.context", "needing.context"),
        ],
    )
    found = possible_links(network, library, ["init"])
    assert [(str(link), remark) for link, remark in found.items()] == [
        ("init.magnitude → needing.magnitude", ""),
        ("init.phase → optional.phase", ""),
        ("init.context → taken.context", "instead of other.context"),
        ("init.magnitude → taken.magnitude", "instead of other.magnitude"),
        ("init.context → optional.context", "instead of other.context"),
        ("init.magnitude → optional.magnitude", "instead of other.magnitude"),
        ("init.context → needing.context", "instead of other.context"),
    ]


def test_a_macro_is_wired_by_the_ports_that_it_shows(opened, library):
    plain = opened("kodak_kir310").network
    name, step = group(plain, library, ["charge"], "lines")
    network = step.apply(plain)
    links = [link for link in network.links if name in (link.source, link.target)]
    bare = replace(network, links=tuple(link for link in network.links if link not in links))
    assert set(links) <= set(possible_links(bare, library, [name]))


def test_of_several_nodes_only_wires_among_them(opened, library):
    network = opened("kodak_kir310").network
    found = possible_links(network, library, ["init", "charge"])
    assert {str(link) for link in found} == {"init.magnitude → charge.magnitude"}


def test_without_a_selection_there_is_a_word(opened, canvas):
    session = opened("first_steps")
    told = []
    session.message.connect(lambda kind, text: told.append((kind, text)))
    canvas.adding.connect_selected()
    assert not canvas.popup.is_open
    assert told[0][0] == "advice"


# --- drops ----------------------------------------------------------------------------------------


def drag_event(kind, pos, data):
    """A drag event; their points are of floating point from Qt 6.12 on."""
    try:
        return kind(QPointF(pos), COPY, data, LEFT, NONE)
    except TypeError:
        return kind(pos, COPY, data, LEFT, NONE)


def drag_and_drop(canvas, data, pos, *, leave=False):
    """What Qt sends while something is dragged over the canvas; whether it was taken."""
    viewport = canvas.view.viewport()
    QApplication.sendEvent(viewport, drag_event(QDragEnterEvent, pos, data))
    moving = drag_event(QDragMoveEvent, pos, data)
    QApplication.sendEvent(viewport, moving)
    if leave:
        QApplication.sendEvent(viewport, QDragLeaveEvent())
        return False
    event = QDropEvent(QPointF(pos), COPY, data, LEFT, NONE)
    QApplication.sendEvent(viewport, event)
    return moving.isAccepted() and event.isAccepted()


def test_a_module_of_the_library_becomes_a_node(session, canvas, hand):
    assert drag_and_drop(canvas, module_data("jitter_mtf"), hand.at(30, 44))
    assert session.network.layout == {"jitter_mtf": (30.0, 44.0)}
    assert session.selection == ("jitter_mtf",)


def test_a_module_dropped_on_a_wire_is_put_into_it(opened, canvas, hand):
    session = opened("first_steps")
    canvas.frame_all()
    link = Link.between("blur.magnitude", "back.magnitude")
    drag_and_drop(canvas, module_data("jitter_mtf"), hand.wire(link), leave=True)
    assert not canvas.content.wires[link].target
    assert drag_and_drop(canvas, module_data("jitter_mtf"), hand.wire(link))
    assert link not in session.network.links
    assert Link.between("blur.magnitude", "jitter_mtf.magnitude") in session.network.links
    assert Link.between("init.context", "jitter_mtf.context") in session.network.links
    assert position(session) == 1


def test_a_module_nobody_knows_is_not_taken(session, canvas, hand):
    assert not drag_and_drop(canvas, module_data("perpetuum_mobile"), hand.at(0, 0))
    assert not session.network.nodes


def test_files_are_handed_on_with_their_point(session, canvas, hand, qtbot, tmp_path):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(tmp_path / "a.exr")), QUrl("https://example.org/b.exr")])
    with qtbot.waitSignal(canvas.surface.files_dropped) as told:
        assert drag_and_drop(canvas, data, hand.at(60, 12))
    paths, point = told.args
    assert paths == [str(tmp_path / "a.exr")]
    assert (round(point.x()), round(point.y())) == (60, 12)


def test_a_text_is_not_taken(session, canvas, hand):
    data = QMimeData()
    data.setText("scene")
    assert not drag_and_drop(canvas, data, QPoint(50, 50))
