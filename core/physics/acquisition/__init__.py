"""What an observer resolves, detects and identifies, and how far."""
