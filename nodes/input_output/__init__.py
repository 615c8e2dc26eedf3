"""Modules that read, draw, look at and write images."""
