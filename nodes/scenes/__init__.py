"""Radiometric test scenes: area-sampled pictures of known geometry and temperature."""

from __future__ import annotations

from nodes.scenes.coverage import KINDS
from nodes.scenes.draw import draw_scene
from nodes.scenes.two_steps import draw_shares, in_two_steps, with_radiance

__all__ = ["KINDS", "draw_scene", "draw_shares", "in_two_steps", "with_radiance"]
