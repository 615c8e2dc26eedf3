"""Modules with their values, before they are in a chain, and what all of the package uses."""
