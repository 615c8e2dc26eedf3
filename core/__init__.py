"""Imagechain's engine: physics, transfer-function algebra, networks and their evaluation."""
