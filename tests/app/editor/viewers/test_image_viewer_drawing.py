"""How an image viewer draws, compares and writes a picture."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QImage

from app.editor.viewers.picture.picture_facts import colour_table, grey_levels
from app.editor.viewers.picture.plots_below import LineMeans, ProfileLine
from nodes.files.formats import read_pixels
from window_hands import turn

NETWORK, FINAL = "first_steps", "back.image"


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(FINAL)


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
    viewer.bar.display.levels.chosen.emit("extremes")
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


def test_profile_means_and_spectrum(bench, viewer):
    viewer.bar.display.profile.setChecked(True)
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
    viewer.bar.display.profile.setChecked(False)
    assert not viewer.canvas.shows(ProfileLine)
    # Means of rows and columns, of both pictures.
    viewer.bar.display.means.setChecked(True)
    viewer.bar.compare.other_chosen.emit("scene.image")
    bench.settle()
    for curves, port in ((slice(0, 2), FINAL), (slice(2, 4), "scene.image")):
        samples = np.asarray(bench.value(port), np.float64)
        rows, columns = (curve.getData() for curve in viewer.canvas.below[LineMeans].curves[curves])
        assert rows[1] == pytest.approx([float(np.mean(row)) for row in samples], rel=1e-6)
        assert columns[1] == pytest.approx([float(np.mean(c)) for c in samples.T], rel=1e-6)
        assert list(columns[0][:2]) == [0.0, 1.0]
    viewer.bar.display.means.setChecked(False)
    assert not viewer.canvas.shows(LineMeans)
    # The centred spectrum is shown on frequencies.
    viewer.bar.compare.mode.chosen.emit("alone")
    viewer.bar.display.mapping.chosen.emit("spectrum")
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
        viewer.save_as(path)
        assert (read_pixels(path) == bench.value(FINAL)).all()
    viewer.bar.display.colours.chosen.emit("viridis")
    viewer.canvas.grab()
    viewer.save_as(tmp_path / "look.png")
    written = QImage(str(tmp_path / "look.png")).convertToFormat(QImage.Format.Format_RGB888)
    rows, columns = viewer.picture.grey.shape
    assert (written.height(), written.width()) == (rows, columns)
    table = colour_table("viridis")
    assert table.shape == (256, 3)
    wanted = table[viewer.picture.grey]
    for row, column in ((0, 0), (5, 9), (rows - 1, columns - 1)):
        for image in (written, viewer.canvas.first.qimage):
            assert image.pixelColor(column, row).getRgb()[:3] == tuple(wanted[row, column].tolist())
