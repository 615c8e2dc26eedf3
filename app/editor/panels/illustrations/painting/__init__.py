"""Painting small charts, pupils and wavefronts."""
