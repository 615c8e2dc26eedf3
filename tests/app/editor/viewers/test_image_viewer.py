"""The viewer of a wire's picture, with a real worker behind it."""

import numpy as np
import pyqtgraph as pg
import pytest
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QImage

from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.picture.picture_bar import LevelsBar
from app.editor.viewers.picture.picture_facts import BINS, Spread, colour_table, grey_levels
from app.editor.viewers.picture.plots_below import LineMeans, ProfileLine
from core.editing.operations import remove_nodes, rename_node, set_parameter
from nodes.files.formats import read_pixels
from viewer_bench import is_freed
from window_hands import turn

NETWORK, FINAL = "first_steps", "back.image"


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(FINAL)


def shown(viewer):
    return viewer.status.title.text()


def told(viewer):
    return viewer.status.more.text()


def compare_with(viewer, port):
    viewer.bar.menus[1].aboutToShow.emit()
    next(one for one in viewer.bar.others.actions() if one.data() == port).trigger()


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
        viewer.bar.profile.setChecked(True)
        compare_with(viewer, "scene.image")
        bench.settle()
        return viewer

    assert is_freed(used)


def test_levels_are_dragged_on_the_histogram_of_the_samples(bench, viewer, qtbot):
    samples = viewer.picture.samples.astype(float)
    counts, _ = np.histogram(samples, 256)
    _, drawn = viewer.canvas.levels.plot.getData()
    assert drawn.max() == 1.0  # of the logarithm of the largest count
    shown = np.expm1(drawn * np.log1p(counts.max()))
    assert np.abs(shown - counts).sum() <= 0.02 * counts.sum()
    low, high = np.quantile(samples, 0.1), np.quantile(samples, 0.9)
    viewer.canvas.levels.region.setRegion((low, high))
    bench.settle()
    assert viewer.picture.levels == pytest.approx((low, high), rel=1e-9)
    assert (viewer.canvas.first.image == grey_levels(samples, low, high)).mean() > 0.999
    viewer.bar.levels.chosen.emit("extremes")
    bench.settle()
    assert viewer.picture.levels == (samples.min(), samples.max())
    wanted = pytest.approx((samples.min(), samples.max()))
    qtbot.waitUntil(lambda: viewer.canvas.levels.getLevels() == wanted)


def test_a_pixel_that_is_wide_enough_has_its_value_written_on_it(viewer, qtbot):
    canvas, facts = viewer.canvas, viewer.picture.facts
    row, column = facts.rows // 2, facts.columns // 2

    def shown():
        return canvas.first.sceneTransform().mapRect(QRectF(column, row, 1, 1))

    def written():
        image = canvas.grab().toImage()
        ratio, inner = image.width() / canvas.width(), shown().adjusted(2, 2, -2, -2)
        shades = {
            image.pixel(round(x * ratio), round(y * ratio))
            for x in np.arange(inner.left(), inner.right())
            for y in np.arange(inner.top(), inner.bottom())
        }
        return len(shades) > 3

    seen = {}
    while shown().width() < 40:  # the wheel over the pixel zooms to it
        seen[shown().width()] = written()
        turn(canvas.viewport(), shown().center())
        qtbot.wait(30)
    assert len(seen) > 3
    assert not any(seen.values())
    assert written()


def test_wipe(bench, viewer):
    compare_with(viewer, "blur.mtf")
    bench.settle()
    canvas, picture = viewer.canvas, viewer.picture
    assert canvas.second.isVisible()
    assert (picture.other.samples == np.fft.fftshift(bench.value("blur.mtf"))).all()
    canvas.set_split(0.25)
    drawn = canvas.grab().toImage()
    rows, columns = picture.grey.shape
    for share, left in ((0.2, True), (0.3, False)):
        row, column = int(0.6 * rows), int(share * columns)
        around = slice(row - 2, row + 3), slice(column - 2, column + 3)
        here, there = picture.grey[around], picture.other.grey[around]
        assert here.min() > there.max() + 20  # which of the two it is can be told
        place = canvas.view.mapViewToScene(QPointF(column, row))
        dot = canvas.mapFromScene(place) * drawn.devicePixelRatio()
        found = drawn.pixelColor(dot).red()
        wanted = here if left else there
        assert wanted.min() <= found <= wanted.max()
    viewer.bar.mode.chosen.emit("alone")
    bench.settle()
    assert not canvas.second.isVisible()


