"""Wires drawn, moved, refused and taken away with the mouse."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QToolTip

from core.editing.document import Document
from core.network.network import Link, Network, Node

ALT_SHIFT = Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def pair(session, canvas, library):
    """A scene, its transform and two blurs, not wired."""
    nodes = {
        "scene": Node("scene", "test_scene"),
        "init": Node("init", "init_trans"),
        "one": Node("one", "jitter_mtf"),
        "two": Node("two", "detector_mtf"),
    }
    layout = {"scene": (0, 0), "init": (240, 0), "one": (480, 0), "two": (480, 160)}
    session.open(Document(Network(nodes=nodes, layout=layout), library=library))
    return session


@pytest.fixture
def told(session):
    found = []
    session.message.connect(lambda kind, text: found.append((kind, text)))
    return found


def link(start, end):
    return Link.between(start, end)


def history(session):
    return session.document.position


def draw(hand, start, end):
    """Draw a wire from a port to another one or, by its name alone, to a node's body."""
    hand.drag(hand.port(*start), hand.port(*end) if isinstance(end, tuple) else hand.head(end))


def test_a_wire_is_drawn_either_way_or_to_the_port_that_fits_or_refused_with_the_reason(
    pair, hand, told
):
    scene, taken = ("scene", "image", "output"), ("one", "magnitude", "input")
    for start, end, made in (
        (scene, ("init", "image", "input"), "scene.image → init.image"),
        (taken, ("init", "magnitude", "output"), "init.magnitude → one.magnitude"),
        (("init", "magnitude", "output"), "one", "init.magnitude → one.magnitude"),
    ):
        draw(hand, start, end)
        assert [str(each) for each in pair.network.links] == [made]
        assert history(pair) == 1
        pair.undo()
    before = pair.network
    for start, end, reason in (
        (scene, taken, "scene.image gives image, but one.magnitude takes magnitude"),
        (
            ("one", "magnitude", "output"),
            ("init", "magnitude", "output"),
            "a wire connects an output to an input; magnitude is another output",
        ),
        (scene, "two", "two has no input for image"),
    ):
        del told[:]
        draw(hand, start, end)
        assert pair.network is before
        assert told == [("error", reason)]


def test_the_reason_is_shown_while_the_wire_hovers(pair, canvas, hand, qtbot):
    start, end = hand.port("scene", "image", "output"), hand.port("one", "magnitude", "input")
    hand.press(start)
    hand.move(start, end)
    assert QToolTip.isVisible()
    assert "one.magnitude takes magnitude" in QToolTip.text()
    assert canvas.view.viewport().cursor().shape() == Qt.CursorShape.ForbiddenCursor
    assert canvas.content.nodes["init"].ports["input", "image"].fits is True
    assert canvas.content.nodes["one"].ports["input", "magnitude"].fits is False
    hand.release(end)
    qtbot.waitUntil(lambda: not QToolTip.isVisible())
    assert canvas.view.viewport().cursor().shape() == Qt.CursorShape.ArrowCursor
    assert canvas.content.nodes["init"].ports["input", "image"].fits is None
    # Escape gives a wire up.
    end = hand.port("init", "image", "input")
    hand.press(start)
    hand.move(start, end)
    hand.key(Qt.Key.Key_Escape)
    hand.release(end)
    assert not pair.network.links
    assert not canvas.popup.is_open


def test_a_new_wire_takes_the_place_of_the_old_in_one_step_and_a_cycle_is_refused(pair, hand, told):
    hand.drag(hand.port("init", "magnitude", "output"), hand.port("two", "magnitude", "input"))
    hand.drag(hand.port("one", "magnitude", "output"), hand.port("two", "magnitude", "input"))
    hand.drag(hand.port("two", "magnitude", "output"), hand.port("one", "magnitude", "input"))
    assert pair.network.links == (link("one.magnitude", "two.magnitude"),)
    assert "cycle" in told[0][1]
    pair.undo()
    assert pair.network.links == (link("init.magnitude", "two.magnitude"),)


def wired(session, hand):
    hand.drag(hand.port("init", "magnitude", "output"), hand.port("one", "magnitude", "input"))
    return session.network


