"""Arithmetic that a person writes in place of a number: text, units, value."""
