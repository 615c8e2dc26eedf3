"""Colours of the window: dark and light, for Qt's own widgets and for what we draw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from PySide6.QtGui import QColor, QPalette

Look = Literal["dark", "light"]


@dataclass(frozen=True)
class Theme:
    """Every colour by what it is for, as ``#rrggbb``.

    `ports` colours wires and ports by their type, `groups` the heads of nodes by the library's
    groups, `badges` the marks of a node's state.
    """

    look: Look
    window: str
    base: str
    raised: str
    text: str
    faint_text: str
    line: str
    accent: str
    accent_text: str
    error: str
    changed: str
    canvas: str
    grid: str
    node: str
    ports: Mapping[str, str]
    groups: Mapping[str, str]
    badges: Mapping[str, str]
    curves: tuple[str, ...]

    def palette(self) -> QPalette:
        """For Qt's Fusion style."""
        role = QPalette.ColorRole
        colours = {
            role.Window: self.window,
            role.WindowText: self.text,
            role.Base: self.base,
            role.AlternateBase: self.raised,
            role.Text: self.text,
            role.Button: self.raised,
            role.ButtonText: self.text,
            role.BrightText: self.error,
            role.Highlight: self.accent,
            role.HighlightedText: self.accent_text,
            role.ToolTipBase: self.raised,
            role.ToolTipText: self.text,
            role.PlaceholderText: self.faint_text,
            role.Link: self.accent,
            role.Mid: self.line,
        }
        palette = QPalette(QColor(self.raised), QColor(self.window))
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
    text="#e6e8eb",
    faint_text="#8d949e",
    line="#474c54",
    accent="#3d8fd9",
    accent_text="#ffffff",
    error="#f2665e",
    changed="#e8b04a",
    canvas="#1f2226",
    grid="#292d32",
    node="#343940",
    ports=MappingProxyType(
        {
            "image": "#e8c35a",
            "magnitude": "#5fb4f0",
            "phase": "#c58af0",
            "context": "#9aa4b0",
            "pupil": "#62cf9b",
            "transfer": "#f08a5f",
            "curve": "#f0a3c0",
            "table": "#b9c96a",
        }
    ),
    groups=MappingProxyType(
        {
            "Input and output": "#6b5a24",
            "Transform": "#35506b",
            "Atmosphere": "#2d5f63",
            "Optics": "#2f5c45",
            "Motion": "#59426e",
            "Detector": "#6b4530",
            "Electronics & Noise": "#6a3540",
            "Analysis": "#55602c",
        }
    ),
    badges=MappingProxyType(
        {
            "stale": "#e8b04a",
            "running": "#5fb4f0",
            "error": "#f2665e",
            "incomplete": "#8d949e",
            "warning": "#f0a03c",
            "skipped": "#62cf9b",
            "disabled": "#8d949e",
        }
    ),
    curves=("#5fb4f0", "#e8c35a", "#62cf9b", "#f08a5f", "#c58af0", "#f0a3c0", "#b9c96a", "#9aa4b0"),
)

LIGHT = Theme(
    look="light",
    window="#f0f1f3",
    base="#ffffff",
    raised="#e4e6ea",
    text="#1d2126",
    faint_text="#6c7480",
    line="#c3c8cf",
    accent="#1f6fb8",
    accent_text="#ffffff",
    error="#c22f28",
    changed="#a86800",
    canvas="#e9ebee",
    grid="#dcdfe4",
    node="#fbfbfc",
    ports=MappingProxyType(
        {
            "image": "#a57a00",
            "magnitude": "#1f6fb8",
            "phase": "#8343bb",
            "context": "#5f6a77",
            "pupil": "#1d8455",
            "transfer": "#c2551f",
            "curve": "#b34474",
            "table": "#66741a",
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
            "stale": "#a86800",
            "running": "#1f6fb8",
            "error": "#c22f28",
            "incomplete": "#6c7480",
            "warning": "#b65c00",
            "skipped": "#1d8455",
            "disabled": "#6c7480",
        }
    ),
    curves=("#1f6fb8", "#a57a00", "#1d8455", "#c2551f", "#8343bb", "#b34474", "#66741a", "#5f6a77"),
)

THEMES: Mapping[Look, Theme] = MappingProxyType({"dark": DARK, "light": LIGHT})
