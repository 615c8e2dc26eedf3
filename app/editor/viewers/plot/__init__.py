"""The viewer of curves, and what it draws."""
