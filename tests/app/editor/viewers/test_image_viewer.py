"""The viewer of a wire's picture, with a real worker behind it."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QImage

from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.picture.picture_facts import grey_levels
from core.editing.operations import remove_nodes, rename_node, set_parameter
from viewer_bench import is_freed

NETWORK, FINAL = "first_steps", "back.image"


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(FINAL)


def shown(viewer):
    return viewer.status.title.text()


def told(viewer):
    return viewer.status.more.text()


def test_shows_the_samples_of_the_wire_and_tells_them(bench, viewer):
    truth = bench.value(FINAL)
    assert (viewer.picture.samples == truth).all()
    low, high = viewer.picture.levels
    # The quantiles are of a histogram of fine steps.
    assert (low, high) == pytest.approx(np.quantile(truth, (0.005, 0.995)), rel=0.01)
    grey = grey_levels(truth, low, high)
    assert (viewer.canvas.first.image == grey).all()
    rows, columns = truth.shape
    assert f"{columns} × {rows}" in shown(viewer)
    assert "W/m²/sr" in shown(viewer)
    assert viewer.bar.ports.port == FINAL
    # It is drawn as indexed grey and the right way up.
    viewer.canvas.grab()
    drawn = viewer.canvas.first.qimage
    assert drawn.format() in (QImage.Format.Format_Grayscale8, QImage.Format.Format_Indexed8)
    for row, column in ((0, 0), (0, columns - 1), (rows - 1, 0), (rows // 3, columns // 4)):
        assert drawn.pixelColor(column, row).red() == grey[row, column]
    top = viewer.canvas.view.mapViewToScene(QPointF(5, 0)).y()
    assert top < viewer.canvas.view.mapViewToScene(QPointF(5, rows - 1)).y()
    # The probe tells the sample.
    place = viewer.canvas.view.mapViewToScene(QPointF(17.2, 5.3))
    viewer.canvas.scene().sigMouseMoved.emit(place)
    assert "row 5  column 17:" in told(viewer)
    assert f"{float(truth[5, 17]):.6g} W/m²/sr" in told(viewer)
    viewer.canvas.scene().sigMouseMoved.emit(QPointF(-50, -50))
    assert told(viewer) == ""


def test_zoom_by_keys_alone_and_linked(bench, viewer, qtbot):
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
    # Linked viewers show the same part.
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


def test_follows_errors_names_and_removals(bench, viewer):
    before = viewer.picture
    bench.do(set_parameter("scene", "width", -1))
    assert viewer.picture is before  # the last one, faint
    assert viewer.canvas.first.opacity() < 1
    assert "scene" in shown(viewer)
    assert "\n" not in shown(viewer)
    bench.session.undo()
    bench.do(rename_node("back", "inverse & last"))
    assert viewer.canvas.first.opacity() == 1
    assert "W/m²/sr" in shown(viewer)
    assert viewer.choices.port == "inverse & last.image"
    assert viewer.bar.ports.currentText() == "inverse & last.image"
    assert (viewer.picture.samples == bench.value("inverse & last.image")).all()
    # Of a removed node the nearest picture is shown until it is back.
    bench.do(remove_nodes(("inverse & last",)))
    assert viewer.choices.port == viewer.bar.ports.port == "scene.image"
    assert (viewer.picture.samples == bench.value("scene.image")).all()
    bench.do(remove_nodes(("scene",)))
    assert viewer.picture is None
    assert not viewer.choices.port
    assert viewer.bar.ports.port == ""
    for _ in range(3):
        bench.session.undo()
    bench.settle()
    assert viewer.choices.port == FINAL
    assert viewer.picture is not None


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
