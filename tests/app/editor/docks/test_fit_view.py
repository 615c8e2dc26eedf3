"""The fit dock in a window: a number is freed, fitted, taken and undone; what fails is said."""

import json

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from app.editor.session import FreeNumber
from app.fit.fit_result import FittedParameter
from core.editing.operations import rename_node, set_parameter
from edge_truth import HEADER, blur_network, gaussian_edge
from window_hands import choose_file

LEFT = Qt.MouseButton.LeftButton
INTERVAL_MRAD = 0.1
SIGMA = 0.8  # samples
FITTED, LOW, HIGH = 2, 5, 6  # columns


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A chain with too little blur, and a picture of an edge that has more."""
    folder = tmp_path_factory.mktemp("fit")
    network = blur_network(
        interval_mrad=INTERVAL_MRAD,
        blur=("gaussian_mtf", {"sigma_x_mrad": 0.05, "sigma_y_mrad": 0.08}),
    )
    network["nodes"]["scene"]["params"] |= {"cut_on_um": 3.0, "cut_off_um": 5.0}
    (folder / "net.json").write_text(json.dumps(network), encoding="utf-8")
    picture = gaussian_edge(angle_deg=6.0, sigma=(SIGMA, 0.8), shape=(64, 64), noise=20.0, seed=5)
    np.save(folder / "edge.npy", picture)
    again = gaussian_edge(angle_deg=6.0, sigma=(SIGMA, 0.8), shape=(64, 64), noise=20.0, seed=6)
    np.save(folder / "edge_too.npy", again)
    sharp = gaussian_edge(angle_deg=6.0, sigma=(0.02, 0.8), shape=(64, 64), noise=20.0, seed=5)
    np.save(folder / "sharp.npy", sharp)
    picture.astype("<f8").tofile(folder / "lwir.img")
    fov = np.degrees(2.0 * np.arctan(64 * 2.0 * INTERVAL_MRAD / 2000.0))
    (folder / "lwir.hdr").write_text(HEADER.format(centre=10.0, width=4.0, fov=fov))
    np.save(folder / "flat.npy", np.random.default_rng(1).normal(100.0, 1.0, (64, 64)))
    return folder


@pytest.fixture
def fitting(window, files):
    window.files.open_now(str(files / "net.json"))
    window.actions_by_name["fit"].trigger()
    assert window.fitting.isVisible()
    window.session.select(["blur"])
    return window


def right_click(window, name, action):
    """Choose an entry of the menu of a field, by the right button on its label."""
    field = window.panels.panels["blur"].body.sections.field(name)
    at = QPoint(3, 3)
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, field.label.mapToGlobal(at))
    QApplication.sendEvent(field.label, event)
    menu = next(one for one in field.findChildren(QMenu) if one.isVisible())
    entry = next((one for one in menu.actions() if one.objectName() == action), None)
    if entry is not None:
        entry.trigger()
    menu.close()
    return field, entry


def test_a_number_is_freed_fitted_taken_and_undone(fitting, files, qtbot):
    window, view = fitting, fitting.fitting
    assert not view.fit.isEnabled()
    assert not view.table.isVisible()  # only what to do is in sight
    assert view.chart.hint.isVisible()
    field, entry = right_click(window, "sigma_x_mrad", "free")
    assert "not saved" in entry.toolTip()
    assert field.label.text().endswith("free")
    assert view.table.rowCount() == 1
    assert view.table.isVisible()
    view.take_files((files / "edge.npy",))
    seen = []
    view._said.connect(lambda _stop, _shown, what: seen.append(what))
    before = window.session.document.network
    steps = window.session.document.position
    qtbot.mouseClick(view.fit, Qt.MouseButton.LeftButton)
    assert view.stop.isEnabled()
    qtbot.waitUntil(lambda: view.outcome is not None)
    (fitted,) = view.outcome.parameters
    # Nearly all of the blur is across: sin²(6°) of it is along, and there it is as in the picture.
    assert fitted.value == pytest.approx(SIGMA * INTERVAL_MRAD, abs=3.0 * fitted.sigma)
    assert 1e-4 < fitted.sigma < 1e-3
    assert view.outcome.chi2_per_degree == pytest.approx(1.0, abs=0.1)
    assert window.session.document.network is before
    assert any(isinstance(what, tuple) for what in seen)  # drawn as the values changed
    assert not view.chart.hint.isVisible()
    drawn = view.chart.edge
    assert len(drawn.distance) > 200
    assert float(np.std(drawn.sample - drawn.spread)) == pytest.approx(20.0 / 3000.0, rel=0.2)
    assert not view.grab().isNull()
    qtbot.mouseClick(view.taking, Qt.MouseButton.LeftButton)
    session = window.session
    taken = session.network.nodes["blur"].params["sigma_x_mrad"]
    assert taken == pytest.approx(fitted.value, abs=fitted.sigma / 100.0)
    assert len(str(taken)) <= len("0.0800000")  # no digits that nobody can know
    assert view.table.item(0, 1).text() == f"{taken:.6g}"
    assert session.document.position == steps + 1
    window.actions_by_name["undo"].trigger()
    assert session.document.network == before
    assert "χ²" in view.status.title.text()
    session.do(set_parameter("blur", "sigma_y_mrad", 0.2))
    assert "out of date" in view.status.title.text()
    right_click(window, "sigma_x_mrad", "fix")
    assert field.label.text() == field.title
    assert view.table.rowCount() == 0


def test_buttons_warn_of_another_camera_and_offer_no_value_that_may_be_another(
    fitting, files, qtbot
):
    window, view = fitting, fitting.fitting
    right_click(window, "sigma_x_mrad", "free")

    def fit(name):
        choose_file(view.file, files / name)
        assert view.name.text() == name
        QTest.mouseClick(view.fit, LEFT)
        qtbot.waitUntil(lambda: not view.busy)
        return " ".join(text for _, text in view.notices.left)

    said = fit("lwir.img")
    assert "was taken in the band 8 to 12 µm, but the chain covers 3 to 5 µm" in said
    assert "A sample of lwir.img is 0.2 mrad wide" in said
    assert view.taking.isEnabled()
    said = fit("sharp.npy")
    assert "poorly determined" in said
    assert view.status.title.text().startswith("0 of 1 parameters determined")
    assert not view.taking.isEnabled()
    before = window.session.document.network
    QTest.mouseClick(view.taking, LEFT)
    assert window.session.document.network is before


def test_what_is_not_determined_is_not_taken_and_faults_are_one_line(fitting, files, qtbot):
    window, view = fitting, fitting.fitting
    session = window.session
    session.make_free(FreeNumber("init", "range_m"))  # no blur depends on it
    session.make_free(FreeNumber("blur", "sigma_x_mrad"))
    view.table.item(1, LOW).setText("0.01")
    view.table.item(1, HIGH).setText("30 urad")
    assert session.free[1] == FreeNumber("blur", "sigma_x_mrad", 0.01, 0.03)
    view.table.item(1, HIGH).setText("0.005")
    assert "must be below" in view.status.title.text()
    assert view.table.item(1, HIGH).text() == "0.03"
    view.table.item(1, HIGH).setText("")
    assert session.free[1].high is None
    view.table.setCurrentCell(1, 0)
    qtbot.keyClick(view.table, Qt.Key.Key_Delete)
    assert [one.port for one in session.free] == ["init.range_m"]
    view.take_files((files / "edge.npy",))
    view.begin()
    qtbot.waitUntil(lambda: view.outcome is not None)
    assert [one.value is None for one in view.outcome.parameters] == [True]
    assert view.table.item(0, FITTED).text() == "not determined"
    assert any("not determined" in text for _, text in view.notices.left)
    assert not view.taking.isEnabled()
    before = session.document.network
    view.take()
    assert session.document.network is before
    view.take_files((files / "flat.npy",))
    view.begin()
    qtbot.waitUntil(lambda: "no edge can be used" in view.status.title.text())
    assert view.outcome is None
    session.make_free(FreeNumber("blur", "sigma_x_mrad"))
    session.do(rename_node("blur", "smear"))
    assert session.free[-1].place == ("smear", "sigma_x_mrad")
    view.begin()
    window.files.open_now(str(files / "net.json"))
    assert not view.busy
    assert session.free == ()
    for button in (view.file, view.fit, view.stop, view.taking, view.remove):
        assert button.toolTip()
        assert button.accessibleName()


def test_the_table_writes_what_is_free_its_limits_and_what_was_fitted(fitting):
    table, session = fitting.fitting.table, fitting.session
    session.make_free(FreeNumber("blur", "sigma_x_mrad", 0.01, None))
    session.make_free(FreeNumber("blur", "sigma_y_mrad", None, 0.3))
    session.make_free(FreeNumber("init", "range_m"))

    def cells(row):
        return [table.item(row, column).text() for column in range(1, table.columnCount())]

    assert [cells(row) for row in range(3)] == [
        ["0.05", "", "", "mrad", "0.01", ""],
        ["0.08", "", "", "mrad", "", "0.3"],
        ["", "", "", "m", "", ""],
    ]
    table.show_fitted((
        FittedParameter("blur.sigma_x_mrad", "mrad", 0.0812345678, 0.001234, 0.08),
        FittedParameter("blur.sigma_y_mrad", "mrad", None, None, 0.08),
        FittedParameter("init.range_m", "m", 1234.5678, None, 1234.0),
    ))  # fmt: skip
    assert [cells(row)[1:3] for row in range(3)] == [
        ["0.0812346", "0.0012"], ["not determined", ""], ["1234.57", ""],
    ]  # fmt: skip
    left = Qt.AlignmentFlag.AlignRight
    aligned = [bool(table.item(0, column).textAlignment() & left) for column in range(7)]
    assert aligned == [False, True, True, True, False, True, True]
    editable = [bool(table.item(0, column).flags() & Qt.ItemFlag.ItemIsEditable)
                for column in range(7)]  # fmt: skip
    assert editable == [False] * 5 + [True] * 2
    table.show_fitted(())
    assert [cells(row)[1:3] for row in range(3)] == [["", ""]] * 3
