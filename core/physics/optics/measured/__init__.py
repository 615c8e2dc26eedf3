"""Optics as they were measured or computed elsewhere: curves of MTF and point spread functions."""
