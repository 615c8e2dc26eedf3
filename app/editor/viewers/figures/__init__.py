"""Figures of the sensor as a strip and as tables."""
