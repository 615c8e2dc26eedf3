"""Noise of a camera from a picture of its scene: flat areas, levels, rows and columns."""
