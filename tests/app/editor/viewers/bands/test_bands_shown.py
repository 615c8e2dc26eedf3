"""The viewer of a picture with bands, with a real worker behind it."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QImage

from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.picture.plots_below import MEAN, NO_SAMPLE
from core.editing.document import Document
from core.editing.operations import Together, set_parameter
from core.errors import UsageError
from core.network.file import load_network
from cube_files import write_cube
from cube_network import BANDS, SIZE, write_cube_network
from viewer_bench import ViewerBench, is_freed

READ, FILTERED, PLAIN = "read.image", "back.image", "fpa.image"


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
    return [label.text for _, label in viewer.canvas.spectra.legend.items]


def test_all_bands_at_first(viewer, cube):
    samples, _, width = cube
    bar = viewer.band_bar
    assert bar.isVisible()
    assert bar.shown.currentText() == "All bands: sum"
    assert bar.about.text() == "12 bands, 3 to 5 µm"
    assert not bar.slider.isVisible()
    assert viewer.picture.samples == pytest.approx(samples.sum(axis=0) * width, rel=1e-5)


def test_a_picture_without_bands_has_no_controls_for_them(viewer, bench):
    choose(viewer, bench, "one")
    viewer.look_at(PLAIN)
    bench.settle()
    assert not viewer.band_bar.isVisible()
    assert not viewer.canvas.spectra.shown
    assert not viewer.bar.display.spectra.isEnabled()
    assert len(viewer.queries()) == 1
    viewer.look_at(READ)
    bench.settle()
    assert viewer.band_bar.isVisible()
    assert viewer.bar.display.spectra.isEnabled()
    assert viewer.picture.facts.wavelengths_um


def test_one_band_by_slider_wavelength_and_keys(viewer, bench, qtbot, cube):
    samples, wavelengths, _ = cube
    choose(viewer, bench, "one")
    bar = viewer.band_bar
    assert bar.slider.value() == bar.one.value() == BANDS // 2
    assert viewer.picture.samples == pytest.approx(samples[BANDS // 2], rel=1e-6)
    bar.slider.setFocus()
    qtbot.keyClick(bar.slider, Qt.Key.Key_Right)
    bench.settle()
    assert viewer.picture.samples == pytest.approx(samples[BANDS // 2 + 1], rel=1e-6)
    bar.one.setFocus()
    bar.one.selectAll()
    qtbot.keyClicks(bar.one, "3.4")
    qtbot.keyClick(bar.one, Qt.Key.Key_Return)
    bench.settle()
    place = int(np.argmin(np.abs(wavelengths - 3.4)))
    assert bar.slider.value() == place
    assert bar.one.text() == f"{wavelengths[place]:.2f} µm"
    assert bar.about.text() == f"0.167 µm wide, {place + 1} of {BANDS}"
    assert viewer.picture.samples == pytest.approx(samples[place], rel=1e-6)
    for typed in ("3900 nm", "3400nm"):
        bar.one.selectAll()
        qtbot.keyClicks(bar.one, typed)
        qtbot.keyClick(bar.one, Qt.Key.Key_Return)
        bench.settle()
        wanted = float(typed.rstrip("nm ")) / 1000
        assert bar.slider.value() == int(np.argmin(np.abs(wavelengths - wanted)))
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageUp)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageUp)
    qtbot.keyClick(viewer.canvas, Qt.Key.Key_PageDown)
    bench.settle()
    assert viewer.picture.samples == pytest.approx(samples[place + 1], rel=1e-6)


def test_from_all_bands_the_keys_lead_to_the_first_or_the_last(viewer, bench, qtbot, cube):
    samples, _, _ = cube
    for key, place in ((Qt.Key.Key_PageUp, 0), (Qt.Key.Key_PageDown, BANDS - 1)):
        choose(viewer, bench, "all")
        qtbot.keyClick(viewer.canvas, key)
        bench.settle()
        assert viewer.band_bar.shown.currentText() == "One band"
        assert viewer.picture.samples == pytest.approx(samples[place], rel=1e-6)


def test_a_wavelength_outside_the_bands_is_noted(viewer, bench, qtbot):
    """The cube goes from 3 to 5 µm; its outermost centres lie half a band further in."""
    choose(viewer, bench, "one")
    spin, noted = viewer.band_bar.one, []
    bench.session.message.connect(lambda kind, text: noted.append((kind, text)))

    def type_in(text):
        spin.selectAll()
        qtbot.keyClicks(spin, text)
        qtbot.keyClick(spin, Qt.Key.Key_Return)

    for inside in ("3.01", "4990 nm", "4"):
        type_in(inside)
    spin.stepBy(1)
    assert noted == []
    why = "µm is outside the bands, 3 to 5 µm: the nearest band is shown"
    for outside, text in (("9500 nm", f"9.5 {why}"), ("2.9", f"2.9 {why}")):
        type_in(outside)
        assert noted == [("note", text)]
        noted.clear()
    assert spin.value() == 0


def test_tab_leads_from_the_wire_through_the_bands_to_the_picture(viewer, bench):
    choose(viewer, bench, "one")
    order, widget = [], viewer.bar.ports
    while widget is not viewer.canvas and len(order) < 40:
        widget = widget.nextInFocusChain()
        order.append(widget)
    bar = viewer.band_bar
    assert viewer.canvas in order
    assert order.index(bar.shown) < order.index(bar.slider) < order.index(bar.one)


def test_a_dragged_line_chooses_the_band_and_rests_on_it(viewer, bench, cube):
    samples, wavelengths, _ = cube
    choose(viewer, bench, "one")
    plot = viewer.canvas.spectra
    line = plot.lines[0]
    assert line.value() == pytest.approx(wavelengths[BANDS // 2])
    line.setValue(3.3)
    line.sigDragged.emit(line)
    bench.settle()
    place = int(np.argmin(np.abs(wavelengths - 3.3)))
    assert viewer.picture.samples == pytest.approx(samples[place], rel=1e-6)
    line.sigPositionChangeFinished.emit(line)
    assert line.value() == pytest.approx(wavelengths[place])


def test_colours(viewer, bench, cube):
    samples, wavelengths, _ = cube
    choose(viewer, bench, "colours")
    bar = viewer.band_bar
    assert [spin.value() for spin in bar.colours] == [10, 6, 2]
    assert not bar.even.isEnabled()
    assert viewer.canvas.first.image.shape == (*SIZE, 3)
    bar.colours[1].setValue(5)
    bench.settle()
    assert viewer.picture.channels[1].samples == pytest.approx(samples[5], rel=1e-6)
    assert [line.isVisible() for line in viewer.canvas.spectra.lines] == [True] * 3
    assert viewer.canvas.spectra.lines[1].value() == pytest.approx(wavelengths[5])
    bar.even.click()
    bench.settle()
    assert [spin.value() for spin in bar.colours] == [10, 6, 2]


def test_the_histogram_of_colours_has_three_lines(viewer, bench, qtbot):
    levels = viewer.canvas.levels
    choose(viewer, bench, "colours")
    qtbot.waitUntil(lambda: not levels.is_behind)
    assert levels.plot.xData is None or not len(levels.plot.xData)
    assert all(len(plot.xData) == 256 for plot in levels.plots[1:4])
    assert levels.getLevels() == pytest.approx((0.0, 1.0))
    before = viewer.picture.grey.astype(int)
    viewer.canvas.levels.dragged.emit(0.0, 0.5)
    bench.settle()
    assert (viewer.picture.grey >= before).all()
    choose(viewer, bench, "all")
    qtbot.waitUntil(lambda: not levels.is_behind)
    assert len(levels.plot.xData) == 256
    assert all(not len(plot.xData) for plot in levels.plots[1:4])


def test_the_picture_in_colours_is_drawn_and_saved(viewer, bench, tmp_path):
    choose(viewer, bench, "colours")
    viewer.canvas.grab()
    truth = viewer.picture.grey
    viewer.save_as(tmp_path / "colours.png")
    for drawn in (viewer.canvas.first.qimage, QImage(str(tmp_path / "colours.png"))):
        for row, column in ((0, 0), (SIZE[0] - 1, SIZE[1] - 1), (5, 17)):
            colour = drawn.pixelColor(column, row)
            assert (colour.red(), colour.green(), colour.blue()) == tuple(truth[row, column])
    with pytest.raises(UsageError, match="three bands shown as colours can only be saved as"):
        viewer.save_as(tmp_path / "colours.npy")


def test_a_wipe_of_colours_and_greys(viewer, bench, tmp_path):
    choose(viewer, bench, "colours")
    viewer.bar.compare.other_chosen.emit(PLAIN)
    bench.settle()
    assert viewer.canvas.second.image.ndim == 2
    viewer.save_as(tmp_path / "wipe.png")
    drawn = QImage(str(tmp_path / "wipe.png"))
    right = drawn.pixelColor(SIZE[1] - 1, 3)
    assert right.red() == right.green() == right.blue() == viewer.picture.other.grey[3, -1]
    left = drawn.pixelColor(0, 3)
    assert (left.red(), left.green(), left.blue()) == tuple(viewer.picture.grey[3, 0])


def test_the_profile_of_colours_has_three_lines(viewer, bench):
    viewer.bar.display.profile.setChecked(True)
    choose(viewer, bench, "colours")
    colours = viewer.canvas.profile._colours
    lengths = [len(curve.getData()[0]) for curve in colours]
    assert lengths[0] == lengths[1] == lengths[2] > 10
    choose(viewer, bench, "one")
    assert all(curve.getData()[0] is None or not len(curve.getData()[0]) for curve in colours)


def test_spectra_of_the_mean_and_of_the_probed_sample(viewer, bench, qtbot, cube):
    samples, wavelengths, _ = cube
    plot = viewer.canvas.spectra
    qtbot.waitUntil(lambda: plot.mean.getData()[0] is not None)
    x, y = plot.mean.getData()
    assert x == pytest.approx(wavelengths)
    assert y == pytest.approx(samples.mean(axis=(1, 2)), rel=1e-9)
    height = plot.plot.size().height()
    point_at(viewer, bench, qtbot, 7, 11)
    x, y = plot.sample.getData()
    assert y == pytest.approx(samples[:, 7, 11], rel=1e-9)
    assert names(viewer) == [MEAN, "row 7  column 11"]
    point_at(viewer, bench, qtbot, 8, 12)
    assert plot.sample.getData()[1] == pytest.approx(samples[:, 8, 12], rel=1e-9)
    viewer.canvas.scene().sigMouseMoved.emit(QPointF(-50, -50))
    assert names(viewer) == [MEAN]
    assert plot.plot.size().height() == height  # nothing moves


def test_the_ordinate_of_spectra_only_grows(viewer, bench, qtbot, cube):
    plot = viewer.canvas.spectra
    samples = cube[0]
    brightest = np.unravel_index(samples[-1].argmax(), SIZE)
    point_at(viewer, bench, qtbot, *map(float, brightest))
    seen = plot.plot.viewRange()[1]
    assert seen[1] > samples[:, brightest[0], brightest[1]].max()
    darkest = np.unravel_index(samples[-1].argmin(), SIZE)
    point_at(viewer, bench, qtbot, *map(float, darkest))
    low, high = plot.plot.viewRange()[1]
    assert low <= seen[0]
    assert high >= seen[1]


def test_curves_stay_until_there_are_newer_ones_and_the_ordinate_follows(
    viewer, bench, qtbot, cube
):
    plot, mean = viewer.canvas.spectra, cube[0].mean(axis=(1, 2))
    qtbot.waitUntil(lambda: plot.mean.getData()[0] is not None)
    seen = plot.plot.viewRange()[1]
    drawn = []
    plot.mean.sigPlotChanged.connect(lambda curve: drawn.append(len(curve.getData()[0])))
    bench.do(set_parameter("read", "scale", 0.1))
    qtbot.waitUntil(lambda: plot.mean.getData()[1] == pytest.approx(0.1 * mean, rel=1e-6))
    assert set(drawn) == {BANDS}  # never empty
    assert plot.plot.viewRange()[1][1] == pytest.approx(0.1 * seen[1], rel=1e-6)


def test_behind_a_filter_the_plot_says_where_to_look(viewer, bench, qtbot):
    viewer.look_at(FILTERED)
    bench.settle()
    point_at(viewer, bench, qtbot, 7, 11)
    assert names(viewer) == [MEAN, NO_SAMPLE]


def test_without_height_for_both_the_picture_has_all_of_it(viewer, bench, qtbot):
    line = viewer.fontMetrics().height()
    viewer.resize(640, 18 * line)
    qtbot.waitUntil(lambda: not viewer.canvas.spectra.shown)
    qtbot.waitUntil(lambda: viewer.canvas.view.height() > 5 * line)
    qtbot.wait(60)
    assert len(viewer.queries()) == 1
    viewer.resize(640, 32 * line)
    qtbot.waitUntil(lambda: viewer.canvas.spectra.shown)
    viewer.bar.display.profile.setChecked(True)  # takes eight lines
    assert not viewer.canvas.spectra.shown
    viewer.bar.display.profile.setChecked(False)
    assert viewer.canvas.spectra.shown


def test_why_there_is_no_mean_stands_in_its_place(viewer, bench, qtbot, cube, tmp_path):
    """Another band than the one shown has a sample that is not finite."""
    samples, wavelengths, width = cube
    choose(viewer, bench, "one")
    broken = samples.copy()
    broken[2, 4, 4] = np.nan
    write_cube(tmp_path, broken, wavelengths, width)
    bench.evaluator.generate()
    bench.settle()
    qtbot.waitUntil(lambda: names(viewer) != [MEAN])
    assert "1 of 960 samples of band 2 are not finite" in names(viewer)[0]
    assert viewer.picture.samples == pytest.approx(samples[BANDS // 2], rel=1e-6)


@pytest.mark.parametrize("shown", ["all", "one", "colours"])
def test_the_row_fits_a_narrow_viewer(viewer, bench, shown):
    choose(viewer, bench, shown)
    letter = viewer.fontMetrics().averageCharWidth()
    assert viewer.band_bar.minimumSizeHint().width() < 60 * letter


def test_the_plot_of_spectra_can_be_put_away(viewer, bench, qtbot):
    viewer.bar.display.spectra.setChecked(False)
    assert not viewer.canvas.spectra.shown
    qtbot.wait(60)
    assert len(viewer.queries()) == 1


def test_a_narrower_filter_keeps_the_wavelength(viewer, bench, cube):
    wavelengths = cube[1]
    choose(viewer, bench, "one")
    viewer.band_bar.slider.setValue(8)
    bench.settle()
    ends = (set_parameter("read", "cut_on_um", 4.0), set_parameter("read", "cut_off_um", 5.0))
    bench.do(Together(ends, "Narrow the band"))
    assert viewer.band_bar.slider.maximum() == BANDS // 2 - 1
    assert viewer.picture.facts.wavelengths_um == pytest.approx((wavelengths[8],))


def test_a_viewer_with_bands_is_freed(bench, qtbot):
    def make():
        viewer = ImageViewer(bench.session, bench.evaluator, 5)
        viewer.look_at(READ)
        viewer.resize(500, 400)
        viewer.show()
        bench.settle()
        choose(viewer, bench, "colours")
        return viewer

    assert is_freed(make)
