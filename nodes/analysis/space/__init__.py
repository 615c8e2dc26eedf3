"""The chain's blur in space instead of frequency."""
