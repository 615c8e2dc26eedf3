"""Imagechain's engine: physics, transfer-function algebra, networks and their evaluation.

Knows numpy and scipy only: no file formats, no modules of the library, no window.
"""
