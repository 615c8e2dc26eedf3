"""Modules with their values, before they are in a chain, and what the whole package uses."""
