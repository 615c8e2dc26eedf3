"""Detectors that count electrons: from photons to what is read out, and its noise."""
