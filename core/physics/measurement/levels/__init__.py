"""Signal levels and their noise: flat fields, rows, photon transfer."""
