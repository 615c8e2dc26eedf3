"""On which pictures the region of a module is framed, where, and how it is seen."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt

from app.editor.theme import DARK, LIGHT
from app.editor.viewers.pixels.picture_facts import picture_facts
from core.editing.operations import Add, Placed, Remove, set_node_field, set_parameter
from core.network.network import Link, Node
from region_hands import framed, stored

NETWORK, INPUT = "measured_mtf", "electronics.image"
KEY = Qt.Key
AS_SHIPPED = (96, 32, 64, 192)  # of a picture of 256 × 256


def test_the_region_of_the_selected_node_is_framed(bench, viewer):
    assert framed(viewer) is None
    assert viewer.canvas.accessibleDescription() == ""
    bench.session.select(["measured"])
    assert framed(viewer) == AS_SHIPPED
    assert "64 × 192 at column 96, row 32" in viewer.canvas.accessibleDescription()
    bench.session.select(["blur"])
    assert framed(viewer) is None


def test_the_region_of_a_pinned_panel_is_framed(bench, viewer):
    bench.do(set_node_field("measured", "pinned", True))
    assert framed(viewer) == AS_SHIPPED


def test_it_is_framed_on_pictures_of_the_same_size_before_it_alone(bench, viewer):
    half = Placed(Node("half", "combine_pixels", {"factor_x": 2, "factor_y": 2}))
    bench.do(Add((half,), (Link("back", "image", "half", "image"),)))
    bench.session.select(["measured"])
    for port, seen in (
        (INPUT, True),
        ("back.image", True),
        ("scene.image", True),
        ("half.image", False),  # of another size
        ("electronics.noise", True),
        ("detector.magnitude", False),  # no picture
    ):
        viewer.look_at(port)
        bench.settle()
        assert (framed(viewer) is not None) == seen, port
    viewer.look_at(INPUT)
    viewer.bar.display.mapping.chosen.emit("spectrum")
    bench.settle()
    assert framed(viewer) is None


def test_it_is_not_framed_on_a_picture_of_another_size_before_it(bench, viewer):
    half = Placed(Node("half", "combine_pixels", {"factor_x": 2, "factor_y": 2}))
    links = (Link("electronics", "image", "half", "image"), Link("half", "image", "own", "image"))
    bench.do(Add((half, Placed(Node("own", "measured_mtf", {"region_x": 3}))), links))
    bench.session.select(["own"])
    assert framed(viewer) is None
    viewer.look_at("half.image")
    bench.settle()
    assert framed(viewer) == (3, 0, 125, 128)


def test_typed_values_move_the_frame(bench, viewer, hand):
    bench.do(set_parameter("measured", "region_x", 7))
    assert framed(viewer) == (7, 32, 64, 192)
    bench.do(set_parameter("measured", "region_width", 0))  # to the picture's end
    assert framed(viewer) == (7, 32, 249, 192)


def test_one_beyond_the_picture_can_be_brought_back(bench, viewer, hand):
    bench.do(set_parameter("measured", "region_x", 240))
    overlay = viewer.canvas.region
    assert framed(viewer) == (240, 32, 16, 192)
    assert "beyond" in overlay.title.toPlainText()
    hand.drag((250, 128), (200, 128))
    assert stored(bench) == (190, 32, 16, 192)
    assert "beyond" not in overlay.title.toPlainText()


def test_without_such_a_module_there_is_nothing_to_draw(bench, viewer, hand):
    told = []
    bench.session.message.connect(lambda kind, text: told.append((kind, text)))
    bench.do(Remove(("measured",)))
    assert framed(viewer) is None
    assert not viewer.bar.region.isEnabled()
    viewer.canvas.setFocus()
    hand.key(KEY.Key_R)
    assert told == [("note", "no module of this network has a region to draw")]


def test_on_a_smaller_preview_the_frame_is_where_it_was(bench, viewer, hand):
    """A preview has a quarter of the samples across and along; the frame counts those of before."""
    full = viewer.picture
    small = full.samples.reshape(64, 4, 64, 4).mean(axis=(1, 3))
    value = replace(full.value, rows=64, columns=64)
    facts = picture_facts(value, 4)
    preview = replace(full, facts=facts, samples=small, grey=full.grey[::4, ::4].copy(), reduced=4)
    viewer.canvas.show_picture(preview)
    viewer.region.show_picture(preview, INPUT)
    assert framed(viewer) == AS_SHIPPED
    hand.drag((128, 128), (133, 129))
    assert stored(bench) == (101, 33, 64, 192)


@pytest.mark.parametrize("theme", [DARK, LIGHT])
@pytest.mark.parametrize("picture", ["bright", "dark"])
def test_the_frame_can_be_told_from_the_picture(bench, viewer, hand, theme, picture):
    viewer.setPalette(theme.palette())
    levels = (1e6, 2e6) if picture == "dark" else (-2.0, -1.0)
    viewer._choose(levels=levels)
    bench.settle()
    drawn = viewer.canvas.grab().toImage()
    ratio = drawn.devicePixelRatio()
    row = hand.at(96, 200)
    across = [drawn.pixelColor((row + QPoint(dx, 0)) * ratio) for dx in range(-8, 9)]
    luminance = [_luminance(colour) for colour in across]
    ground = 0.0 if picture == "dark" else 1.0
    assert abs(luminance[0] - ground) < 0.01
    contrast = max((max(each, ground) + 0.05) / (min(each, ground) + 0.05) for each in luminance)
    assert contrast >= 3.0  # what is asked of parts of a window that matter


def _luminance(colour):
    """Relative luminance of sRGB, as WCAG 2 has it."""
    parts = (colour.redF(), colour.greenF(), colour.blueF())
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
