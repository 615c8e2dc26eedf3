"""The viewer of a wire's picture, with a real worker behind it."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QWidget

from app.editor.theme import DARK, LIGHT
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.pixels.grey_levels import grey_levels
from core.editing.operations import Remove, Rename, Rewire, set_parameter
from core.errors import ImagechainError
from viewer_bench import ViewerBench, is_freed

NETWORK, FINAL = "first_steps", "back.image"


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(FINAL)


def shown(viewer):
    return viewer.status.title.text()


def told(viewer):
    return viewer.status.more.text()


def test_without_an_evaluator_nothing_is_shown(qtbot, session):
    viewer = ImageViewer(session, None, 3)
    qtbot.addWidget(viewer)
    viewer.show()
    viewer.look_at("scene.image")
    assert viewer.picture is None
    with pytest.raises(ImagechainError, match="no picture"):
        viewer.save_as("x.png")


def test_shows_the_samples_of_the_wire(bench, viewer):
    truth = bench.value(FINAL)
    assert (viewer.picture.samples == truth).all()
    low, high = viewer.picture.levels
    # The quantiles are of a histogram of fine steps.
    assert (low, high) == pytest.approx(np.quantile(truth, (0.005, 0.995)), rel=0.01)
    assert (viewer.canvas.first.image == grey_levels(truth, low, high)).all()
    rows, columns = truth.shape
    assert f"{columns} × {rows}" in shown(viewer)
    assert "W/m²/sr" in shown(viewer)
    assert viewer.bar.ports.port == FINAL


def test_the_drawn_picture_is_indexed_grey_and_the_right_way_up(bench, viewer):
    viewer.canvas.grab()
    drawn = viewer.canvas.first.qimage
    truth = viewer.picture.grey
    assert drawn.format() in (QImage.Format.Format_Grayscale8, QImage.Format.Format_Indexed8)
    rows, columns = truth.shape
    for row, column in ((0, 0), (0, columns - 1), (rows - 1, 0), (rows // 3, columns // 4)):
        assert drawn.pixelColor(column, row).red() == truth[row, column]
    top = viewer.canvas.view.mapViewToScene(QPointF(5, 0)).y()
    assert top < viewer.canvas.view.mapViewToScene(QPointF(5, rows - 1)).y()


def test_asks_only_while_visible(bench, viewer):
    viewer.hide()
    bench.settle()
    del bench.answers[:]
    bench.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    assert not bench.answers
    viewer.show()
    bench.settle()
    assert (viewer.picture.samples == bench.value(FINAL)).all()


def test_the_probe_tells_the_sample(bench, viewer):
    truth = bench.value(FINAL)
    place = viewer.canvas.view.mapViewToScene(QPointF(17.2, 5.3))
    viewer.canvas.scene().sigMouseMoved.emit(place)
    assert "row 5  column 17:" in told(viewer)
    assert f"{float(truth[5, 17]):.6g} W/m²/sr" in told(viewer)
    viewer.canvas.scene().sigMouseMoved.emit(QPointF(-50, -50))
    assert told(viewer) == ""


def test_arrow_keys_move_the_probe(bench, viewer, qtbot):
    viewer.canvas.setFocus()
    rows, columns = viewer.picture.samples.shape
    for key in (Qt.Key.Key_Right, Qt.Key.Key_Down, Qt.Key.Key_Down):
        qtbot.keyClick(viewer.canvas, key)
    assert f"row {rows // 2 + 2}  column {columns // 2 + 1}:" in told(viewer)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert f"column {columns // 2 - 9}:" in told(viewer)


def test_zoom_by_keys(viewer, qtbot):
    view = viewer.canvas.view
    columns = viewer.picture.facts.columns
    whole = view.viewRect()
    assert whole.width() >= columns * 0.999
    assert viewer.canvas.zoom is None
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_Plus)
    assert view.viewRect().width() == pytest.approx(whole.width() / 1.25)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_1)
    dots = view.width() * viewer.devicePixelRatioF()
    assert view.viewRect().width() == pytest.approx(dots, rel=1e-6)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_0)
    assert view.viewRect().width() == pytest.approx(whole.width())


def test_what_is_zoomed_stays_while_the_picture_changes(bench, viewer):
    viewer.canvas.set_zoom((0.25, 0.5, 0.2))
    seen = viewer.canvas.view.viewRect()
    bench.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    assert viewer.canvas.view.viewRect() == seen


def test_the_part_seen_is_a_share_of_both_sides(qtbot, opened):
    """Of a picture 120 wide and 48 high: its middle a quarter across and three quarters down."""
    session = opened("first_steps")
    assert session.do(set_parameter("scene", "width", 120))
    assert session.do(set_parameter("scene", "height", 48))
    bench = ViewerBench(qtbot, session)
    viewer = ImageViewer(session, bench.evaluator, 1)
    viewer.look_at("scene.image")
    bench.show(viewer)
    try:
        place = viewer.canvas.first.mapRectToParent(viewer.canvas.first.boundingRect())
        assert (place.width(), place.height()) == pytest.approx((120, 48))
        viewer.canvas.set_zoom((0.25, 0.75, 0.2))
        seen = viewer.canvas.view.viewRect()
        assert seen.width() == pytest.approx(24, rel=1e-6)
        middle = seen.center() - place.topLeft()
        assert (middle.x(), middle.y()) == pytest.approx((30, 36), rel=1e-6)
        assert viewer.canvas.zoom == pytest.approx((0.25, 0.75, 0.2), rel=1e-6)
    finally:
        bench.close()


def test_linked_viewers_show_the_same_part(bench, viewer, qtbot):
    other = ImageViewer(bench.session, bench.evaluator, 2)
    other.look_at("scene.image")
    bench.show(other, 400, 300)
    viewer.link_to(other)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_1)
    assert other.canvas.zoom == pytest.approx(viewer.canvas.zoom, rel=1e-6)
    qtbot.keyClick(other.canvas, Qt.Key.Key_Minus)
    assert viewer.canvas.zoom == pytest.approx(other.canvas.zoom, rel=1e-6)
    viewer.link_to(other, False)
    before = viewer.canvas.zoom
    qtbot.keyClick(other.canvas, Qt.Key.Key_Plus)
    assert viewer.canvas.zoom == before


def test_the_menu_offers_the_other_viewers(bench, qtbot):
    window = QWidget()
    qtbot.addWidget(window)
    one, two = (ImageViewer(bench.session, bench.evaluator, n, window) for n in (1, 2))
    one.bar.opening.emit()
    (action,) = one.bar.compare.links.actions()
    assert "2" in action.text()
    action.trigger()
    assert one.links.has(two.links)
    assert two.links.has(one.links)


def test_an_error_keeps_the_last_picture_faint(bench, viewer):
    before = viewer.picture
    bench.do(set_parameter("scene", "width", -1))
    assert viewer.picture is before
    assert viewer.canvas.first.opacity() < 1
    assert "scene" in shown(viewer)
    assert "width" in shown(viewer)
    assert "\n" not in shown(viewer)
    bench.session.undo()
    bench.settle()
    assert viewer.canvas.first.opacity() == 1
    assert "W/m²/sr" in shown(viewer)


def test_follows_a_renamed_node(bench, viewer):
    bench.do(Rename("back", "inverse & last"))
    assert viewer.choices.port == "inverse & last.image"
    assert viewer.bar.ports.currentText() == "inverse & last.image"
    assert (viewer.picture.samples == bench.value("inverse & last.image")).all()


def test_of_a_removed_node_the_nearest_picture_is_shown_until_it_is_back(bench, viewer):
    bench.do(Remove(("back",)))
    assert viewer.choices.port == viewer.bar.ports.port == "scene.image"
    assert (viewer.picture.samples == bench.value("scene.image")).all()
    bench.do(Remove(("scene",)))
    assert viewer.picture is None
    assert viewer.choices.port is None
    assert viewer.bar.ports.port == ""
    bench.session.undo()
    bench.session.undo()
    bench.settle()
    assert viewer.choices.port == FINAL
    assert viewer.picture is not None


def test_the_reason_for_no_picture_stands_where_the_picture_would(bench, viewer, qtbot):
    other = ImageViewer(bench.session, bench.evaluator, 2)
    bench.show(other)
    assert other._hint.isVisible()
    assert other._hint.text().startswith("Choose a wire")
    bench.do(Rewire(remove=(bench.session.network.links_into("init")[0],)))
    other.look_at(FINAL)
    bench.settle()
    assert other._hint.isVisible()
    assert other._hint.text() == shown(other)
    assert "init" in shown(other)
    other.look_at(None)
    assert other._hint.text().startswith("Choose a wire")


def test_a_spectrum_is_drawn_by_its_logarithm_until_linear_is_chosen(bench, viewer, qtbot):
    def choose(mapping):
        menu = viewer.bar.menus[0]
        menu.popup(viewer.mapToGlobal(QPoint(10, 10)))
        (action,) = [one for one in menu.actions() if one.objectName() == mapping]
        qtbot.mouseClick(menu, Qt.MouseButton.LeftButton, pos=menu.actionGeometry(action).center())
        bench.settle()

    assert viewer.picture.mapping == "linear"
    viewer.look_at("init.magnitude")
    bench.settle()
    assert viewer.picture.logarithmic
    assert "log₁₀" in shown(viewer)
    choose("linear")
    assert not viewer.picture.logarithmic
    viewer.look_at("optics.magnitude")
    bench.settle()
    assert not viewer.picture.logarithmic  # as chosen for the spectrum before
    viewer.look_at(FINAL)
    viewer.look_at("init.magnitude")
    viewer.look_at(FINAL)
    bench.settle()
    assert viewer.picture.mapping == "linear"


def test_another_document_is_not_shown_under_the_old_name(bench, viewer, opened):
    opened("pupils")
    bench.settle()
    assert viewer.picture is None
    assert viewer.choices.port is None


def test_the_choice_lists_pictures_by_node(bench, viewer):
    box = viewer.bar.ports
    texts = [box.itemText(row) for row in range(box.count())]
    assert FINAL in texts
    assert "init.magnitude" in texts
    assert "init.context" not in texts
    box.setCurrentIndex(texts.index("scene.image"))
    box.activated.emit(texts.index("scene.image"))
    bench.settle()
    assert (viewer.picture.samples == bench.value("scene.image")).all()


def test_themes(viewer):
    viewer.setPalette(LIGHT.palette())
    light = viewer.grab().toImage()
    viewer.setPalette(DARK.palette())
    dark = viewer.grab().toImage()
    assert light.pixelColor(3, 60).lightness() > 200
    assert dark.pixelColor(3, 60).lightness() < 60


def test_nothing_is_left_of_a_closed_viewer(bench):
    def used():
        viewer = ImageViewer(bench.session, bench.evaluator, 5)
        viewer.look_at(FINAL)
        viewer.show()
        bench.settle()
        viewer.bar.display.profile.setChecked(True)
        viewer.bar.opening.emit()
        viewer.bar.compare.other_chosen.emit("scene.image")
        bench.settle()
        return viewer

    assert is_freed(used)
