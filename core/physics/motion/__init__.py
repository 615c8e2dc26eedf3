"""Transfer functions of motion and vibration, and the geometry of a line scanner."""
