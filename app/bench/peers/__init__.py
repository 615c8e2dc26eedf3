"""The same optical work done by other programs, where they are installed."""
