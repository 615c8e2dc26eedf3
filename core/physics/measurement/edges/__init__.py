"""Spreads and transfer functions from slanted edges and lines of a picture."""
