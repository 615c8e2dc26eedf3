"""Choices that go with another choice: the materials of a wavelength region."""

from PySide6.QtCore import QPoint
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from core.editing.operations import set_parameter
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


def test_what_is_set_stays_offered_until_something_else_is(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "electronics_noise")
    sections = area.panels["node"].body.sections
    region, material = sections.field("region"), sections.field("material")
    assert offered(material) == ["HgCdTe", "Si", "manual"]  # set by default, not of the region
    session.do(set_parameter("node", "material", "Si:As"))
    press(region, "MWIR")
    assert offered(material) == ["HgCdTe", "InSb", "PtSi", "Si:As", "manual"]
    assert material.buttons[material.choices.index("Si:As")].isChecked()
    press(material, "InSb")
    assert offered(material) == ["HgCdTe", "InSb", "PtSi", "manual"]
    session.undo()
    assert "Si:As" in offered(material)
    session.undo()
    assert offered(material) == ["Si", "Si:As", "manual"]
