"""The library: every module by group, found by typing, chosen and dragged."""

import pytest
from PySide6.QtCore import QMimeData, Qt
from PySide6.QtTest import QTest

from app.editor.library_view import MIME_TYPE, LibraryView, dragged_module
from app.editor.theme import DARK, LIGHT
from app.run.preset_files import shipped_presets
from core.modules.declaration import declaration
from screen_places import place_of_module

NONE, LEFT = Qt.KeyboardModifier.NoModifier, Qt.MouseButton.LeftButton


@pytest.fixture
def view(qtbot, library):
    made = LibraryView(library)
    qtbot.addWidget(made)
    made.resize(240, 500)
    made.show()
    qtbot.waitExposed(made)
    made.activateWindow()
    made.setFocus()
    return made


@pytest.fixture
def chosen(view):
    found = []
    view.chosen.connect(found.append)
    return found


def visible(view):
    return [key for key, item in view.tree.modules.items() if not item.isHidden()]


def test_every_module_stands_under_its_group_in_the_librarys_order(view, library):
    groups = [view.tree.topLevelItem(n).text(0) for n in range(view.tree.topLevelItemCount())]
    assert groups == list(dict.fromkeys(declaration(module).group for module in library.values()))
    for group, item in view.tree.groups.items():
        there = [item.child(row).text(0) for row in range(item.childCount())]
        wanted = [declaration(m).listed for m in library.values() if declaration(m).group == group]
        assert there == wanted


def test_the_tooltip_is_the_modules_text(view, library):
    for key, module in library.items():
        assert view.tree.modules[key].toolTip(0) == declaration(module).text


def test_typing_leaves_what_fits(view):
    QTest.keyClicks(view.filter, "line transfer")
    assert visible(view) == []
    view.filter.setText("jitter")
    assert visible(view) == ["jitter_mtf"]
    assert [name for name, item in view.tree.groups.items() if not item.isHidden()] == ["Motion"]
    view.filter.setText("MOTION mtf")
    assert set(visible(view)) > {"jitter_mtf", "vibration_mtf"}
    view.filter.clear()
    assert len(visible(view)) == len(view.tree.modules)


def test_enter_in_the_field_chooses_the_first(view, chosen):
    QTest.keyClicks(view.filter, "jitter")
    QTest.keyClick(view.filter, Qt.Key.Key_Return)
    assert chosen == ["jitter_mtf"]


def test_enter_in_an_empty_field_chooses_nothing(view, chosen):
    QTest.keyClick(view.filter, Qt.Key.Key_Return)
    assert chosen == []


def test_the_arrows_lead_from_the_field_to_the_modules(view, chosen):
    QTest.keyClick(view.filter, Qt.Key.Key_Down)
    assert view.tree.hasFocus()
    QTest.keyClick(view.tree, Qt.Key.Key_Down)
    QTest.keyClick(view.tree, Qt.Key.Key_Return)
    assert chosen == [list(view.tree.modules)[1]]


def test_a_double_click_chooses_and_a_group_does_not(view, chosen):
    viewport = view.tree.viewport()
    pos = viewport.mapFromGlobal(place_of_module(view, "detector_mtf"))
    QTest.mouseClick(viewport, LEFT, NONE, pos)
    QTest.mouseDClick(viewport, LEFT, NONE, pos)
    assert chosen == ["detector_mtf"]
    group = view.tree.visualItemRect(view.tree.groups["Detector"]).center()
    QTest.mouseDClick(viewport, LEFT, NONE, group)
    assert chosen == ["detector_mtf"]


def test_what_is_dragged_is_the_modules_key(view):
    data = view.tree.mimeData([view.tree.modules["exit_pupil"]])
    assert bytes(data.data(MIME_TYPE).data()) == b"exit_pupil"
    assert dragged_module(data) == "exit_pupil"
    assert view.tree.mimeTypes() == [MIME_TYPE]
    assert not view.tree.groups["Optics"].flags() & Qt.ItemFlag.ItemIsDragEnabled
    assert dragged_module(QMimeData()) == ""


def test_the_groups_wear_the_themes_colours(view):
    def mark(group):
        icon = view.tree.groups[group].icon(0)
        return icon.pixmap(icon.availableSizes()[0]).toImage().pixelColor(0, 0).name()

    view.setPalette(DARK.palette())
    assert mark("Motion") == DARK.groups["Motion"]
    view.setPalette(LIGHT.palette())
    assert mark("Motion") == LIGHT.groups["Motion"]


@pytest.mark.parametrize(
    ("typed", "best", "also"),
    [
        ("NETD", "figures_of_merit", {"electronics_noise"}),
        ("mrtd", "figures_of_merit", set()),
        ("ROI", "measured_mtf", set()),
        ("edge", "measured_mtf", {"test_scene"}),
        ("3D noise", "noise_3d", {"noise_3d_source"}),
        ("1/f", "noise_3d_source", set()),
        ("noise 3-d", "noise_3d", set()),
        ("banding", "electronics_noise", {"periodic_noise", "noise_3d"}),
        ("fixed pattern", "focal_plane", {"electronics_noise", "noise_3d"}),
        ("pushbroom", "camera_geometry", set()),
        ("budget", "noise_budget", set()),
        ("gsd", "camera", {"camera_geometry", "image_quality"}),
        ("niirs", "image_quality", set()),
        ("blur", "spatial_blur", {"gaussian_mtf", "jitter_mtf", "diffraction_mtf"}),
        ("gsmtf", "gaussian_mtf", set()),
        ("fplane", "focal_plane", set()),
    ],
)
def test_words_of_the_trade_find_their_module(view, chosen, typed, best, also):
    """What fits best is marked, so that Enter adds it; the others stay in sight."""
    QTest.keyClicks(view.filter, typed)
    assert {best, *also} <= set(visible(view))
    QTest.keyClick(view.filter, Qt.Key.Key_Return)
    assert chosen == [best]


def test_presets_are_told_apart_by_what_differs(view, library):
    presets = shipped_presets(library)
    view.show_presets(presets)
    items = {p.path.stem: view.tree.modules[p.key] for p in presets}
    lenses = {stem: item.toolTip(0) for stem, item in items.items() if stem.startswith("lens")}
    assert "Size x 2.1618 cm · Size y 2.1618 cm" in lenses["lens_flir_tau2_19mm"]
    assert "Size x 5.9259 cm" in lenses["lens_flir_tau2_50mm"]
    assert not any("Radius" in text for text in lenses.values())  # all have the same
    camera = items["camera_kodak_kir310"].toolTip(0)
    for told in ("Focal length 200 mm", "F number 2", "Material PtSi"):
        assert told in camera
    assert "Focal length 25 mm" in items["camera_flir_tau2_640_25mm"].toolTip(0)


def test_long_names_that_begin_alike_show_their_ends(view, library):
    view.show_presets(shipped_presets(library))
    view.resize(150, 500)
    assert view.tree.textElideMode() == Qt.TextElideMode.ElideMiddle
    item = view.tree.modules["preset:shipped:lens_flir_tau2_19mm"]
    room = view.tree.visualItemRect(item).width()
    metrics = view.tree.fontMetrics()
    shown = metrics.elidedText(item.text(0), view.tree.textElideMode(), room - 8)
    assert shown.endswith("F/1.25")
    assert "…" in shown


def test_analysis_begins_with_what_judges_a_sensor(view):
    group = view.tree.groups["Analysis"]
    titles = [group.child(row).text(0) for row in range(group.childCount())]
    assert titles[:4] == ["MTF Slices", "Measured MTF", "Figures of Merit", "Noise Budget"]
