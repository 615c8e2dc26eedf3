"""What a person expects of the viewers, in the window as it is: real keys and mouse."""

import json

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLabel, QLineEdit, QWidget

from app.editor.window.files import shipped_copy
from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.editing.document import Document
from core.evaluation.work import Policy
from editor_queries import Asking, Gate
from small_networks import SHIPPED, small_network
from thorough import some_of
from window_hands import CTRL, KEY, WindowHands, add, give_focus


@pytest.fixture
def hand(window, idle):
    """Hands on a window with the small shipped network."""
    made = WindowHands(window)
    window.files.open_now("first_steps")
    made.focus()
    idle(window)
    return made


def value(window, port):
    """The samples by an engine of its own."""
    session = window.session
    engine = Engine(session.library)
    plan = engine.plan(session.network, folder=session.folder)
    return engine.value(plan, port, engine.work(Policy()))


# --- numbers show nodes ------------------------------------------------------------------------


def test_a_number_shows_the_selected_node_in_that_viewer(window, hand, idle):
    hand.select("scene")
    samples = value(window, "scene.image")
    for number in (1, 2, 9):
        hand.focus()
        hand.key(KEY(ord(str(number))))
        idle(window)
        viewer = window.viewers.images[number]
        assert viewer.choices.port == "scene.image", number
        assert viewer.isVisible(), number
        np.testing.assert_array_equal(viewer.picture.samples, samples, f"{number}")


def test_of_a_node_without_outputs_what_comes_into_it_is_shown(window, hand, idle):
    name = add(window, "write_image", (900, 300))
    hand.window.canvas.frame_all()
    hand.drag(hand.port("back", "image", "output"), hand.port(name, "image", "input"))
    hand.select(name)
    hand.key(KEY.Key_2)
    idle(window)
    assert window.viewers.images[2].choices.port == "back.image"


def test_a_deleted_node_leaves_its_input_and_errors_the_place_of_the_hint(window, hand, idle):
    viewer, plot = window.viewers.images[1], window.viewers.plot
    hand.select("back")
    hand.key(KEY.Key_1)
    idle(window)
    assert viewer.choices.port == "back.image"
    hand.focus()
    hand.key(KEY.Key_Delete)
    idle(window)
    assert viewer.choices.port == "scene.image"
    assert viewer.picture is not None
    hand.key(KEY.Key_Z, CTRL)
    idle(window)
    assert viewer.choices.port == "back.image"
    # A viewer that never showed a picture says why, where it said what to do.
    link = next(link for link in window.session.network.links if link.source == "scene")
    hand.click(hand.wire(link))
    hand.key(KEY.Key_Delete)
    hand.select("back")
    hand.key(KEY.Key_2)
    idle(window)
    hint = next(label for label in window.viewers.images[2].findChildren(QLabel)
                if label.isVisible() and len(label.text()) > 20)  # fmt: skip
    assert "init" in hint.text()
    assert "Choose a wire" not in hint.text()
    # Curves go with their node, also where nothing is selected any more.
    hand.focus()
    hand.key(KEY.Key_Z, CTRL)
    name = add(window, "mtf_slices", (900, 300))
    window.canvas.frame_all()
    hand.select(name)
    idle(window)
    assert plot.port == f"{name}.curve"
    hand.select("scene")
    idle(window)
    assert plot.port is None
    hand.select(name)
    assert plot.port == f"{name}.curve"
    hand.click(hand.at(-100, 500))
    idle(window)
    assert window.session.selection == ()
    assert plot.port is None
    assert plot.canvas.isVisible()  # the chain's


def test_a_node_that_gives_curves_is_shown_among_the_curves(window, hand, idle):
    name = add(window, "mtf_slices", (900, 300))
    window.canvas.frame_all()
    declared = window.session.declared(name)
    curve = next(p.name for p in declared.outputs if p.types[0] in ("curve", "table"))
    hand.select(name)
    hand.key(KEY.Key_3)
    idle(window)
    assert window.viewers.plot.port == f"{name}.{curve}"
    assert window.viewers.plot_dock.isVisible()


