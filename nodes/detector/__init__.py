"""Modules of the detector: from photons to digital numbers."""
