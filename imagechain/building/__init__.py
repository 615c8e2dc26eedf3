"""Chains: opened, built and changed."""
