"""Sampling, interpolation and the footprints of a camera on the ground."""
