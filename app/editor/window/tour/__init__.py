"""The first tour of the window."""
