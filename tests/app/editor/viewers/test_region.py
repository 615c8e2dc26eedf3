"""The region of a module: on which pictures it is framed, and dragged there with real events."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from app.editor.viewers.plot.plot_viewer import PlotViewer
from core.editing.operations import add_nodes, set_parameter
from core.network.linked_values import expression
from core.network.network import Link, Node
from region_hands import PictureHand, framed, stored, undo_steps

NETWORK = "measured_mtf"
AS_SHIPPED = (96, 32, 64, 192)  # of a picture of 256 × 256


@pytest.fixture
def viewer(image_viewer):
    return image_viewer("electronics.image", 900, 700)


@pytest.fixture
def hand(viewer, bench):
    bench.session.select(["measured"])
    return PictureHand(viewer)


def test_dragging_moves_it_by_whole_samples_in_one_undo_step(bench, viewer, hand):
    hand.drag((128, 128), (118.1, 139.9))
    assert stored(bench) == (86, 44, 64, 192)
    assert framed(viewer) == (86, 44, 64, 192)
    assert undo_steps(bench) == 1
    assert "region" in bench.session.document.undo_text
    bench.session.undo()
    assert framed(viewer) == AS_SHIPPED
    bench.session.redo()
    assert framed(viewer) == (86, 44, 64, 192)


def test_handles_resize_it_and_esc_gives_up_a_drag(bench, viewer, hand):
    for grip, to, wanted in (
        ((160, 128), (180, 20), (96, 32, 84, 192)),
        ((96, 32), (90, 30), (90, 30, 70, 194)),
        ((160, 128), (999, 0), (96, 32, 160, 192)),  # to the edge of the picture
    ):
        hand.drag(grip, to)
        assert stored(bench) == wanted
        assert framed(viewer) == wanted
        assert undo_steps(bench) == 1
        bench.session.undo()
    for start in ((128, 128), (160, 128)):  # of the region and of a handle
        hand.press(start)
        hand.move((170, 120))
        hand.move((150, 118))
        assert stored(bench) != AS_SHIPPED
        QTest.keyClick(viewer.canvas, Qt.Key.Key_Escape)
        hand.move((140, 110))  # what the mouse still does moves nothing
        hand.release((140, 110))
        assert stored(bench) == AS_SHIPPED
        assert framed(viewer) == AS_SHIPPED
        assert undo_steps(bench) == 0


def test_a_key_and_a_button_show_the_region_on_its_picture(bench, viewer):
    for by_key in (True, False):
        viewer.look_at("detector.magnitude")
        bench.settle()
        assert framed(viewer) is None
        if by_key:
            QTest.keyClick(viewer.canvas, Qt.Key.Key_R)
        else:
            QTest.mouseClick(viewer.bar.region, Qt.MouseButton.LeftButton)
        bench.settle()
        assert viewer.choices.port == "electronics.image"
        assert bench.session.selection == ("measured",)
        assert framed(viewer) == AS_SHIPPED


def test_the_curve_follows_while_it_is_dragged(bench, viewer, hand):
    plot = PlotViewer(bench.session, bench.evaluator)
    plot.look_at("measured.curve")
    bench.show(plot)
    before = plot.data.series[0].y
    hand.press((128, 128))
    hand.move((128, 118))
    bench.settle()  # the button is still down
    during = plot.data.series[0].y
    assert not np.array_equal(before, during)
    hand.release((128, 118))
    bench.settle()
    assert stored(bench) == (96, 22, 64, 192)
    assert np.array_equal(plot.data.series[0].y, during)


def test_a_linked_region_is_left_alone_and_the_reason_given(bench, viewer, hand):
    raw = expression("measured.region_height / 3")
    bench.session.do(set_parameter("measured", "region_width", raw))
    before, said = bench.session.network, []
    assert framed(viewer) == AS_SHIPPED  # 192 / 3
    bench.session.message.connect(lambda kind, text: said.append((kind, text)))
    hand.drag((128, 128), (118.1, 139.9))
    assert bench.session.network is before
    assert (
        "error",
        "measured.region_width is linked to measured.region_height / 3: "
        "unlink it in the panel first",
    ) in said


def test_it_is_framed_on_pictures_of_the_same_size_before_the_selected_node(bench, viewer):
    assert framed(viewer) is None
    assert viewer.canvas.accessibleDescription() == ""
    half = (Node("half", "combine_pixels", {"factor_x": 2, "factor_y": 2}), None)
    bench.do(add_nodes((half,), (Link("back", "image", "half", "image"),)))
    bench.session.select(["measured"])
    assert framed(viewer) == AS_SHIPPED
    assert "64 × 192 at column 96, row 32" in viewer.canvas.accessibleDescription()
    for port, seen in (
        ("back.image", True),
        ("scene.image", True),
        ("half.image", False),  # of another size
        ("electronics.noise", True),
        ("detector.magnitude", False),  # no picture
        ("electronics.image", True),
    ):
        viewer.look_at(port)
        bench.settle()
        assert (framed(viewer) is not None) == seen, port
    bench.session.select(["blur"])
    assert framed(viewer) is None
    bench.session.select(["measured"])
    viewer.bar.mapping.chosen.emit("spectrum")
    bench.settle()
    assert framed(viewer) is None


def test_one_beyond_the_picture_can_be_brought_back(bench, viewer, hand):
    bench.do(set_parameter("measured", "region_x", 240))
    title = viewer.region.frame.title
    assert framed(viewer) == (240, 32, 16, 192)
    assert "outside" in title.toPlainText()
    hand.drag((250, 128), (200, 128))
    assert stored(bench) == (190, 32, 16, 192)
    assert "outside" not in title.toPlainText()
