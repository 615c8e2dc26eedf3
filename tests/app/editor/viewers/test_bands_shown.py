"""The viewer of a picture with bands, with a real worker behind it."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest

from app.editor.viewers.picture.plots_below import MEAN, Spectra
from core.editing.document import Document
from core.errors import UsageError
from core.network.file import load_network
from cube_network import BANDS, SIZE, write_cube_network
from viewer_bench import ViewerBench

READ, PLAIN = "read.image", "fpa.image"


@pytest.fixture
def cube(tmp_path, library):
    return write_cube_network(tmp_path, library)


@pytest.fixture
def bench(qtbot, session, library, cube, tmp_path):
    path = tmp_path / "cube.json"
    session.open(Document(load_network(path, library=library), library=library, path=path))
    made = ViewerBench(qtbot, session)
    yield made
    made.close()


@pytest.fixture
def viewer(image_viewer):
    return image_viewer(READ, 640, 480)


def choose(viewer, bench, shown):
    bar = viewer.band_bar
    bar.shown.setCurrentIndex(bar.shown.findData(shown))
    bar.shown.activated.emit(bar.shown.currentIndex())
    bench.settle()


def point_at(viewer, bench, qtbot, row, column):
    place = viewer.canvas.view.mapViewToScene(QPointF(column, row))
    viewer.canvas.scene().sigMouseMoved.emit(place)
    qtbot.wait(80)
    bench.settle()


def names(viewer):
    return [name for name in viewer.canvas.below[Spectra].names if name]


def test_all_bands_at_first_and_no_controls_where_there_are_none(viewer, bench, cube):
    samples, _, width = cube
    bar = viewer.band_bar
    assert bar.isVisible()
    assert bar.shown.currentText() == "All bands: sum"
    assert bar.about.text() == "12 bands, 3 to 5 µm"
    assert not bar.slider.isVisible()
    assert viewer.picture.samples == pytest.approx(samples.sum(axis=0) * width, rel=1e-5)
    choose(viewer, bench, "one")
    viewer.look_at(PLAIN)
    bench.settle()
    assert not viewer.band_bar.isVisible()
    assert not viewer.canvas.shows(Spectra)
    assert not viewer.bar.spectra.isEnabled()
    assert len(viewer.queries()) == 1
    viewer.look_at(READ)
    bench.settle()
    assert viewer.band_bar.isVisible()
    assert viewer.bar.spectra.isEnabled()
    assert viewer.picture.facts.wavelengths_um


def test_one_band_by_slider_wavelength_keys_and_a_dragged_line(viewer, bench, qtbot, cube):
    samples, wavelengths, _ = cube
    choose(viewer, bench, "one")
    bar = viewer.band_bar
    assert bar.slider.value() == bar.one.currentIndex() == BANDS // 2
    assert viewer.picture.samples == pytest.approx(samples[BANDS // 2], rel=1e-6)
    bar.slider.setFocus()
    qtbot.keyClick(bar.slider, Qt.Key.Key_Right)
    bench.settle()
    assert viewer.picture.samples == pytest.approx(samples[BANDS // 2 + 1], rel=1e-6)
    place = int(np.argmin(np.abs(wavelengths - 3.4)))
    QTest.keyClicks(bar.one, f"{wavelengths[place]:.5g}")
    bench.settle()
    assert bar.slider.value() == place
    assert bar.one.currentText() == f"{wavelengths[place]:.5g} µm"
    assert bar.about.text() == f"0.167 µm wide, band {place + 1} of {BANDS}"
    assert viewer.picture.samples == pytest.approx(samples[place], rel=1e-6)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageUp)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageUp)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageDown)
    bench.settle()
    assert viewer.picture.samples == pytest.approx(samples[place + 1], rel=1e-6)
    # A dragged line chooses the band and rests on it.
    line = viewer.canvas.below[Spectra].lines[0]
    assert line.value() == pytest.approx(wavelengths[place + 1])
    line.setValue(3.3)
    line.sigDragged.emit(line)
    bench.settle()
    place = int(np.argmin(np.abs(wavelengths - 3.3)))
    assert viewer.picture.samples == pytest.approx(samples[place], rel=1e-6)
    line.sigPositionChangeFinished.emit(line)
    assert line.value() == pytest.approx(wavelengths[place])


def test_colours_are_chosen_drawn_and_saved(viewer, bench, cube, tmp_path):
    samples, wavelengths, _ = cube
    choose(viewer, bench, "colours")
    bar = viewer.band_bar
    assert [each.currentIndex() for each in bar.colours] == [10, 6, 2]
    assert not bar.even.isEnabled()
    assert viewer.canvas.first.image.shape == (*SIZE, 3)
    bar.colours[1].activated.emit(5)
    bench.settle()
    assert viewer.picture.channels[1].samples == pytest.approx(samples[5], rel=1e-6)
    assert [line.isVisible() for line in viewer.canvas.below[Spectra].lines] == [True] * 3
    assert viewer.canvas.below[Spectra].lines[1].value() == pytest.approx(wavelengths[5])
    bar.even.click()
    bench.settle()
    assert [each.currentIndex() for each in bar.colours] == [10, 6, 2]
    viewer.canvas.grab()
    truth = viewer.picture.grey
    viewer.export(tmp_path / "colours.png")
    for drawn in (viewer.canvas.first.qimage, QImage(str(tmp_path / "colours.png"))):
        for row, column in ((0, 0), (SIZE[0] - 1, SIZE[1] - 1), (5, 17)):
            colour = drawn.pixelColor(column, row)
            assert (colour.red(), colour.green(), colour.blue()) == tuple(truth[row, column])
    with pytest.raises(UsageError, match="three bands shown as colours can only be saved as"):
        viewer.export(tmp_path / "colours.npy")


def test_spectra_of_the_mean_and_of_the_probed_sample(viewer, bench, qtbot, cube):
    samples, wavelengths, _ = cube
    plot = viewer.canvas.below[Spectra]
    qtbot.waitUntil(lambda: plot.mean.getData()[0] is not None)
    x, y = plot.mean.getData()
    assert x == pytest.approx(wavelengths)
    assert y == pytest.approx(samples.mean(axis=(1, 2)), rel=1e-9)
    height = plot.size().height()
    point_at(viewer, bench, qtbot, 7, 11)
    x, y = plot.sample.getData()
    assert y == pytest.approx(samples[:, 7, 11], rel=1e-9)
    assert names(viewer) == [MEAN, "row 7  column 11"]
    point_at(viewer, bench, qtbot, 8, 12)
    assert plot.sample.getData()[1] == pytest.approx(samples[:, 8, 12], rel=1e-9)
    viewer.canvas.scene().sigMouseMoved.emit(QPointF(-50, -50))
    assert names(viewer) == [MEAN]
    assert plot.size().height() == height  # nothing moves
