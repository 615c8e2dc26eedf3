"""Nodes and their values as text, to be copied and pasted."""
