"""Veiling glare and neutral filters."""
