"""Multiplying a frame's spectrum: mirrored, periodic, line by line."""
