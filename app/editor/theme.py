"""Colours of the window: dark and light, for Qt's own widgets and for what we draw."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QWidget

from core.records import dataclass

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
    channels: tuple[str, ...]

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


# Each colour of the dark theme, and of the light one.
_PLAIN = {
    "window": ("#26292e", "#f0f1f3"),
    "base": ("#1d2024", "#ffffff"),
    "raised": ("#33373d", "#e4e6ea"),
    "button": ("#2b2f34", "#e4e6ea"),
    "text": ("#e6e8eb", "#1d2126"),
    "faint_text": ("#a9b0ba", "#565e69"),
    "line": ("#474c54", "#c3c8cf"),
    "accent": ("#56a5ea", "#175c9d"),
    "accent_text": ("#0b0f14", "#ffffff"),
    "error": ("#f7867e", "#b32720"),
    "changed": ("#e8b04a", "#855200"),
    "surround": ("#1d2024", "#d6d9de"),
    "canvas": ("#1f2226", "#e9ebee"),
    "grid": ("#292d32", "#dcdfe4"),
    "node": ("#343940", "#fbfbfc"),
}
_PORTS = {
    "image": ("#e5da4f", "#926d07"),
    "magnitude": ("#7fabff", "#337cc8"),
    "phase": ("#c891b9", "#4c24a2"),
    "context": ("#c0c1c1", "#5f6770"),
    "pupil": ("#7afec9", "#376048"),
    "transfer": ("#f4b590", "#8b3e14"),
    "curve": ("#f08298", "#d62182"),
    "table": ("#95b344", "#74764e"),
}
_GROUPS = {
    "Input and output": ("#5f5020", "#f0dfa6"),
    "Transform": ("#35506b", "#bcd6ee"),
    "Atmosphere": ("#29575b", "#b5dfe2"),
    "Optics": ("#2f5c45", "#bfe3cf"),
    "Motion": ("#59426e", "#dcc8ef"),
    "Detector": ("#6b4530", "#f0cdb6"),
    "Electronics & Noise": ("#6a3540", "#f0c0c8"),
    "Analysis": ("#4c5627", "#dbe3b0"),
}
_BADGES = {
    "stale": ("#e8b04a", "#855200"),
    "running": ("#6fbcf2", "#1a64aa"),
    "error": ("#f7867e", "#b32720"),
    "incomplete": ("#a9b0ba", "#565e69"),
    "warning": ("#f0a03c", "#964800"),
    "skipped": ("#62cf9b", "#17704a"),
    "disabled": ("#a9b0ba", "#565e69"),
}
_CURVES = ("magnitude", "image", "pupil", "transfer", "phase", "curve", "table", "context")
_CHANNELS = (("#ff7b72", "#b32720"), ("#5fd06e", "#1c7434"), ("#7ea6ff", "#2b57c4"))


def _theme(look: Look, which: int) -> Theme:
    ports, groups, badges = (
        MappingProxyType({name: pair[which] for name, pair in table.items()})
        for table in (_PORTS, _GROUPS, _BADGES)
    )
    return Theme(
        look=look,
        **{name: pair[which] for name, pair in _PLAIN.items()},
        ports=ports,
        groups=groups,
        badges=badges,
        curves=tuple(ports[name] for name in _CURVES),
        channels=tuple(pair[which] for pair in _CHANNELS),
    )


DARK, LIGHT = _theme("dark", 0), _theme("light", 1)
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
