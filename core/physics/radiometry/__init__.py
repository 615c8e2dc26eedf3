"""Planck's law, band integrals, units of radiance and materials."""
