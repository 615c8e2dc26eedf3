"""Noise predicted and measured, by source and by component."""
