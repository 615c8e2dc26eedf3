"""Radiometric test scenes: area-sampled pictures of known geometry and temperature."""

from __future__ import annotations

from nodes.scenes.draw import KINDS, draw_scene

__all__ = ["KINDS", "draw_scene"]
