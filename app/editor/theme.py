"""Colours of the window: dark and light, for Qt's own widgets and for what we draw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QWidget

Look = Literal["dark", "light"]


@dataclass(frozen=True)
class Theme:
    """Every colour by what it is for, as ``#rrggbb``.

    `ports` colours wires and ports by their type, `groups` the heads of nodes by the library's
    groups, `badges` the marks of a node's state, `channels` the red, green and blue of a picture
    composed of three bands, `surround` lies round a picture. Fusion draws buttons lighter than
    `button`.

    Text has a contrast of at least 4.5 to 1 on each of its grounds (WCAG 2.1). Any two of `ports`,
    and of the eight `curves`, differ by at least 10 (CIEDE2000) to usual sight and to protanopes,
    deuteranopes and tritanopes (simulated after Machado, Oliveira, Fernandes 2009). Tests measure
    both.
    """

    look: Look
    window: str
    base: str
    raised: str
    button: str
    text: str
    faint_text: str
    line: str
    accent: str
    accent_text: str
    error: str
    changed: str
    surround: str
    canvas: str
    grid: str
    node: str
    ports: Mapping[str, str]
    groups: Mapping[str, str]
    badges: Mapping[str, str]
    curves: tuple[str, ...]
    channels: tuple[str, str, str]

    def palette(self) -> QPalette:
        role = QPalette.ColorRole
        colours = {
            role.Window: self.window,
            role.WindowText: self.text,
            role.Base: self.base,
            role.AlternateBase: self.raised,
            role.Text: self.text,
            role.Button: self.button,
            role.ButtonText: self.text,
            role.BrightText: self.error,
            role.Highlight: self.accent,
            role.HighlightedText: self.accent_text,
            role.ToolTipBase: self.raised,
            role.ToolTipText: self.text,
            role.PlaceholderText: self.faint_text,
            role.Link: self.accent,
            role.LinkVisited: self.changed,
            role.Mid: self.line,
        }
        palette = QPalette(QColor(self.button), QColor(self.window))
        for which, colour in colours.items():
            palette.setColor(which, QColor(colour))
        for which in (role.Text, role.WindowText, role.ButtonText):
            palette.setColor(QPalette.ColorGroup.Disabled, which, QColor(self.faint_text))
        return palette


DARK = Theme(
    look="dark",
    window="#26292e",
    base="#1d2024",
    raised="#33373d",
    button="#2b2f34",
    text="#e6e8eb",
    faint_text="#a9b0ba",
    line="#474c54",
    accent="#56a5ea",
    accent_text="#0b0f14",
    error="#f7867e",
    changed="#e8b04a",
    surround="#1d2024",
    canvas="#1f2226",
    grid="#292d32",
    node="#343940",
    ports=MappingProxyType(
        {
            "image": "#e5da4f",
            "magnitude": "#7fabff",
            "phase": "#c891b9",
            "context": "#c0c1c1",
            "pupil": "#7afec9",
            "transfer": "#f4b590",
            "curve": "#f08298",
            "table": "#95b344",
        }
    ),
    groups=MappingProxyType(
        {
            "Input and output": "#5f5020",
            "Transform": "#35506b",
            "Atmosphere": "#29575b",
            "Optics": "#2f5c45",
            "Motion": "#59426e",
            "Detector": "#6b4530",
            "Electronics & Noise": "#6a3540",
            "Analysis": "#4c5627",
        }
    ),
    badges=MappingProxyType(
        {
            "stale": "#e8b04a",
            "running": "#6fbcf2",
            "error": "#f7867e",
            "incomplete": "#a9b0ba",
            "warning": "#f0a03c",
            "skipped": "#62cf9b",
            "disabled": "#a9b0ba",
        }
    ),
    curves=("#7fabff", "#e5da4f", "#7afec9", "#f4b590", "#c891b9", "#f08298", "#95b344", "#c0c1c1"),
    channels=("#ff7b72", "#5fd06e", "#7ea6ff"),
)

LIGHT = Theme(
    look="light",
    window="#f0f1f3",
    base="#ffffff",
    raised="#e4e6ea",
    button="#e4e6ea",
    text="#1d2126",
    faint_text="#565e69",
    line="#c3c8cf",
    accent="#175c9d",
    accent_text="#ffffff",
    error="#b32720",
    changed="#855200",
    surround="#d6d9de",
    canvas="#e9ebee",
    grid="#dcdfe4",
    node="#fbfbfc",
    ports=MappingProxyType(
        {
            "image": "#926d07",
            "magnitude": "#337cc8",
            "phase": "#4c24a2",
            "context": "#5f6770",
            "pupil": "#376048",
            "transfer": "#8b3e14",
            "curve": "#d62182",
            "table": "#74764e",
        }
    ),
    groups=MappingProxyType(
        {
            "Input and output": "#f0dfa6",
            "Transform": "#bcd6ee",
            "Atmosphere": "#b5dfe2",
            "Optics": "#bfe3cf",
            "Motion": "#dcc8ef",
            "Detector": "#f0cdb6",
            "Electronics & Noise": "#f0c0c8",
            "Analysis": "#dbe3b0",
        }
    ),
    badges=MappingProxyType(
        {
            "stale": "#855200",
            "running": "#1a64aa",
            "error": "#b32720",
            "incomplete": "#565e69",
            "warning": "#964800",
            "skipped": "#17704a",
            "disabled": "#565e69",
        }
    ),
    curves=("#337cc8", "#926d07", "#376048", "#8b3e14", "#4c24a2", "#d62182", "#74764e", "#5f6770"),
    channels=("#b32720", "#1c7434", "#2b57c4"),
)

THEMES: Mapping[Look, Theme] = MappingProxyType({"dark": DARK, "light": LIGHT})


TEXT = QPalette.ColorRole.WindowText
FAINT = QPalette.ColorRole.PlaceholderText
ERROR = QPalette.ColorRole.BrightText
CHANGED = QPalette.ColorRole.LinkVisited
RAISED = QPalette.ColorRole.AlternateBase
"""Roles to write in, and a ground: they follow the window's palette."""
_INK = (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text)


def theme_of(widget: QWidget) -> Theme:
    """The theme whose palette a widget has, for colours that no role stands for."""
    dark = widget.palette().color(QPalette.ColorRole.Base).lightness() < 128
    return DARK if dark else LIGHT


def raised_palette(theme: Theme) -> QPalette:
    """That of what floats on a view, whose children have the view's own."""
    palette = theme.palette()
    palette.setColor(QPalette.ColorRole.Window, QColor(theme.raised))
    return palette


def set_ink(widget: QWidget, colour: str) -> None:
    palette = widget.palette()
    if palette.color(QPalette.ColorRole.WindowText) != QColor(colour):
        for role in _INK:
            palette.setColor(role, QColor(colour))
        widget.setPalette(palette)


def set_ground(widget: QWidget, colour: str) -> None:
    palette = widget.palette()
    palette.setColor(QPalette.ColorRole.Window, QColor(colour))
    widget.setPalette(palette)
    widget.setAutoFillBackground(True)
