"""Splines that the spread of an edge is made of."""
