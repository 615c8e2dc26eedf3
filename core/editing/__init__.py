"""Editing a network: operations, the history of networks, and help with wiring."""
