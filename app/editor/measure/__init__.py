"""Measuring a picture in the window: its edges, MTF and noise."""
