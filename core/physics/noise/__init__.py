"""Noise of detectors and photons, and its components in a sequence."""
