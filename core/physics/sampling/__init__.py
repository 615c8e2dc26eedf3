"""Sampling, interpolation, the motion of platform and line of sight, footprints on the ground."""
