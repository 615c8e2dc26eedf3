"""A run in a process of its own, started by the editor."""
