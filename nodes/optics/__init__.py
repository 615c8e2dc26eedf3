"""Modules of the optics: pupils, blur, photon noise."""
