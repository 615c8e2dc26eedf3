"""Editing a network: operations with inverses, their history, and what helps a person wire."""
