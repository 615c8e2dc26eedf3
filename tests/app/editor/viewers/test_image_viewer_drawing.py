"""How an image viewer draws, compares and writes a picture."""

from dataclasses import replace

import numpy as np
import pyqtgraph as pg
import pytest
from PySide6.QtCore import QEvent, QObject, QPointF, QRectF
from PySide6.QtGui import QImage

from app.editor.viewers.pixels.grey_levels import NAMES, Spread, colour_table, grey_levels
from app.editor.viewers.pixels.picture_query import Picture
from core.editing.operations import set_parameter
from core.errors import ImagechainError
from nodes.files.read import read_pixels

NETWORK, FINAL = "first_steps", "back.image"


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(FINAL)


def shown(viewer):
    return viewer.status.title.text()


def test_levels_are_dragged_on_the_histogram(bench, viewer, qtbot):
    samples = viewer.picture.samples.astype(float)
    low, high = np.quantile(samples, 0.1), np.quantile(samples, 0.9)
    viewer.canvas.levels.region.setRegion((low, high))
    bench.settle()
    assert viewer.picture.levels == pytest.approx((low, high), rel=1e-9)
    assert (viewer.canvas.first.image == grey_levels(samples, low, high)).mean() > 0.999
    viewer.bar.display.levels.chosen.emit("extremes")
    bench.settle()
    assert viewer.picture.levels == (samples.min(), samples.max())
    qtbot.waitUntil(lambda: not viewer.canvas.levels.is_behind)
    assert viewer.canvas.levels.getLevels() == pytest.approx((samples.min(), samples.max()))


