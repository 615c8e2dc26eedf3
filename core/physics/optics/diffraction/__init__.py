"""A circular or annular aperture over a band: defocus, wavefront error, spectral weights."""
