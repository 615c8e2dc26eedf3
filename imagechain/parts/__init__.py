"""Modules with their values, before they are in a chain."""
