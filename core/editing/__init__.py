"""Editing a network: operations with inverses, their history, and help with wiring."""