def test_a_picked_up_wire_is_put_elsewhere_let_go_or_led_to_a_new_node(pair, canvas, hand):
    wired(pair, hand)
    start, made = hand.port("one", "magnitude", "input"), (link("init.magnitude", "one.magnitude"),)
    hand.drag(start, hand.port("two", "magnitude", "input"))
    assert pair.network.links == (link("init.magnitude", "two.magnitude"),)
    pair.undo()
    assert pair.network.links == made
    hand.drag(start, hand.at(300, 330))
    assert canvas.popup.is_open
    assert pair.network.links
    hand.key(Qt.Key.Key_Escape)
    assert not canvas.popup.is_open
    assert not pair.network.links
    pair.undo()
    assert pair.network.links == made
    assert canvas.content.wires[made[0]].isVisible()
    steps = history(pair)
    hand.drag(start, hand.at(300, 330))
    hand.type("vibration")
    hand.key(Qt.Key.Key_Return)
    links = pair.network.links
    assert link("init.magnitude", "vibration_mtf.magnitude") in links
    assert made[0] not in links
    assert history(pair) == steps + 1
    pair.undo()
    assert pair.network.links == made


def test_a_wire_on_empty_ground_lists_what_fits_and_wires_the_chosen(pair, canvas, hand, library):
    hand.drag(hand.port("init", "magnitude", "output"), hand.at(300, 330))
    assert canvas.popup.is_open
    titles = [canvas.popup.list.item(row).text() for row in range(canvas.popup.list.count())]
    assert "Jitter MTF" in titles
    assert "Back Transform" in titles
    assert "Test Scene" not in titles
    assert "Combine Pixels" not in titles
    hand.type("jitter")
    hand.key(Qt.Key.Key_Return)
    assert link("init.magnitude", "jitter_mtf.magnitude") in pair.network.links
    assert link("init.context", "jitter_mtf.context") in pair.network.links
    assert pair.selection == ("jitter_mtf",)
    assert history(pair) == 1
    # The port it was drawn to is where the wire ended.
    port = canvas.content.nodes["jitter_mtf"].ports["input", "magnitude"]
    assert (port.centre() - canvas.view.mapToScene(hand.at(300, 330))).manhattanLength() < 3


def test_a_wire_of_a_picture_reaches_a_module_of_spectra_by_the_transform(pair, canvas, hand):
    for steps, new in enumerate(("init_trans", "")):
        hand.drag(hand.port("scene", "image", "output"), hand.at(300, 330 + 60 * steps))
        assert "Gaussian MTF" not in [canvas.popup.list.item(row).text() for row in range(9)]
        hand.type("gauss")
        (item,) = (canvas.popup.list.item(row) for row in range(canvas.popup.list.count()))
        assert (item.text(), item.toolTip().splitlines()[0]) == (
            "Gaussian MTF",
            "The module's input is of type magnitude: Init & Trans is inserted first.",
        )
        hand.key(Qt.Key.Key_Return)
        name = f"gaussian_mtf{'_2' * steps}"
        assert pair.selection == (name,)
        assert history(pair) == steps + 1
        assert {one for one in pair.network.links if one.target in (name, new)} == {
            *([link("scene.image", "init_trans.image")] if new else []),
            link("init_trans.magnitude", f"{name}.magnitude"),
            link("init_trans.context", f"{name}.context"),
        }
    assert len(pair.network.nodes) == 4 + 3
    pair.undo()
    # So it is by a search with the picture's node selected; then in the chain there is.
    hand.click(hand.head("scene"))
    hand.key(Qt.Key.Key_Tab)
    hand.type("charge diffusion")
    hand.key(Qt.Key.Key_Return)
    assert link("init_trans.magnitude", "charge_diffusion_mtf.magnitude") in pair.network.links
    assert link("charge_diffusion_mtf.magnitude", "gaussian_mtf.magnitude") in pair.network.links


def test_a_new_node_is_seen_whole_at_the_zoom_there_is(pair, canvas, hand):
    zoom, corner = canvas.view.zoom, canvas.view.viewport().rect().bottomRight()
    hand.drag(hand.port("scene", "image", "output"), corner - QPoint(8, 8))
    hand.type("combine")
    hand.key(Qt.Key.Key_Return)
    assert canvas.view.zoom == zoom
    assert canvas.view.visible_rect().contains(canvas.content.nodes["combine_pixels"].frame())


def test_a_cut_takes_every_wire_it_crosses_in_one_step(pair, hand):
    wired(pair, hand)
    hand.drag(hand.port("init", "context", "output"), hand.port("one", "context", "input"))
    assert len(pair.network.links) == 2
    steps = history(pair)
    hand.drag(hand.at(444, -60), hand.at(444, 200), keys=ALT_SHIFT)
    assert not pair.network.links
    assert history(pair) == steps + 1
    pair.undo()
    assert len(pair.network.links) == 2
