"""Modules between an image and its spectrum, and between samplings."""