# --- writing what is shown ---------------------------------------------------------------------


def export(window, hand, path):
    hand.key(KEY.Key_E, CTRL)
    dialog = window.findChild(QFileDialog, "export_dialog")
    assert dialog.isVisible()
    edit = dialog.findChild(QLineEdit, "fileNameEdit")
    give_focus(edit)
    edit.setText(str(path))
    QTest.keyClick(edit, KEY.Key_Return)
    QApplication.processEvents()


def test_a_picture_is_exported(window, hand, idle, tmp_path):
    for suffix in (".png", ".npy", ".csv", ".tif", ".exr"):
        give_focus(window.viewers.images[1].canvas)
        path = tmp_path / f"shown{suffix}"
        export(window, hand, path)
        assert path.stat().st_size > 0, suffix
        assert str(path) in window.status.said("information"), suffix
    samples = window.viewers.images[1].picture.samples
    np.testing.assert_array_equal(np.load(tmp_path / "shown.npy"), samples)


# --- panels ------------------------------------------------------------------------------------


def test_what_escape_left_uncomputed_is_said_until_it_is_computed(window, hand, idle, qtbot):
    """What is shown then is of the network before the last change, and looks as if it were not."""
    said, gate = window.findChild(QWidget, "status.behind"), Gate()
    assert not said.isVisible()
    window.evaluator.ask("test", [Asking(gate)])
    qtbot.waitUntil(gate.entered.is_set)
    hand.focus()
    hand.key(KEY.Key_Escape)
    qtbot.waitUntil(said.isVisible)
    window.session.message.emit("note", "saved")
    assert said.isVisible()
    gate.opened.set()
    hand.key(KEY.Key_Return, CTRL)
    idle(window)
    assert not said.isVisible()


def test_pinned_panels_are_kept_in_the_file_and_there_again(window, hand, idle, tmp_path):
    hand.select("scene")
    QTest.mouseClick(window.panels.panels["scene"].head.pin, Qt.MouseButton.LeftButton)
    hand.select("back")
    assert set(window.panels.panels) == {"scene", "back"}
    path = tmp_path / "pinned.json"
    window.session.save(path)
    assert json.loads(path.read_text())["nodes"]["scene"]["pinned"] is True
    window.files.new()
    assert not window.panels.panels
    window.files.open_now(str(path))
    idle(window)
    assert set(window.panels.panels) == {"scene"}
    assert window.panels.panels["scene"].isVisible()


def test_every_panel_says_what_its_controls_are(window, idle):
    """Of six shipped networks at a size of 64, on which what the panels have does not depend.

    Nodes of one module with the same choices have the same panel, which is looked at once.
    """
    library, seen = window.session.library, {}
    for name in some_of(sorted(shipped_networks()), 6):
        network = small_network(name, 64, 64)
        document = Document(network, library=library, path=SHIPPED / f"{name}.json")
        window.files.show(shipped_copy(document))
        idle(window)
        assert window.status.said("error") == "", name
        assert window.viewers.images[1].picture is not None, name
        for node in window.session.network.nodes.values():
            panel = (node.module, repr(choices(window.session, node)))
            if panel not in seen:
                window.session.select([node.id])
                QApplication.processEvents()  # until then nothing of the panel is visible
                seen[panel] = controls(window.panels, (name, node.id))
    assert all(seen.values())


def choices(session, node):
    """What decides which controls its panel has."""
    declared = session.declared(node.id)
    kinds = {each.name: each.kind for each in declared.parameters}
    return {
        name: value
        for name, value in node.params.items()
        if kinds.get(name) not in ("number", "integer", "path", "text", "numbers")
    }


def controls(panels, where):
    """How many controls are reached by the Tab key; each of them has words."""
    count = 0
    for widget in panels.findChildren(QWidget):
        if widget.isVisible() and widget.focusPolicy() & Qt.FocusPolicy.TabFocus:
            told = widget.accessibleName() or getattr(widget, "text", str)()
            assert told or widget.objectName().startswith("qt_"), (where, widget.objectName())
            count += 1
    return count
