"""Every parameter of every module, changed on its panel with mouse and keys."""

import html
from collections import Counter

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLineEdit, QSlider

from app.editor.theme import DARK
from core.errors import ParameterError, thaw
from core.modules.declaration import declaration
from panel_hands import LIBRARY, change, drag, drop, field_of, panel_area, type_in, undo_to

# Together they have every kind of parameter and of section.
EVERY_KIND = (
    "electronics_noise",
    "read_image",
    "measured_mtf",
    "exit_pupil",
    "vignetting",
    "figures_of_merit",
    "atmosphere_mtf",
    "line_by_line",
)


def kinds(key):
    """What fields and sections of a panel differ in, other than their words."""
    declared = declaration(LIBRARY[key])
    for parameter in declared.parameters:
        param = parameter.param
        yield parameter.kind, param.unit != ""
        bounds = (param.low is not None, param.high is not None, param.above, param.below)
        yield parameter.kind, *bounds
        yield parameter.kind, parameter.required, parameter.empty, param.zero_is_empty
    for section in declared.panel:
        yield bool(section.title), bool(section.shown_when), bool(section.offer), section.page != ""


def test_those_of_every_run_have_every_kind():
    assert {kind for key in EVERY_KIND for kind in kinds(key)} == {
        kind for key in LIBRARY for kind in kinds(key)
    }


def stored(session, name):
    return thaw(session.network.nodes["node"].params[name])


def outside(parameter):
    """Values just outside the declared range."""
    param = parameter.param
    if param.low is not None:
        below = int(param.low) if param.above else int(param.low) - 1
        yield -1 if below == 0 and parameter.empty and param.zero_is_empty else below
    if param.high is not None:
        yield int(param.high) if param.below else int(param.high) + 1


@pytest.mark.thorough(but=4, always=EVERY_KIND)
@pytest.mark.parametrize("key", LIBRARY)
def test_every_parameter_of_a_module_on_its_panel(qtbot, session, key):
    area = panel_area(qtbot, session)
    drop(session, key)
    parameters = declaration(LIBRARY[key]).parameters
    position = session.document.position
    assert_it_says_what_it_is(area, session, parameters)
    undo_to(session, position)
    assert_it_is_changed_and_undone(area, session, parameters)
    for parameter in parameters:
        if parameter.param.low is not None or parameter.param.high is not None:
            assert_what_is_out_of_range_is_refused(area, session, parameter)
        if parameter.kind in ("number", "integer"):
            assert_a_drag_of_the_slider_is_one_step(area, session, parameter.name)


def assert_it_is_changed_and_undone(area, session, parameters):
    """By its widget."""
    before, position = session.document.text(), session.document.position
    for parameter in parameters:
        field = field_of(area, session, parameter.name)
        steps = session.document.position
        value = change(field)
        assert session.document.position == steps + 1
        assert stored(session, parameter.name) == value
        assert type(stored(session, parameter.name)) is type(value)
        assert field.changed == (parameter.coerce(value) != parameter.default)
        assert field.marked_label().font().bold() == field.changed
    undo_to(session, position)
    assert session.document.text() == before
    assert not any(field.changed for field in area.panels["node"].body.sections.fields)


def assert_it_says_what_it_is(area, session, parameters):
    names = set()
    for parameter in parameters:
        field = field_of(area, session, parameter.name)
        names.add(field.marked_label().text())
        assert field.marked_label().isVisible()
        assert field.unit.text() == parameter.param.unit
        assert field.unit.isVisible() == bool(parameter.param.unit) or not parameter.param.unit
        tip = html.unescape(field.toolTip())
        assert parameter.param.text[1:] in tip
        assert parameter.name in tip
        editors = [
            editor
            for kind in (QAbstractButton, QComboBox, QLineEdit, QSlider)
            for editor in field.findChildren(kind)
        ]
        assert editors
        for editor in editors:
            assert editor.accessibleName().startswith(field.title)
            assert editor.objectName().endswith(parameter.name)
            assert editor.focusPolicy() & Qt.FocusPolicy.TabFocus
        if parameter.kind not in ("switch", "choice"):
            assert parameter.allowed() in tip
    assert len(names) == len(parameters)  # no two alike
    assert "" not in names


