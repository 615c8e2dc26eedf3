"""Modules of the atmosphere."""
