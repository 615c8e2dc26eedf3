"""Choices that go with another choice: the materials of a wavelength region."""

from PySide6.QtCore import QPoint
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from panel_hands import LEFT, drop, panel_area


def offered(field):
    QApplication.processEvents()
    return [c for c, b in zip(field.choices, field.buttons, strict=True) if b.isVisible()]


def press(field, choice):
    button = field.buttons[field.choices.index(choice)]
    QTest.mouseClick(button, LEFT, pos=QPoint(8, button.height() // 2))


def test_a_region_offers_its_materials_as_buttons(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "electronics_noise")
    sections = area.panels["node"].body.sections
    region, material = sections.field("region"), sections.field("material")
    press(region, "LWIR")
    assert offered(material) == ["HgCdTe", "Si:Ga", "Si:As", "manual"]
    press(material, "Si:As")
    assert session.network.nodes["node"].params["material"] == "Si:As"
