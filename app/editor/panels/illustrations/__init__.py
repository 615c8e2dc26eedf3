"""Small pictures at the top of panels, which follow what is edited."""

from app.editor.panels.illustrations.illustration_choice import illustration_for

__all__ = ["illustration_for"]
