"""Panels come and go, at any width and in both looks."""

import re
import weakref

import pytest
import shiboken6
from PySide6.QtWidgets import QApplication, QWidget

from app.editor.theme import LIGHT
from core.modules.declaration import declaration
from panel_hands import LIBRARY, change, drop, let_go, panel_area


def change_what_is_shown(panel):
    for field in panel.body.sections.fields:
        if field.isVisible():
            change(field)


@pytest.mark.parametrize("key", ["electronics_noise", "read_image"])
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


def test_nothing_is_clipped(qtbot, session):
    area = panel_area(qtbot, session, width=300)
    area.setPalette(LIGHT.palette())
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
