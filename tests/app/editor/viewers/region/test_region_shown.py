"""On which pictures the region of a module is framed, where, and how it is seen."""

from core.editing.operations import add_nodes, set_parameter
from core.network.network import Link, Node
from region_hands import framed, stored

NETWORK, INPUT = "measured_mtf", "electronics.image"
AS_SHIPPED = (96, 32, 64, 192)  # of a picture of 256 × 256


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
        (INPUT, True),
    ):
        viewer.look_at(port)
        bench.settle()
        assert (framed(viewer) is not None) == seen, port
    bench.session.select(["blur"])
    assert framed(viewer) is None
    bench.session.select(["measured"])
    viewer.bar.display.mapping.chosen.emit("spectrum")
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