def test_profile_means_and_spectrum(bench, viewer):
    viewer.bar.profile.setChecked(True)
    profile = viewer.canvas.below[ProfileLine]
    for handle, x in zip(profile.line.getHandles(), (0.25, 0.75), strict=True):
        profile.line.movePoint(handle, (x, 0.5), coords="parent")
    rows, columns = viewer.picture.samples.shape
    distance, value = profile.curves[0].getData()
    assert distance[-1] == pytest.approx(columns / 2)
    samples = viewer.picture.samples.astype(float)
    above, below = samples[rows // 2 - 1], samples[rows // 2]
    middle = (above + below) / 2 if rows % 2 == 0 else below
    wanted = np.interp(0.25 * columns - 0.5 + distance, np.arange(columns), middle)
    assert value == pytest.approx(wanted, rel=1e-6)
    viewer.bar.profile.setChecked(False)
    assert not viewer.canvas.shows(ProfileLine)
    # Means of rows and columns, of both pictures.
    viewer.bar.means.setChecked(True)
    compare_with(viewer, "scene.image")
    bench.settle()
    for curves, port in ((slice(0, 2), FINAL), (slice(2, 4), "scene.image")):
        samples = np.asarray(bench.value(port), np.float64)
        rows, columns = (curve.getData() for curve in viewer.canvas.below[LineMeans].curves[curves])
        assert rows[1] == pytest.approx([float(np.mean(row)) for row in samples], rel=1e-6)
        assert columns[1] == pytest.approx([float(np.mean(c)) for c in samples.T], rel=1e-6)
        assert list(columns[0][:2]) == [0.0, 1.0]
    viewer.bar.means.setChecked(False)
    assert not viewer.canvas.shows(LineMeans)
    # The centred spectrum is shown on frequencies.
    viewer.bar.mode.chosen.emit("alone")
    viewer.bar.mapping.chosen.emit("spectrum")
    bench.settle()
    assert viewer.picture.facts.kind == "plane"
    assert "cyc/mrad" in viewer.canvas.plot.getAxis("bottom").labelText
    assert "log" in viewer.status.title.text()
    seen, facts = viewer.canvas.view.viewRect(), viewer.picture.facts
    assert seen.contains(QPointF(facts.across.at(0), facts.along.at(0)))
    assert seen.width() < 20 * facts.across.step * facts.columns


def test_samples_are_written_in_full_and_a_picture_as_it_looks(bench, viewer, tmp_path):
    for suffix in (".npy", ".exr"):
        path = tmp_path / f"out{suffix}"
        viewer.export(path)
        assert (read_pixels(path) == bench.value(FINAL)).all()
    viewer.bar.colours.chosen.emit("viridis")
    viewer.canvas.grab()
    viewer.export(tmp_path / "look.png")
    written = QImage(str(tmp_path / "look.png")).convertToFormat(QImage.Format.Format_RGB888)
    rows, columns = viewer.picture.grey.shape
    assert (written.height(), written.width()) == (rows, columns)
    table = colour_table("viridis")
    assert table.shape == (256, 3)
    wanted = table[viewer.picture.grey]
    for row, column in ((0, 0), (5, 9), (rows - 1, columns - 1)):
        for image in (written, viewer.canvas.first.qimage):
            assert image.pixelColor(column, row).getRgb()[:3] == tuple(wanted[row, column].tolist())


def test_the_axis_of_the_histogram_moves_only_where_it_fits_badly(qtbot):
    bar, counts = LevelsBar(), np.arange(BINS)
    view = pg.GraphicsView()
    qtbot.addWidget(view)
    view.setCentralItem(bar)
    for ends, levels, seen in (
        ((0.0, 10.0), (2.0, 5.0), (-0.6, 10.6)),  # six hundredths beside both ends
        ((0.3, 9.4), (2.0, 5.0), (-0.6, 10.6)),  # more than four fifths: it stays
        ((0.3, 9.1), (2.0, 5.0), (-0.228, 9.628)),
        ((2.0, 6.0), (3.0, 4.0), (1.76, 6.24)),
        ((2.1, 5.9), (-2.0, 4.0), (-2.474, 6.374)),  # the levels are seen too
        ((2.0, 6.0), (3.0, 14.0), (1.28, 14.72)),
        ((5.0, 5.0), (5.0, 5.0), (4.9944, 5.0056)),
    ):
        bar.show_spread(Spread(*ends, counts), levels)
        qtbot.waitUntil(lambda: bar._next is None)
        across, along = bar.vb.viewRange()
        assert across == pytest.approx([-1.02, 0.0])  # bars grow from 0 to the left
        assert along == pytest.approx(seen, abs=1e-6)
        assert bar.getLevels() == pytest.approx(levels)
        places, bars = bar.plot.getData()
        assert bars == pytest.approx(np.log1p(counts) / np.log(BINS))
        if ends[1] > ends[0]:
            assert np.diff(places) == pytest.approx((ends[1] - ends[0]) / BINS)
            assert places.mean() == pytest.approx(sum(ends) / 2)
