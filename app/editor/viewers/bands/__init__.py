"""Bands of wavelength in an image viewer: which are shown, and the spectrum of a sample."""
