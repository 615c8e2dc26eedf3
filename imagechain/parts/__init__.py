"""Modules with their values, before they join a chain, and helpers for the whole package."""
