"""Imagechain's engine: physics, transfer-function algebra, networks and their evaluation.

Depends on numpy and scipy only: no file formats, no modules of the library, no window.
"""
