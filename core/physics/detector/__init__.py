"""Detector aperture, charge transfer and detectivity."""
