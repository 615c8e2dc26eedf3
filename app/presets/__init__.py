"""Presets: macros to be put into a network, and sets of a module's parameters."""
