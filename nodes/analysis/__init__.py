"""Modules that measure and compare."""
