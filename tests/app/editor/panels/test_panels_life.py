"""Panels come and go, at any width and in both looks."""

import html
import re
import weakref

import pytest
import shiboken6
from PySide6.QtGui import QFont
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from app.editor.panels.fields.number import NumberField
from app.editor.panels.panel_area import PanelArea
from app.editor.theme import DARK, LIGHT
from core.editing.operations import set_parameter
from core.modules.declaration import declaration
from panel_hands import LIBRARY, change, drop, field_of, let_go, panel_area, type_in


def change_what_is_shown(panel):
    for field in panel.body.sections.fields:
        if field.isVisible():
            change(field)


@pytest.mark.thorough(but=6, always=("electronics_noise", "read_image", "exit_pupil"))
@pytest.mark.parametrize("key", LIBRARY)
def test_no_widget_outlives_its_panel(qtbot, session, key):
    area = panel_area(qtbot, session)
    drop(session, key)
    panel = area.panels["node"]
    widgets = [panel, *panel.findChildren(QWidget)]
    change_what_is_shown(panel)
    kept = [weakref.ref(widget) for widget in widgets]
    assert len(kept) > 15
    del panel, widgets
    session.select([])
    let_go()
    alive = [ref() for ref in kept if ref() is not None]
    assert not [widget for widget in alive if shiboken6.isValid(widget)]
    assert not alive


def test_the_area_goes_with_all_it_has(qtbot, session):
    area = PanelArea(session, None)
    area.show()
    drop(session, "electronics_noise")
    kept = [weakref.ref(widget) for widget in (area, *area.findChildren(QWidget))]
    area.close()
    area.deleteLater()
    del area
    let_go()
    assert not [ref() for ref in kept if ref() is not None and shiboken6.isValid(ref())]
    session.do(set_parameter("node", "bits", 8))  # nobody listens any more


@pytest.mark.thorough(always=("300-dark", "480-light"))
@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
@pytest.mark.parametrize("width", [300, 480])
def test_nothing_is_clipped(qtbot, session, width, theme):
    area = panel_area(qtbot, session, width=width)
    area.setPalette(theme.palette())
    for key, module in LIBRARY.items():
        drop(session, key, key)
        QApplication.processEvents()
        panel = area.panels[key]
        assert area.widget().width() <= area.viewport().width(), key
        for part in panel.findChildren(QWidget):
            if part.isVisible() and part.parentWidget() is not None and not part.isWindow():
                inside = part.parentWidget().rect()
                assert inside.contains(part.geometry()) or "scroll" in part.objectName(), (
                    key,
                    part.objectName(),
                    part.geometry(),
                )
        titles = [panel.head.bar.title.text(), panel.head.name.text()]
        plain = [re.sub(r"\W|_", "", text).lower() for text in (key, declaration(module).title)]
        alike = plain[0] == plain[1]
        assert titles == ["" if alike else declaration(module).title, key]


@pytest.mark.thorough(always=("9-380", "15-380"))
@pytest.mark.parametrize("width", [380, 480])
@pytest.mark.parametrize("points", [9, 15])
def test_name_slider_and_line_of_a_number_stand_on_one_line(qtbot, session, points, width):
    font = QApplication.font()
    large = QFont(font)
    large.setPointSizeF(points)
    QApplication.setFont(large)
    try:
        area = panel_area(qtbot, session, width=width)
        for key in LIBRARY:
            drop(session, key, key)
            QTest.qWait(1)
            assert area.widget().width() <= area.viewport().width(), key
            fields = [f for f in area.panels[key].body.sections.fields if f.isVisible()]
            numbers = [field for field in fields if isinstance(field, NumberField)]
            for field in numbers:
                parts = (field.label, field.slider, field.edit, field.unit)
                middles = [part.geometry().center().y() for part in parts]
                assert max(middles) - min(middles) <= 2, (key, field.parameter.name)
                lefts = [part.geometry().left() for part in parts]
                assert lefts == sorted(lefts)
                assert field.height() < 2 * field.edit.height()
            assert len({field.slider.geometry().left() for field in numbers}) <= 1, key
            assert len({field.edit.geometry().right() for field in numbers}) <= 1, key
    finally:
        QApplication.setFont(font)


def test_a_name_that_is_too_long_is_in_the_tooltip(qtbot, session):
    area = panel_area(qtbot, session, width=300)
    drop(session, "electronics_noise")
    labels = [f.label for f in area.panels["node"].body.sections.fields if f.isVisible()]
    QTest.qWait(20)
    cut = [
        label
        for label in labels
        if label.fontMetrics().horizontalAdvance(label.text()) > label.width() > 0
    ]
    assert cut
    assert all(label.text() in html.unescape(label.parent().toolTip()) for label in cut)


def test_colours_follow_the_theme(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "jitter_mtf")
    field = field_of(area, session, "sigma_mrad")
    type_in(field.edit, "3")
    for theme in (LIGHT, DARK):
        area.setPalette(theme.palette())
        assert field.label.palette().color(field.label.foregroundRole()).name() == theme.changed
