"""Measurements of the window, each a program of its own that prints JSON; for the benchmark."""
