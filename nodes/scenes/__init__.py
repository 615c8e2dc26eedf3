"""Radiometric test scenes: area-sampled pictures of known geometry and temperature."""
