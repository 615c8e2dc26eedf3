"""What a sensor resolves, detects and how far."""
