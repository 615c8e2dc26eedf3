"""Text can be read on its ground: 4.5 to 1 (WCAG 2.1, level AA), in both looks, as painted."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint
from PySide6.QtGui import QImage
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QLabel,
    QLineEdit,
    QTabBar,
    QWidget,
)

from app.editor.theme import DARK, LIGHT, THEMES
from app.editor.widgets import ElidedLabel
from colour_sight import contrast, mixed
from core.editing.operations import set_node_field
from window_hands import show_small

LEAST = 4.5
LOOKS = pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
SUBTITLE = 0.8  # opacity of a node's second line


@LOOKS
def test_texts_of_the_theme_on_all_its_grounds(theme):
    backdrop = mixed(theme.raised, theme.canvas, 130 / 255)
    grounds = (theme.window, theme.base, theme.raised, theme.node, theme.canvas, backdrop)
    assert contrast(theme.text, theme.surround) >= LEAST  # of the axes round a picture
    for text in (theme.text, theme.faint_text, theme.error, theme.changed):
        for ground in grounds:
            assert contrast(text, ground) >= LEAST, (text, ground)
    for ground in (theme.window, theme.base):
        for text in (theme.accent, *theme.badges.values()):  # links; what is wrong with a node
            assert contrast(text, ground) >= LEAST, (text, ground)
    assert contrast(theme.accent_text, theme.accent) >= LEAST


@LOOKS
def test_titles_and_names_on_the_heads_of_nodes(theme):
    for group, head in (*theme.groups.items(), ("unknown", theme.raised)):
        assert contrast(theme.text, head) >= LEAST, group
        assert contrast(mixed(theme.text, head, SUBTITLE), head) >= LEAST, group


@LOOKS
def test_signs_of_badges_and_of_the_output(theme):
    for kind, colour in theme.badges.items():
        assert contrast(theme.node, colour) >= LEAST, kind
    assert contrast(theme.node, theme.ports["image"]) >= LEAST


# --- as painted ----------------------------------------------------------------------------------


def painted_contrast(image, rect):
    """The contrast of what is painted there: of the ground, its most frequent colour, and the ink.

    Thin strokes are mixed with the ground at their edges: of their colours the strongest counts.
    """
    ratio = image.devicePixelRatio()
    left, top = (max(round(edge * ratio), 0) for edge in (rect.left(), rect.top()))
    right, bottom = (round((edge + 1) * ratio) for edge in (rect.right(), rect.bottom()))
    plain = image.convertToFormat(QImage.Format.Format_RGB32)
    dots = np.frombuffer(plain.constBits(), np.uint32).reshape(plain.height(), -1)
    colours, counts = np.unique(dots[top:bottom, left:right] & 0xFFFFFF, return_counts=True)
    names = [f"#{colour:06x}" for colour in colours]
    ground = names[int(np.argmax(counts))]
    return max(contrast(ink, ground) for ink in names)


def texts(window):
    """Widgets of the window that write a text, and where in it they are seen."""
    kinds = (QLabel, QAbstractButton, QLineEdit, ElidedLabel)
    for widget in window.findChildren(QWidget):
        if not isinstance(widget, kinds) or not widget.isVisible() or widget.window() is not window:
            continue
        text = widget.text() or (widget.placeholderText() if isinstance(widget, QLineEdit) else "")
        if not any(letter.isalnum() for letter in text):
            continue
        rect = widget.visibleRegion().boundingRect()
        if rect.height() < widget.fontMetrics().height() or rect.width() < 12:
            continue  # it is scrolled out of sight
        inside = 3 if isinstance(widget, QAbstractButton | QLineEdit) else 0  # without its frame
        rect = rect.adjusted(inside, inside, -inside, -inside)
        yield widget, text, rect.translated(widget.mapTo(window, QPoint()))


@pytest.fixture(params=["dark", "light"])
def shown(request, make_window, settings, idle):
    """A window in that look with the network of the thesis' sensor."""
    settings.look = request.param
    window = make_window()
    show_small(window, "kodak_kir310")
    idle(window)
    return window


def test_the_first_page(make_window, settings, idle):
    for look in THEMES:
        settings.look = look
        window = make_window()
        idle(window)
        image = window.grab().toImage()
        seen = {text: painted_contrast(image, rect) for _, text, rect in texts(window)}
        assert len(seen) > 10
        assert {text: value for text, value in seen.items() if value < LEAST} == {}


def test_every_text_of_the_window_with_lists_tabs_and_menus(shown, idle, qtbot):
    shown.session.select(["electronics"])
    shown.session.do(set_node_field("electronics", "disabled", True))
    idle(shown)
    image = shown.grab().toImage()
    seen = {
        text: painted_contrast(image, rect) for _, text, rect in texts(shown) if not rect.isEmpty()
    }
    assert {"Cut-on", "Auto", "NETD system"} <= set(seen)
    assert {text: value for text, value in seen.items() if value < LEAST} == {}
    for view in shown.findChildren(QAbstractItemView):
        if not view.isVisible() or view.window() is not shown:
            continue
        for y in range(8, view.viewport().height() - 8, 20):
            index = view.indexAt(QPoint(view.viewport().width() // 2, y))
            rect = view.visualRect(index) & view.viewport().rect()
            if index.isValid() and rect.height() > 10:
                rect.translate(view.viewport().mapTo(shown, QPoint()))
                assert painted_contrast(image, rect) >= LEAST, index.data()
    for bar in shown.findChildren(QTabBar):
        for tab in range(bar.count() if bar.isVisible() else 0):
            rect = bar.tabRect(tab).adjusted(4, 4, -4, -4).translated(bar.mapTo(shown, QPoint()))
            if not shown.rect().contains(rect):
                continue  # Qt has what is behind another outside
            assert painted_contrast(image, rect) >= LEAST, bar.tabText(tab)
    shown.session.select([])
    greyed = 0
    for menu in shown.menus.values():
        menu.popup(shown.mapToGlobal(QPoint(40, 40)))
        qtbot.waitUntil(menu.isVisible)
        picture = menu.grab().toImage()
        for action in menu.actions():
            if action.text():
                greyed += not action.isEnabled()
                rect = menu.actionGeometry(action).adjusted(24, 1, -4, -1)
                assert painted_contrast(picture, rect) >= LEAST, action.text()
        menu.close()
    assert greyed > 8
