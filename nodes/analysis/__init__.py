"""Modules that judge and compare."""