@pytest.mark.parametrize("wide", [37.0, 44.0])
def test_a_pixel_that_is_wide_enough_has_its_value_written_on_it(viewer, qtbot, wide):
    canvas, picture = viewer.canvas, viewer.picture
    columns = picture.facts.columns
    canvas.set_zoom((0.5, 0.5, canvas.view.width() / wide / columns))
    qtbot.wait(30)
    to_screen = canvas.first.sceneTransform()
    pixel = to_screen.mapRect(QRectF(columns // 2, picture.facts.rows // 2, 1, 1))
    assert pixel.width() == pytest.approx(wide, rel=0.02)
    image = canvas.grab().toImage()
    ratio = image.width() / canvas.width()
    inner = pixel.adjusted(2, 2, -2, -2)
    shades = {
        image.pixel(round(x * ratio), round(y * ratio))
        for x in np.arange(inner.left(), inner.right())
        for y in np.arange(inner.top(), inner.bottom())
    }
    assert (len(shades) > 3) == (wide > 40)


def test_numbers_on_pixels_are_the_samples_in_few_digits(viewer):
    item, picture = viewer.canvas.first, viewer.picture
    for row, column in ((0, 0), (20, 31)):
        assert float(item.number_at(row, column)) == pytest.approx(
            picture.samples[row, column], rel=6e-3
        )
    large = replace(picture, samples=np.full_like(picture.samples, -123456.0))
    item.show_picture(large, colour_table("grey"), QRectF(0, 0, 1, 1))
    assert item.number_at(0, 0) == "\N{MINUS SIGN}1.23e+05"


def test_the_histogram_is_that_of_the_samples(viewer):
    counts, _ = np.histogram(viewer.picture.samples.astype(float), 256)
    _, drawn = viewer.canvas.levels.plot.getData()
    assert drawn.max() == 1.0  # of the logarithm of the largest count
    shown = np.expm1(drawn * np.log1p(counts.max()))
    assert np.abs(shown - counts).sum() <= 0.02 * counts.sum()


def test_the_histogram_stays_in_view_but_does_not_jitter(viewer, qtbot):
    levels = viewer.canvas.levels
    counts = np.arange(256)

    def seen(low, high):
        levels.show_spread(Spread(low, high, counts), (low, high))
        qtbot.waitUntil(lambda: not levels.is_behind)
        return tuple(levels.vb.viewRange()[1])

    whole = seen(10.0, 20.0)
    assert whole[0] < 10.0
    assert whole[1] > 20.0
    assert seen(10.1, 19.9) == whole
    assert seen(9.9, 20.2) == whole
    higher = seen(9.9, 25.0)
    assert higher[0] < 9.9
    assert higher[1] > 25.0
    narrow = seen(14.0, 15.0)
    assert 13.5 < narrow[0] < 14.0
    assert 15.0 < narrow[1] < 15.5


def test_of_histograms_that_follow_one_another_the_last_is_drawn(viewer, qtbot):
    """Pictures come 40 times a second while a slider is dragged; the histogram less often."""
    levels, drawn = viewer.canvas.levels, []
    qtbot.waitUntil(lambda: not levels.is_behind)
    levels.plot.sigPlotChanged.connect(drawn.append)
    for number in range(1, 31):
        levels.show_spread(Spread(0.0, 30.0, np.eye(1, 256, number - 1, int)[0]), (0.0, 30.0))
    assert len(drawn) <= 2
    qtbot.waitUntil(lambda: not levels.is_behind)
    assert np.argmax(levels.plot.getData()[1]) == 29


def test_a_picture_is_painted_once(bench, viewer, qtbot):
    class Paints(QObject):
        number = 0

        def eventFilter(self, _watched, event):  # noqa: N802
            self.number += event.type() == QEvent.Type.Paint
            return False

    counting = Paints(viewer)
    viewer.canvas.viewport().installEventFilter(counting)
    beyond = []
    for step in range(12):
        counting.number = 0
        bench.answers.clear()
        bench.do(set_parameter("blur", "sigma_x_mrad", 1.0 + 0.02 * step))
        qtbot.wait(50)
        pictures = sum(isinstance(each.value, Picture) for each in bench.answers)
        # On a slow machine a preview comes first; the two may be painted as one.
        assert counting.number >= 1
        beyond.append(counting.number - pictures)
    # Qt, or what lies above the viewport, may have it painted at any time, but not each time.
    assert sorted(beyond)[len(beyond) // 2] <= 0


@pytest.mark.parametrize("name", NAMES)
def test_colours(viewer, name):
    viewer.bar.display.colours.chosen.emit(name)
    viewer.canvas.grab()
    drawn, table = viewer.canvas.first.qimage, colour_table(name)
    level = viewer.picture.grey[9, 9]
    assert drawn.pixelColor(9, 9).getRgb()[:3] == tuple(table[level].tolist())
    assert table.shape == (256, 3)


def test_inverted_grey_is_the_grey_turned_round():
    assert (colour_table("inverted") == 255 - colour_table("grey")).all()


def test_centred_spectrum_is_shown_on_frequencies(bench, viewer):
    viewer.bar.display.mapping.chosen.emit("spectrum")
    bench.settle()
    assert viewer.picture.facts.kind == "plane"
    assert "cyc/mrad" in viewer.canvas.plot.getAxis("bottom").labelText
    assert "log" in shown(viewer)
    seen, facts = viewer.canvas.view.viewRect(), viewer.picture.facts
    assert seen.contains(QPointF(facts.across.at(0), facts.along.at(0)))
    assert seen.width() < 20 * facts.across.step * facts.columns


def test_wipe(bench, viewer):
    viewer.bar.compare.other_chosen.emit("blur.mtf")
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
    viewer.bar.compare.mode.chosen.emit("alone")
    bench.settle()
    assert not canvas.second.isVisible()


def test_both_sides_of_a_wipe_are_written(bench, viewer, tmp_path):
    viewer.bar.compare.other_chosen.emit("blur.mtf")
    bench.settle()
    viewer.canvas.set_split(0.25)
    viewer.save_as(tmp_path / "both.png")
    written = QImage(str(tmp_path / "both.png"))
    rows, columns = viewer.picture.grey.shape
    for column, picture in ((10, viewer.picture), (columns - 10, viewer.picture.other)):
        assert written.pixelColor(column, rows // 2).red() == picture.grey[rows // 2, column]


def test_the_wipe_is_dragged(bench, viewer):
    viewer.bar.compare.other_chosen.emit("scene.image")
    bench.settle()
    place = viewer.picture.facts.columns * 0.75 - 0.5
    viewer.canvas.wipe.setValue(place)
    assert viewer.canvas.split == pytest.approx(0.75)


def test_difference(bench, viewer):
    viewer.bar.compare.other_chosen.emit("scene.image")
    viewer.bar.compare.mode.chosen.emit("difference")
    bench.settle()
    wanted = bench.value(FINAL) - bench.value("scene.image")
    assert (viewer.picture.samples == wanted).all()
    assert "−" in shown(viewer)


def test_plots_below_a_picture_are_made_when_there_is_something_to_plot(viewer):
    """No profile is wanted, and the picture has no bands."""
    assert not any(isinstance(item, pg.ROI) for item in viewer.canvas.scene().items())
    assert viewer.canvas.spectra._plot is None


def test_line_profile(bench, viewer):
    viewer.bar.display.profile.setChecked(True)
    viewer.canvas.profile.show(True, (0.25, 0.5, 0.75, 0.5))
    rows, columns = viewer.picture.samples.shape
    distance, value = viewer.canvas.profile._curve.getData()
    assert distance[-1] == pytest.approx(columns / 2)
    samples = viewer.picture.samples.astype(float)
    above, below = samples[rows // 2 - 1], samples[rows // 2]
    middle = (above + below) / 2 if rows % 2 == 0 else below
    wanted = np.interp(0.25 * columns - 0.5 + distance, np.arange(columns), middle)
    assert value == pytest.approx(wanted, rel=1e-6)
    viewer.bar.display.profile.setChecked(False)
    assert not viewer.canvas.profile.shown


def test_means_of_rows_and_columns_of_both_pictures(bench, viewer):
    viewer.bar.display.means.setChecked(True)
    viewer.bar.compare.other_chosen.emit("scene.image")
    bench.settle()
    for curves, port in ((slice(0, 2), FINAL), (slice(2, 4), "scene.image")):
        samples = np.asarray(bench.value(port), np.float64)
        rows, columns = (curve.getData() for curve in viewer.canvas.means.curves[curves])
        assert rows[1] == pytest.approx([float(np.mean(row)) for row in samples], rel=1e-6)
        assert columns[1] == pytest.approx([float(np.mean(c)) for c in samples.T], rel=1e-6)
        assert list(columns[0][:2]) == [0.0, 1.0]
    viewer.bar.display.means.setChecked(False)
    assert not viewer.canvas.means.shown


@pytest.mark.parametrize("suffix", [".npy", ".tif", ".exr"])
def test_samples_are_written(bench, viewer, tmp_path, suffix):
    path = tmp_path / f"out{suffix}"
    viewer.save_as(path)
    assert (read_pixels(path) == bench.value(FINAL)).all()


def test_planes_are_written_in_the_order_of_the_transform(bench, viewer, tmp_path):
    viewer.look_at("init.magnitude")
    bench.settle()
    viewer.save_as(tmp_path / "plane.npy")
    assert (np.load(tmp_path / "plane.npy") == bench.value("init.magnitude")).all()


def test_a_picture_is_written_as_it_looks(viewer, tmp_path):
    viewer.bar.display.colours.chosen.emit("viridis")
    viewer.save_as(tmp_path / "look.png")
    written = QImage(str(tmp_path / "look.png")).convertToFormat(QImage.Format.Format_RGB888)
    rows, columns = viewer.picture.grey.shape
    assert (written.height(), written.width()) == (rows, columns)
    wanted = colour_table("viridis")[viewer.picture.grey]
    for row, column in ((0, 0), (5, 9), (rows - 1, columns - 1)):
        assert written.pixelColor(column, row).getRgb()[:3] == tuple(wanted[row, column].tolist())


def test_what_cannot_be_written_is_told(viewer, tmp_path):
    with pytest.raises(ImagechainError, match=r"\.jpg.*\.png"):
        viewer.save_as(tmp_path / "x.jpg")
    with pytest.raises(ImagechainError, match="cannot write"):
        viewer.save_as(tmp_path / "nowhere" / "x.npy")


def test_the_axes_end_with_the_picture(bench, viewer):
    """The view beside a square picture is wider than it; ticks beyond it would measure nothing."""
    canvas = viewer.canvas
    for axis, samples in ((canvas.axes["bottom"], 512), (canvas.axes["left"], 512)):
        first, last = sorted(axis.range)
        ticks = [value for _, values in axis.tickValues(first, last, 800.0) for value in values]
        assert min(ticks) >= 0
        assert max(ticks) <= samples
    low, high = sorted(canvas.axes["bottom"].range)
    assert low < 0
    assert high > 512
