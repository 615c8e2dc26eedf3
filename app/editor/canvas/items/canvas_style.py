"""Fonts, pens and colours of the canvas, made once for a theme.

Sizes are in units of the scene, in which networks store their layout: a node stands on a grid of
240 by 160 whatever the screen's font. `natural_zoom` is the zoom at which text of the canvas is as
large as that of the window.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontInfo, QFontMetricsF, QPen

from app.editor.theme import Look, Theme

TextRole = Literal["title", "id", "port", "backdrop"]

_PLAIN = 12  # units that the window's font is worth
_SIZES: dict[TextRole, int] = {"title": 13, "id": 11, "port": 11, "backdrop": 15}


# Chosen so that the theme's text is read on them, contrast 4.5 or more; the tests measure it.
_TINTS: Mapping[Look, Mapping[str, str]] = MappingProxyType(
    {
        "dark": MappingProxyType(
            {
                "red": "#7a2e35",
                "orange": "#7a4a1e",
                "yellow": "#665a17",
                "green": "#2c6138",
                "blue": "#28538a",
                "violet": "#5d3f86",
                "grey": "#555b63",
            }
        ),
        "light": MappingProxyType(
            {
                "red": "#f3c1c3",
                "orange": "#f5d0a9",
                "yellow": "#efe3a0",
                "green": "#c3e5c5",
                "blue": "#bfd7f5",
                "violet": "#ddcbf2",
                "grey": "#d3d6da",
            }
        ),
    }
)
TINTS: tuple[str, ...] = tuple(_TINTS["dark"])


class CanvasStyle:
    """What the items are drawn with.

    Parameters
    ----------
    theme : Theme
        The colours.
    font : QFont
        The window's font; its family is used.
    """

    def __init__(self, theme: Theme, font: QFont) -> None:
        self.theme = theme
        self.natural_zoom = max(QFontInfo(font).pixelSize(), 6) / _PLAIN
        self._font = font
        self._fonts: dict[tuple[int, bool], QFont] = {}
        self._sized_metrics: dict[int, QFontMetricsF] = {}
        self._widths: dict[tuple[TextRole, str], float] = {}
        self._metrics = {role: QFontMetricsF(self.font(role)) for role in _SIZES}
        self.text = QColor(theme.text)
        self.faint = QColor(theme.faint_text)
        self.node = QBrush(QColor(theme.node))
        self.border = QPen(QColor(theme.line), 1.2)
        self.dashed = QPen(self.faint, 1.4, Qt.PenStyle.DashLine)
        self.accent = QColor(theme.accent)
        self.error = QColor(theme.error)
        self.group = {name: QColor(colour) for name, colour in theme.groups.items()}
        self.unknown_group = QColor(theme.raised)
        self._ports = {name: QColor(colour) for name, colour in theme.ports.items()}

    def is_of(self, theme: Theme, font: QFont) -> bool:
        """Whether it is made of this theme and this font."""
        return theme is self.theme and font == self._font

    def font(self, role: TextRole) -> QFont:
        """The font for a kind of text."""
        return self.sized(_SIZES[role], bold=role in ("title", "backdrop"))

    def sized(self, size: int, *, bold: bool = False) -> QFont:
        """A font of that many units."""
        font = self._fonts.get((size, bold))
        if font is None:
            font = QFont(self._font)
            font.setPixelSize(size)
            font.setBold(bold)
            # Hinted letters have other widths at every zoom.
            font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
            self._fonts[size, bold] = font
        return font

    def metrics(self, size: int) -> QFontMetricsF:
        """What measures texts of that many units."""
        metrics = self._sized_metrics.get(size)
        if metrics is None:
            metrics = self._sized_metrics[size] = QFontMetricsF(self.sized(size))
        return metrics

    def width(self, role: TextRole, text: str) -> float:
        """Width of a text in units."""
        width = self._widths.get((role, text))
        if width is None:
            width = self._widths[role, text] = self._metrics[role].horizontalAdvance(text)
        return width

    def elided(self, role: TextRole, text: str, width: float) -> str:
        """The text, cut to the width where it is too long."""
        if self.width(role, text) <= width:
            return text
        return self._metrics[role].elidedText(text, Qt.TextElideMode.ElideRight, width)

    def port(self, types: tuple[str, ...]) -> QColor:
        """Colour of a port that takes these types: the first one's."""
        return self._ports.get(types[0], self.faint) if types else self.faint

    def lane(self, types: tuple[str, ...]) -> float:
        """How far beside nodes wires of this type run, so that those of others stay apart."""
        order = list(self._ports)
        return 9.0 + 5.0 * (order.index(types[0]) if types and types[0] in order else len(order))

    def tint(self, name: str) -> QColor | None:
        """The colour of that name that a person can give; None where there is none."""
        colour = _TINTS[self.theme.look].get(name)
        return QColor(colour) if colour is not None else None

    def head(self, group: str) -> QColor:
        """Colour of the head of a node of this group."""
        return self.group.get(group, self.unknown_group)
