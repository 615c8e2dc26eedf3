"""Detectors and their electronics: aperture, photons to electrons, filters, quantization."""
