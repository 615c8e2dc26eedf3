"""Modules of the detector: its aperture and charge transfer."""
