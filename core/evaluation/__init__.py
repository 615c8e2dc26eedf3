"""Recipes of values, and the store in which each is computed once."""
