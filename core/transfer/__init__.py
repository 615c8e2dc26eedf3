"""Factors of transfer functions, their products, and what an error budget leaves out."""
