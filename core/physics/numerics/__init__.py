"""Checks of arguments, quadrature, interpolation and special values."""
