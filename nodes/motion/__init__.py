"""Modules of motion within an exposure."""
