"""Transfer functions measured, expected and compared."""