def assert_what_is_out_of_range_is_refused(area, session, parameter):
    """And marked, in the words of the command."""
    name = parameter.name
    field = field_of(area, session, name)
    shown, before = field.edit.text(), session.document.text()
    bad = list(outside(parameter))
    assert bad, name
    for value in bad:
        type_in(field.edit, str(value))
        given = [value] if parameter.kind == "numbers" else value
        why = ParameterError(name, given, parameter.allowed(), unit=parameter.param.unit)
        assert session.document.text() == before, (name, value)
        unit = f" {parameter.param.unit}" if shown and parameter.param.unit else ""
        still = shown or ("none" if parameter.kind == "numbers" else "empty")
        counts = "" if parameter.required else f" (still {still}{unit})"
        assert field.message.text() == why.message + counts
        assert field.message.isVisible(), (name, value)
        frame = field.edit.grab().toImage().pixelColor(1, field.edit.height() // 2)
        assert frame == QColor(DARK.error), (name, value)
    QTest.keyClick(field.edit, Qt.Key.Key_Escape)
    assert field.edit.text() == shown, name
    assert not field.edit.marked, name
    assert not field.message.isVisible(), name
    assert session.document.text() == before, name


def assert_a_drag_of_the_slider_is_one_step(area, session, name):
    field, changes = field_of(area, session, name), []
    before, position = session.document.text(), session.document.position

    def note(_, after):
        changes.append(after.nodes["node"].params.get(name))

    session.changed.connect(note)
    up = field.slider.value() < field.slider.maximum() / 2
    drag(field.slider, 0.4 if up else -0.4)
    session.changed.disconnect(note)
    assert len(set(changes)) > 2, name
    assert session.document.position == position + 1, name
    assert float(field.edit.text()) == stored(session, name) == changes[-1], name
    session.undo()
    assert session.document.text() == before, name


DECLARED = {key: declaration(module) for key, module in LIBRARY.items()}
CONDITIONAL = [
    pytest.param(key, section, id=f"{key}-{'-'.join(section.parameters)}")
    for key, declared in DECLARED.items()
    for section in declared.panel
    if section.shown_when
]


def test_every_parameter_stands_on_the_panel_once():
    for key, declared in DECLARED.items():
        placed = Counter(name for section in declared.panel for name in section.parameters)
        assert placed == Counter(parameter.name for parameter in declared.parameters), key


@pytest.mark.parametrize(("key", "section"), CONDITIONAL)
def test_what_shows_a_section_is_a_choice_that_is_always_shown(key, section):
    name, values = section.shown_when
    parameter = DECLARED[key].parameter(name)
    assert parameter.kind == "choice"
    assert set(values) < set(parameter.choices)
    home = next(other for other in DECLARED[key].panel if name in other.parameters)
    assert home.shown_when is None
    assert home.page == section.page


def test_the_published_order_of_the_initialization_panel():
    placed = [name for section in DECLARED["init_trans"].panel for name in section.parameters]
    published = ["detector_x_um", "detector_y_um", "focal_length_mm", "f_number", "range_m"]
    assert placed[:7] == [*published, "fill_x", "fill_y"]  # fig. 4.3


def test_the_published_order_of_the_electronics_panel():
    sections = DECLARED["electronics_noise"].panel
    placed = [name for section in sections for name in section.parameters]
    published = ["cut_on_um", "cut_off_um", "region", "material", "optics_transmission"]
    published += ["filter_transmission", "bits", "seed_mode", "seed"]  # fig. 4.42
    assert [name for name in placed if name in published] == published
